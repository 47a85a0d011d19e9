# SPDX-License-Identifier: Apache-2.0
"""Labels that came with the image, of the detector that 5.2.1 assumes.

A detector knows which blocks there are; where exactly they end, colour and depth know better. So
where both are there, each label gets the pixels of what it overlaps most.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError
from perception_node.observation import Observation

from .mending import mended
from .rgbd import find_in_rgbd
from .segments import Segments
from .volume import Volume

#: A label and what was found in colour and depth are of one block if they share this part of the
#: pixels of both together.
SAME_BLOCK: Final = 0.4
#: What was found is a label's, too, if at least this part of it is inside.
INSIDE: Final = 0.6


def given_labels(observation: Observation, volume: Volume | None = None) -> Segments:
    """The segments that the observation's own labels show, their outlines made exact by depth.

    Without depth, camera or volume only those errors are undone that colours tell.

    Raises:
        BadImageError: if it has no labels, or such that nobody can tell which blocks there are.
    """
    labels = observation.labels
    if labels is None:
        raise BadImageError(
            "the image comes without instance labels; give them, or a segmenter that needs none"
        )
    if volume is None or observation.depth is None or observation.camera is None:
        return Segments.from_labels(mended(labels, observation.rgb))
    return Segments.from_labels(_snapped(labels, find_in_rgbd(observation, volume, labels > 0)))


def _snapped(labels: NDArray[np.integer], found: Segments) -> NDArray[np.integer]:
    """The labels, those that cover about the pixels of something that was found cover just them.

    Where one label covers several things, the largest keeps it, the others get new ones.
    """
    snapped = labels.astype(np.int32)
    # Specks that are scattered over the picture say nothing of where a block is.
    sizes = {
        given.label: int(np.count_nonzero(given.part)) for given in Segments.from_labels(labels)
    }
    matched: dict[int, NDArray[np.bool_]] = {}
    free = int(labels.max(initial=0)) + 1
    for segment in sorted(found, key=lambda segment: -np.count_nonzero(segment.mask)):
        inside = np.bincount(labels[segment.mask])
        inside[:1] = 0
        if not inside.any():
            continue
        label = int(inside.argmax())
        both, all_of_it = int(inside[label]), int(np.count_nonzero(segment.mask))
        mine = sizes.get(label, 0)
        if label not in matched and both >= SAME_BLOCK * (all_of_it + mine - both):
            matched[label] = segment.mask
        elif both >= INSIDE * all_of_it:
            matched[free] = segment.mask
            free += 1
    for label in matched:
        snapped[snapped == label] = 0
    for label, mask in matched.items():
        snapped[mask] = label
    return snapped
