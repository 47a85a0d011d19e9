# SPDX-License-Identifier: Apache-2.0
"""Strips of blocks' faces: sides and lids seen at a flat angle, rims that look like something else.

Each goes to the block that it touches and that is as high as it is.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from .facets import on_one_body
from .levels import levels
from .pieces import Heights, Ids, ends_by_number, links_of, spread
from .region import Region

#: Heights that differ by less are the same [m],
SAME_HEIGHT: Final = 0.006
#: and of a pixel beside where two blocks meet, if they differ by less than this.
NEARLY: Final = 0.003


def take_strips(labels: NDArray[Any], pieces: Ids, region: Region, width: int) -> None:
    """Gives strips beside and above faces the labels of the blocks that they belong to.

    Of the blocks that they touch it is the one as high as they are: of one further down in a tower
    a side is seen beside the front of the next. What looks the same goes first. What has the label
    of a block that is nowhere as high loses it.

    Args:
        labels: shape (h, w), changed.
        pieces: numbers of the facets with their strips, of the upper rows, shape (h' <= h, w).
        region: whose pixels these are.
        width: of the strips at most [px].
    """
    height = region.points[..., 2]
    numbers, values = labels.astype(np.int32).ravel(), height.reshape(-1, 1)
    low, high = ends_by_number(numbers, values, int(labels.max()) + 1)
    lowest, highest = levels(labels, region.points)
    lowest, highest = lowest - NEARLY, highest + NEARLY
    pieces = np.pad(pieces, ((0, len(labels) - len(pieces)), (0, 0)))
    strips = pieces > 0
    with np.errstate(invalid="ignore"):
        labels[strips & ((height < lowest[labels]) | (height > highest[labels]))] = 0
    as_high = Heights(
        height,
        np.maximum(lowest, low[:, 0] - SAME_HEIGHT),
        np.minimum(highest, high[:, 0] + SAME_HEIGHT),
    )
    in_reach = Heights(height, lowest, highest)
    near = on_one_body(region.points, region.depth)
    alike = [link & same for link, same in zip(near, links_of(pieces))]
    for links, heights in ((alike, as_high), (near, as_high), (near, in_reach)):
        spread(labels, strips, width, links, heights)
