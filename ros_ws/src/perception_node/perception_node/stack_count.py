# SPDX-License-Identifier: Apache-2.0
"""The number of stacks k, seen in the mask (A.2.4)."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

#: Gaps and runs narrower than this part of the image's width are noise of the mask.
NOISE_WIDTH: Final = 0.016
#: A count must hold on this part of the image's rows, in a row or not.
NOISE_ROWS: Final = 0.016


def count_stacks(mask: NDArray[np.bool_]) -> int:
    """k = ½ max over rows of the intersections between a horizontal line and the mask's outline.

    Every run of mask pixels in a row makes two intersections. Before they are counted, holes and
    gaps that are too narrow to be a gap between stacks are closed and specks that are too narrow to
    be a block are removed; afterwards, counts that are seen on a few rows only are ignored.

    Args:
        mask: union of all objects' masks, shape (height, width).

    Returns:
        Number of stacks; 0 for an empty mask.
    """
    height, width = mask.shape
    narrow = max(1, round(NOISE_WIDTH * width)) + 1
    rows = max(1, round(NOISE_ROWS * height))
    square = np.ones((narrow, narrow), np.uint8)
    padded = np.pad(mask.astype(np.uint8), narrow)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, square)
    opened = cv2.morphologyEx(closed, cv2.MORPH_OPEN, square)
    counts = np.count_nonzero(np.diff(opened.astype(np.int8), axis=1) > 0, axis=1)
    for count in range(counts.max(initial=0), 0, -1):
        if np.count_nonzero(counts >= count) >= rows:
            return count
    return int(mask.any())
