# SPDX-License-Identifier: Apache-2.0
"""Quantiles, without what ``numpy.quantile`` spends on every call."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

#: So many values are sorted faster than parted.
FEW: Final = 256


def quantiles(values: NDArray[np.floating], *shares: float) -> list[Any]:
    """Between neighbours on a straight line, as numpy's are.

    Args:
        values: at least one, along the first axis, shape (n, ...); none is NaN.
        shares: in 0..1.

    Returns:
        For each share, shape (...).
    """
    last = len(values) - 1
    wanted = [divmod(share * last, 1.0) for share in shares]
    ends = [(int(below), min(int(below) + 1, last)) for below, _ in wanted]
    if len(values) > FEW:
        ordered = np.partition(values, sorted({end for pair in ends for end in pair}), axis=0)
    else:
        ordered = np.sort(values, axis=0)
    found = []
    for (below, above), (_, part) in zip(ends, wanted):
        low, high = ordered[below], ordered[above]
        found.append(
            low + part * (high - low) if part < 0.5 else high - (1.0 - part) * (high - low)
        )
    return found


def quantile_of_codes(codes: NDArray[np.integer], share: float) -> float:
    """As :func:`quantiles` of few natural numbers, which are counted, not parted; any shape."""
    counts = np.bincount(codes.ravel()).cumsum()
    below, part = divmod(share * (codes.size - 1), 1.0)
    low, high = np.searchsorted(counts, [below, min(below + 1.0, codes.size - 1.0)], "right")
    apart = float(high - low)
    return float(low + part * apart if part < 0.5 else high - (1.0 - part) * apart)
