# SPDX-License-Identifier: Apache-2.0
"""What looks like a block and stands behind the row: with the plain table before it.

A block stands on a place or on another block, and so has its lower end right there in the view.
What has not, and has nothing between its lower end and the row but the table, is behind it. Where
there is something, it may stand on a block that was missed, and is kept: it fits on nothing then,
and the picture is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.masks import pixels_of

from .front_view import PITCH, FrontView

Mask = NDArray[np.bool_]

#: Masks end as exactly as this [px], and a block stands so far behind the middle of a place [m].
EXACT: Final = 4
BEHIND: Final = 0.045
#: What stands on another one is over so much of the narrower of both.
OVER: Final = 0.3
#: Between what is behind the row and the row, colours of rows of the view differ by less [0..255],
ONE_COLOR: Final = 22.0
#: the same that they have so far aside, so widely [px],
ASIDE: Final = 5
WIDE: Final = 6
#: and no pixel is of a block with a surety of more than this.
DOUBT: Final = -0.5


def stands_behind(
    masks: Sequence[Mask], view: FrontView, rgb: NDArray[np.uint8], surety: NDArray[np.float32]
) -> list[bool]:
    """Whether each of N masks is of something behind the row.

    Args:
        masks: shape (h, w) of the view.
        rgb: shape (h, w, 3).
        surety: that a pixel is of a block, -1..1, shape (h, w).
    """
    spans = [_Span(mask) for mask in masks]
    order = sorted(range(len(masks)), key=lambda index: -spans[index].low)
    slack = EXACT + BEHIND * view.steepness / PITCH
    behind = [False] * len(masks)
    for done, index in enumerate(order):
        span = spans[index]
        below = [other for other in order[:done] if span.is_over(spans[other])]
        next_one = min(below, key=lambda other: spans[other].high, default=None)
        ground = float(view.feet[(span.left + span.right) // 2]) - slack
        level = ground + EXACT if next_one is None else spans[next_one].high
        if span.low >= level - EXACT:  # it is where what is below it is
            behind[index] = next_one is not None and behind[next_one]
        else:
            behind[index] = _is_table(rgb, surety, span, int(level) - EXACT)
    return behind


class _Span:
    """Where a mask is: its columns, and its upper and lower end [px]."""

    def __init__(self, mask: Mask) -> None:
        rows, columns = pixels_of(mask)
        self.high, self.low = (int(value) for value in np.percentile(rows, [1, 99]))
        self.left, self.right = (int(value) for value in np.percentile(columns, [2, 98]))

    def is_over(self, other: _Span) -> bool:
        """Whether it is higher up than another one, and in the same columns."""
        common = min(self.right, other.right) - max(self.left, other.left)
        narrower = min(self.right - self.left, other.right - other.left)
        return common > OVER * narrower and self.low < other.low


def _is_table(rgb: NDArray[np.uint8], surety: NDArray[np.float32], span: _Span, last: int) -> bool:
    """Whether from a mask's lower end down to a row there is what is on one side as well."""
    quarter = (span.right - span.left) // 4
    rows = slice(span.low + 3, last)
    strip = np.s_[rows, span.left + quarter : span.right - quarter + 1]
    if rows.stop - rows.start < 2 or surety[strip].max() >= DOUBT:
        return False
    colors = np.median(rgb[strip], axis=1)
    for first in (span.left - ASIDE - WIDE, span.right + ASIDE + 1):
        side = rgb[rows, max(first, 0) : max(first + WIDE, 0)]
        if side.shape[1]:
            together = np.concatenate([colors, np.median(side, axis=1)])
            if np.ptp(together, axis=0).max() <= ONE_COLOR:
                return True
    return False
