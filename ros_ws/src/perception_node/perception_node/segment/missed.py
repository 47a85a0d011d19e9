# SPDX-License-Identifier: Apache-2.0
"""What may be a block on the uppermost one of a tower, and was not taken for one.

A thing behind a tower and a block on it look alike. Where the network is in two minds about what
is right over a tower, the picture is better refused than a block left out; unless the top of the
uppermost block turns out to be seen whole, once it is measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.masks import pixels_of

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]

#: So far over the upper edge is looked at, and this part of the width at either side is not [px].
OVER: Final = 8
BESIDE: Final = 0.2
#: Of what is there at most this part is of something that was found and left out as too vague,
VAGUE: Final = 0.03
#: and it is a block with at most this probability.
LIKELY: Final = 0.2


def missed_sentence(column: float, row: float) -> str:
    """What is said of a pixel of the picture where a block may be that was missed."""
    return (
        f"what is seen at pixel ({column:.0f}, {row:.0f}) may be a block on a tower or something "
        "behind it; take away what stands behind the places, or look from another side"
    )


def may_be_missed(
    masks: Sequence[Mask], vague: Sequence[Mask], other: Sequence[Mask], likely: Floats
) -> dict[int, tuple[int, int]]:
    """Where blocks may be that were missed, right over found ones.

    Args:
        masks: of N blocks, shape (h, w) of the view.
        vague: of what may be blocks.
        other: of what is none.
        likely: the probability that a pixel is of a block, shape (h, w).

    Returns:
        Column and row of the view, by the index of the one below.
    """
    missed: dict[int, tuple[int, int]] = {}
    taken = np.zeros(likely.shape, bool)
    for mask in (*masks, *other):
        taken |= mask
    for index, mask in enumerate(masks):
        zone = _over(mask)
        if any(zone[one].any() for one in masks if one is not mask):
            continue  # that is the block which stands on it
        zone &= ~taken
        if not zone.any():
            continue
        left_out = max((float(one[zone].mean()) for one in vague), default=0.0)
        if left_out > VAGUE or float(likely[zone].mean()) > LIKELY:
            rows, columns = pixels_of(zone)
            missed[index] = int(np.median(columns)), int(np.median(rows))
    return missed


def _over(mask: Mask) -> Mask:
    """What is right over the middle of a mask."""
    columns = np.flatnonzero(mask.any(axis=0))
    low, high = np.percentile(columns, [3, 97])
    beside = BESIDE * (high - low)
    columns = columns[(columns >= low + beside) & (columns <= high - beside)]
    zone = np.zeros_like(mask)
    for column, top in zip(columns, mask.argmax(axis=0)[columns]):
        zone[max(0, top - OVER) : top, column] = True
    return zone
