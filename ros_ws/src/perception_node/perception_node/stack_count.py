# SPDX-License-Identifier: Apache-2.0
"""The number of stacks k, seen in the mask (A.2.4)."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

#: Gaps and runs narrower than this part of the image's width are noise of the mask.
NOISE_WIDTH: Final = 0.016
#: A count must hold on this part of the image's rows, in a row or not.
NOISE_ROWS: Final = 0.016


def count_stacks(mask: NDArray[np.bool_]) -> int:
    """k = ½ max over rows of the intersections between a horizontal line and the mask's outline.

    Every run of mask pixels in a row makes two intersections. Gaps and runs that are too narrow to
    be a gap between stacks or a block are ignored, and so are counts seen on a few rows only.

    Args:
        mask: union of all objects' masks, shape (height, width).

    Returns:
        Number of stacks; 0 for an empty mask.
    """
    height, width = mask.shape
    narrow = max(1, round(NOISE_WIDTH * width))
    rows = max(1, round(NOISE_ROWS * height))
    counts = np.array([_count_runs(row, narrow) for row in mask])
    for count in range(counts.max(initial=0), 0, -1):
        if np.count_nonzero(counts >= count) >= rows:
            return count
    return int(mask.any())


def _count_runs(row: NDArray[np.bool_], narrow: int) -> int:
    """Runs wider than ``narrow`` pixels, after gaps of up to ``narrow`` pixels are closed."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(np.int8)))
    starts, ends = edges[0::2], edges[1::2]
    if len(starts) == 0:
        return 0
    parted = starts[1:] - ends[:-1] > narrow
    starts = starts[np.concatenate([[True], parted])]
    ends = ends[np.concatenate([parted, [True]])]
    return int(np.count_nonzero(ends - starts > narrow))
