# SPDX-License-Identifier: Apache-2.0
"""The trivial way to find blocks in colour: connected pixels of a colour that the room has not."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node import Observation, Segments, Volume
from perception_node.errors import BadImageError

#: Into so many colours the pixels around the places are sorted, by k-means in CIE Lab.
COLORS: Final = 10
#: Brightness counts this much beside hue: faces of one block differ in it.
LIGHT: Final = 0.35
#: The room's are those that most of the sides and the upper edge have: so much of a colour's
#: pixels, or of the edges.
OF_ROOM: Final = 0.02
#: A part with fewer pixels is no block.
LEAST: Final = 40


def find_by_color(observation: Observation, volume: Volume | None = None) -> Segments:
    """Each connected part of one colour is a block, unless the room has that colour.

    Raises:
        BadImageError: if it is not known where the places are in the picture.
    """
    box = (
        None if volume is None or observation.camera is None else volume.seen_by(observation.camera)
    )
    if box is None:
        raise BadImageError("the places are not in the picture")
    kinds, edges = _sorted(observation.rgb[box])
    room = np.bincount(edges, minlength=COLORS) > OF_ROOM * len(edges)
    labels = np.zeros(observation.rgb.shape[:2], np.int32)
    part, found = labels[box], 0
    for kind in np.flatnonzero(~room):
        mask = cv2.morphologyEx((kinds == kind).astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2)))
        count, parts, stats, _ = cv2.connectedComponentsWithStats(mask)
        for number in range(1, count):
            if stats[number, cv2.CC_STAT_AREA] >= LEAST:
                found += 1
                part[parts == number] = found
    return Segments.from_labels(labels, "colours", np.zeros(labels.shape, bool))


def _sorted(rgb: NDArray[np.uint8]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The colour of every pixel as a number, and those along the left, right and upper edge."""
    lab = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2LAB).astype(np.float32)
    lab[..., 0] *= LIGHT
    criteria = (cv2.TERM_CRITERIA_MAX_ITER, 15, 0.0)
    cv2.setRNGSeed(0)
    start = np.zeros(0, np.int32)
    pixels = lab.reshape(-1, 3)
    _, flat, _ = cv2.kmeans(pixels, COLORS, start, criteria, 2, cv2.KMEANS_PP_CENTERS)
    kinds = np.asarray(flat, np.int32).reshape(rgb.shape[:2])
    return kinds, np.concatenate([kinds[0], kinds[:, 0], kinds[:, -1]])
