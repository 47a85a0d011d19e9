# SPDX-License-Identifier: Apache-2.0
"""Where a camera is set up so that it sees all places, from a given side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from tasks.family import Viewpoint

#: What lies around a place or over the highest stack and shall be in the picture, too [m].
_MARGIN: Final = 0.05
#: By so much the camera is moved away until all is in the picture [m].
_STEP: Final = 0.01
_FARTHEST: Final = 3.0


def camera_of(
    view: Viewpoint, places: Sequence[tuple[float, float]], highest: float, azimuth: float
) -> dict[str, Any]:
    """The camera's entry in a scene file.

    Args:
        places: (x, y) in world, from the left of the image [m].
        highest: height of the highest stack that there may be [m].
        azimuth: of the camera around the row's middle, seen from above, from the row's own
            front [rad].

    Raises:
        ValueError: the places do not fit into any picture.
    """
    points = np.array(places, float)
    middle = 0.5 * (points[0] + points[-1])
    along = points[-1] - points[0]
    # The row runs from the left of the image to the right; its front is where the camera is.
    front = math.atan2(-along[0], along[1])
    side = front + azimuth
    target = np.array([*middle, view.target_height])
    distance = view.distance
    while distance < _FARTHEST:
        position = target + distance * np.array(
            [math.cos(side), math.sin(side), math.tan(view.elevation)]
        )
        if _sees(position, target, view.vertical_fov, points, highest):
            return {
                "name": "camera",
                "position": [round(float(value), 4) for value in position],
                "target": [round(float(value), 4) for value in target],
                "vertical_fov": view.vertical_fov,
                "width": view.size,
                "height": view.size,
            }
        distance += _STEP
    raise ValueError(f"no camera within {_FARTHEST:g} m sees places {places}")


def _sees(
    position: np.ndarray, target: np.ndarray, fov: float, places: np.ndarray, highest: float
) -> bool:
    """Whether all places and what may stand there, with a margin, are in a square picture."""
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    half = math.tan(0.5 * fov)
    for x, y in places:
        for height in (-_MARGIN, highest + _MARGIN):
            ray = np.array([x, y, height]) - position
            depth = float(ray @ forward)
            aside, below = abs(float(ray @ right)) + _MARGIN, abs(float(ray @ down))
            if aside > half * depth or below > half * depth:
                return False
    return True
