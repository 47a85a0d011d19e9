# SPDX-License-Identifier: Apache-2.0
"""At which heights the blocks of a tower meet: what each pixel's label may be by its height alone.

A strip of a face, a side or lid that is seen at a flat angle, often looks like something else: a
rounded edge mirrors the room, a lens mixes it with what is behind. Its height tells of which block
of a tower it is, and where two meet is known by the many pixels of their fronts, of which a few
wrong ones change nothing.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A block is over another one whose middle is lower by this, and no further beside it [m].
HIGHER: Final = 0.012
BESIDE: Final = 0.05
#: Of two that meet at a height no more than this part is on the wrong side of it.
MOST_WRONG: Final = 0.2


def levels(labels: NDArray[np.integer], points: NDArray[np.floating]) -> tuple[Array, Array]:
    """Between which heights the blocks are that stand on others, or on which others stand.

    Args:
        labels: 0 of no block, shape (h, w).
        points: in world, NaN where they are not known, shape (h, w, 3) [m].

    Returns:
        Low and high by label, of two that meet the same height; infinite where none does [m].
    """
    high = np.full(int(labels.max()) + 1, np.inf)
    low = -high
    known = (labels > 0) & ~np.isnan(points[..., 2])
    names, own = labels[known], points[known]
    heights, middles = {}, {}
    for label in range(1, len(low)):
        mine = own[names == label]
        if len(mine):
            ordered = np.sort(mine, axis=0)
            heights[label] = ordered[:, 2].astype(np.float64)
            middles[label] = 0.5 * (ordered[(len(mine) - 1) // 2] + ordered[len(mine) // 2])
    for upper, middle in middles.items():
        apart = {
            lower: middle[2] - other[2]
            for lower, other in middles.items()
            if middle[2] - other[2] > HIGHER and np.hypot(*(middle - other)[:2]) < BESIDE
        }
        if not apart:
            continue
        lower = min(apart, key=apart.__getitem__)
        meet = parted(heights[lower], heights[upper])
        if meet is not None:
            high[lower] = low[upper] = meet
    return low, high


def parted(below: Array, above: Array) -> float | None:
    """The value that parts two sets best: the fewest of both are on the wrong side of it.

    Args:
        below, above: ascending, shapes (n,), (m,).

    Returns:
        None where more than :data:`MOST_WRONG` of one of them is on the wrong side.
    """
    values = np.concatenate([below, above])
    beyond = len(below) - np.searchsorted(below, values, side="right")
    short = np.searchsorted(above, values, side="left")
    wrong = beyond + short
    best = np.sort(values[wrong == wrong.min()])
    at = float(best[len(best) // 2])
    far = np.count_nonzero(below > at) > MOST_WRONG * len(below)
    return None if far or np.count_nonzero(above < at) > MOST_WRONG * len(above) else at
