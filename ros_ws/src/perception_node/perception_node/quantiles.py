# SPDX-License-Identifier: Apache-2.0
"""Quantiles of few values, without what ``numpy.quantile`` spends on every call."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def quantiles(values: NDArray[np.floating], *shares: float) -> list[Any]:
    """Between neighbours on a straight line, as numpy's are.

    Args:
        values: at least one, along the first axis, shape (n, ...); none is NaN.
        shares: in 0..1.

    Returns:
        For each share, shape (...).
    """
    ordered, found = np.sort(values, axis=0), []
    for share in shares:
        below, part = divmod(share * (len(ordered) - 1), 1.0)
        low = ordered[int(below)]
        high = ordered[min(int(below) + 1, len(ordered) - 1)]
        found.append(
            low + part * (high - low) if part < 0.5 else high - (1.0 - part) * (high - low)
        )
    return found
