# SPDX-License-Identifier: Apache-2.0
"""What several seeds measured, as one row each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from results_file import Row


def together(of_seeds: Sequence[Sequence[Row]]) -> list[Row]:
    """The mean of each row over the seeds that have it; of several, the spread is theirs.

    Args:
        of_seeds: their rows; the first seed has all.
    """
    rows = []
    for row in of_seeds[0]:
        values = [
            other.value
            for seed in of_seeds
            for other in seed
            if (other.set, other.metric) == (row.set, row.metric)
        ]
        if len(values) == 1:
            rows.append(row)
            continue
        mean, spread = float(np.mean(values)), (min(values), max(values))
        note = "; of the first: ".join(filter(None, [told(values), row.note]))
        rows.append(replace(row, value=mean, spread=spread, note=note))
    return rows


def told(values: Sequence[float], form: str = ".4g") -> str:
    """What each of several seeds gave."""
    return f"{len(values)} seeds: " + ", ".join(format(value, form) for value in values)
