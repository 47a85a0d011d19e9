# SPDX-License-Identifier: Apache-2.0
"""Things that colour shows and depth does not: too dark, shiny or transparent for the sensor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from perception_node.errors import BadImageError
from perception_node.masks import pixels_of

from .facets import Look, Mask, counts, mean_look
from .pieces import connected
from .region import Region

#: Of a thing that depth shows at least this part of the pixels has a depth.
MIN_DEPTH_SHARE: Final = 0.4
#: It is large enough to be a face of a block from this part of the picture's pixels on,
MIN_AREA: Final = 1.2e-3
#: and none if it fills more than this part of the part that shows the volume.
MAX_PART: Final = 0.1
#: What is behind everything looks the same everywhere: hues and brightness (natural logarithm) of
#: its parts differ by less than this.
SAME_HUE: Final = 0.03
SAME_LIGHT: Final = 0.16


def check_all_seen(
    region: Region,
    look: Look,
    links: Sequence[Mask],
    picture_area: int,
    labelled: Mask | None = None,
) -> None:
    """Raises BadImageError if something that may be a block has no depth.

    Args:
        links: see :func:`on_one_facet`.
        picture_area: of the picture that the region is a part of [px].
        labelled: pixels that are known to be of a block, shape (h, w) of the region.
    """
    missed = unseen(region, look, links, picture_area)
    if labelled is not None:
        missed &= ~labelled
        if np.count_nonzero(missed) < MIN_AREA * picture_area:
            return
    rows, columns = pixels_of(missed)
    if len(rows):
        row = int(np.median(rows)) + region.box[0].start
        column = int(np.median(columns)) + region.box[1].start
        raise BadImageError(
            f"what is at pixel ({column}, {row}) has no depth, so it is not known whether it is a "
            "block; check the depth camera, or take away what it cannot see"
        )


def unseen(region: Region, look: Look, links: Sequence[Mask], picture_area: int) -> Mask:
    """Pixels of things without depth that can be blocks, shape (h, w) of the region.

    What is so far behind the table that it has no depth is not among them: it reaches the region's
    edge or fills a great part of it, or looks like what does.

    Args:
        links: see :func:`on_one_facet`.
        picture_area: of the picture that the region is a part of [px].
    """
    everything, least = np.ones(region.depth.shape, bool), MIN_AREA * picture_area
    unknown, enough = ~np.isfinite(region.depth), (1.0 - MIN_DEPTH_SHARE) * least
    if np.count_nonzero(unknown) <= enough:
        return ~everything
    count, ids = connected(everything, links)
    pixels, without = counts(ids, unknown, count)
    if without.max() <= enough:
        return ~everything
    bare = (pixels >= least) & (pixels - without < MIN_DEPTH_SHARE * pixels)
    if not bare.any():
        return ~everything
    behind = bare & (pixels > MAX_PART * everything.size)
    for edge in (ids[0], ids[:, 0], ids[:, -1]):
        behind[edge] |= bare[edge]
    doubtful = np.flatnonzero(bare & ~behind)
    if not len(doubtful):
        return ~everything

    known = [mean_look(look, ids, facet) for facet in np.flatnonzero(behind).tolist()]
    for facet in doubtful.tolist():
        hue, light = mean_look(look, ids, facet)
        bare[facet] = not any(
            np.linalg.norm(hue - other) < SAME_HUE and abs(light - lit) < SAME_LIGHT
            for other, lit in known
        )
    return np.asarray((bare & ~behind)[ids])
