# SPDX-License-Identifier: Apache-2.0
"""Things drawn behind the row into views that have been rendered without them: many, for little.

A thing behind a tower is seen over its top as a block on it would be, but for what is between: the
top of the highest block, which a block on it hides. A point x to the right, d behind the row and z
over the table is seen at the column of x, and steepness · d + z over the row's foot; what is
further away is seen smaller.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.segment.front_view import PITCH

Floats = NDArray[np.float32]
#: Corners to the right and up of the middle of the foot, (n, 2) [m], and how bright it is.
Face = tuple[NDArray[np.float64], float]

#: Things of which so many are drawn at most.
MOST: Final = 3
#: The share of them that are about as large as a block, and of those right behind one.
LIKE_BLOCKS: Final = 0.5
RIGHT_BEHIND: Final = 0.6
#: The middle of a thing is so far from every place, and its width times this further [m].
GAP: Final = 0.05
HALF: Final = 0.7
#: Distances of cameras from the row [m].
NEAREST: Final = 0.7
FARTHEST: Final = 1.4
#: Vertices are drawn as exactly as this part of a pixel, as a power of two.
EXACT: Final = 4


def with_clutter(
    picture: Floats,
    labels: NDArray[np.uint8],
    before: NDArray[np.bool_],
    place: tuple[Floats, Floats, float],
    color: Callable[[], Floats],
    rng: np.random.Generator,
) -> Floats:
    """A picture with things that stand behind the blocks, and behind what hides them.

    Args:
        picture: in 0..1, shape (h, w, 3).
        labels: of blocks, shape (h, w).
        before: what hides the places, shape (h, w).
        place: feet, aside and steepness of the view, see :class:`FrontView`.
        color: gives one to each thing, shape (3,).
    """
    feet, aside, steepness = place
    drawn = picture.copy()
    columns = np.nonzero((labels > 0).any(axis=0))[0]
    for _ in range(int(rng.integers(1, MOST + 1))):
        if rng.random() < LIKE_BLOCKS:
            width, height = rng.uniform(0.026, 0.07), rng.uniform(0.026, 0.08)
        else:
            width, height = rng.uniform(0.02, 0.12), rng.uniform(0.02, 0.25)
        middle = int(rng.integers(picture.shape[1]))
        if len(columns) and rng.random() < RIGHT_BEHIND:
            middle = int(rng.choice(columns) + rng.normal(0.0, 5.0))
        column = min(max(middle, 0), picture.shape[1] - 1)
        gap = GAP + HALF * width
        least = np.sqrt(max(gap**2 - (PITCH * float(aside[column])) ** 2, 0.0))
        distance = float(least + 0.3 * rng.random() ** 1.5)
        foot = float(feet[column]) - steepness * distance / PITCH
        scale = 1.0 / (PITCH * (1.0 + distance / rng.uniform(NEAREST, FARTHEST)))
        body = _box if rng.random() < 0.6 else _cylinder
        own = color()
        for face, shade in body(width, height, steepness, rng):
            points = np.array([middle, foot]) + scale * face * [1.0, -1.0]
            paint = [float(value) for value in np.clip(shade * own, 0.0, 1.0)]
            fixed = np.round(points * 2**EXACT).astype(np.int32)
            cv2.fillConvexPoly(drawn, fixed, paint, cv2.LINE_8, EXACT)
    hidden = (labels > 0) | before
    return np.where(hidden[..., None], picture, drawn)


def _box(width: float, height: float, steepness: float, rng: np.random.Generator) -> list[Face]:
    """Of an upright box, turned anyhow: its sides that are seen, and its top."""
    depth = width * rng.uniform(0.5, 1.0) if rng.random() < 0.5 else width
    yaw, lit = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.0, 2.0 * np.pi)
    corners = 0.5 * np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]])
    c, s = np.cos(yaw), np.sin(yaw)
    corners = corners @ np.array([[c, s], [-s, c]])
    low = corners * [1.0, steepness]
    faces: list[Face] = []
    for index in range(4):
        pair = [index, (index + 1) % 4]
        # The outward normal of a side from a to b, of corners in a turn to the left.
        along = corners[pair[1]] - corners[pair[0]]
        if -along[0] < 0.0:
            shade = 0.75 + 0.25 * np.cos(np.arctan2(along[0], along[1]) - lit)
            face = np.concatenate([low[pair], low[pair[::-1]] + [0.0, height]])
            faces.append((face, float(shade)))
    return [*faces, (low + [0.0, height], float(rng.uniform(0.9, 1.3)))]


def _cylinder(
    width: float, height: float, steepness: float, rng: np.random.Generator
) -> list[Face]:
    """Of an upright cylinder: strips of its side, and its top."""
    turns = np.linspace(-np.pi, 0.0, 13)
    lit = rng.uniform(-np.pi, 0.0)
    ring = 0.5 * width * np.stack([np.cos(turns), steepness * np.sin(turns)], axis=-1)
    faces: list[Face] = []
    for index in range(len(turns) - 1):
        pair = [index, index + 1]
        shade = 0.75 + 0.25 * np.cos(0.5 * (turns[index] + turns[index + 1]) - lit)
        faces.append((np.concatenate([ring[pair], ring[pair[::-1]] + [0.0, height]]), float(shade)))
    top = np.concatenate([ring, -ring[1:-1]]) + [0.0, height]
    return [*faces, (top, float(rng.uniform(0.9, 1.3)))]
