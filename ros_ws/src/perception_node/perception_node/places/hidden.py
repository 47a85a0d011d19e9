# SPDX-License-Identifier: Apache-2.0
"""Where blocks can be that other blocks hide: of two rows, the one behind the other (5.4.3).

The column over a place is filled with a grid of points. A point is free if the camera sees through
it. A block can only be where none of its points is free, so where the smallest block fits nowhere,
there is none.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.observation import Observation
from perception_node.segment import Segments
from scene_graph import BlockPose, Place

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Distance of two neighbouring points [m].
CELL: Final = 0.005
#: A point is free if what is seen there is further behind it than this [m].
BEHIND: Final = 0.006
#: Half of the width of a block that hides another one, and of the other [m].
HALF_WIDTH: Final = 0.026
#: What has no depth this near to a block may be of it [px].
RIM: Final = 3


#: Points inside of a block, as parts of its size from its middle.
INSIDE: Final = np.linspace(-0.35, 0.35, 5)


@dataclass(frozen=True)
class Cells:
    """The points over one place.

    Attributes:
        free: whether the camera sees through them, shape (z, y, x).
        floor: height of the lowest ones [m].
    """

    free: Mask
    floor: float

    def can_hide(
        self, low: float, edge: float, middle: tuple[float, float] = (0.0, 0.0), reach: float = 1.0
    ) -> bool:
        """Whether a cube of some edge can stand hidden at a height [m].

        Args:
            middle: of what it stands on, from the place's centre, (x, y) [m].
            reach: how far beside that its own middle can be, along x and y [m].
        """
        layers = round(edge / CELL) + 1
        first = max(0, round((low - self.floor) / CELL))
        slab = self.free[first : first + layers]
        if len(slab) < layers:
            return False
        fits = _windows(np.asarray(slab.any(axis=0)), layers)
        centres = CELL * (np.arange(len(fits)) - 0.5 * (len(fits) - 1))
        x, y = (np.abs(centres - at) <= reach for at in middle)
        return bool((fits & y[:, None] & x).any())

    def hidden_above(self, low: float, edge: float) -> float:
        """How far up from a height nothing is seen of something of that width [m]."""
        first, layers = max(0, round((low - self.floor) / CELL)), round(edge / CELL) + 1
        top = first
        while top < len(self.free) and _windows(self.free[top], layers).any():
            top += 1
        return CELL * (top - first)


def seen_through(views: Sequence[Sequence[Cells]]) -> tuple[Cells, ...]:
    """The points over each place of which some camera sees that they are free.

    Args:
        views: of each camera the points over the same places.
    """
    return tuple(
        Cells(np.logical_or.reduce([cells.free for cells in over]), over[0].floor)
        for over in zip(*views)
    )


def _windows(free: Mask, size: int) -> Mask:
    """Which squares of points have no free one in them, shape (y, x) -> (y', x')."""
    sums = np.pad(free.astype(int), ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    inside = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
    return np.asarray(inside == 0)


def cells_over(
    observation: Observation,
    segments: Segments,
    places: Sequence[Place],
    half_width: float,
    height: float,
) -> tuple[Cells, ...]:
    """The points over each place; all are free where there is no depth or no camera.

    Args:
        half_width, height: of the columns [m].
    """
    depth, camera = observation.depth, observation.camera
    if depth is None or camera is None:
        free = np.ones(_grid(half_width, height).shape[:-1], bool)
        return tuple(Cells(free, place.position_world[2]) for place in places)
    with np.errstate(invalid="ignore"):
        known = np.isfinite(depth) & (depth > 0.0)
    seen = np.where(known, depth, np.inf)
    near_block = cv2.dilate(
        (segments.label_image > 0).astype(np.uint8), np.ones((2 * RIM + 1,) * 2, np.uint8)
    )
    seen[~known & (near_block > 0)] = 0.0
    return tuple(
        Cells(
            _is_free(seen, *_seen_at(camera, place.position_world, half_width, height)),
            place.position_world[2],
        )
        for place in places
    )


def _grid(half_width: float, height: float) -> Array:
    """The points over a place at the origin, shape (z, y, x, 3) [m]."""
    steps = round(half_width / CELL)
    across = CELL * np.arange(-steps, steps + 1)
    z, y, x = np.meshgrid(np.arange(0.0, height, CELL), across, across, indexing="ij")
    return np.stack([x, y, z], axis=-1)


def _is_free(seen: Array, pixels: NDArray[np.int32], depths: Array) -> Mask:
    """Whether what is seen at points is behind them, see :func:`_seen`."""
    return np.asarray(seen.ravel()[pixels] > depths)


@functools.lru_cache(maxsize=16)
def _seen_at(
    camera: PinholeCamera, foot: tuple[float, float, float], half_width: float, height: float
) -> tuple[NDArray[np.int32], Array]:
    """As :func:`_seen` of the points over a place; kept, as places stay where they are."""
    return _seen(camera, _grid(half_width, height) + foot)


def _seen(camera: PinholeCamera, points: Array) -> tuple[NDArray[np.int32], Array]:
    """Where points are seen, shape (..., 3) [m].

    Returns:
        Their pixels, as indices of the flattened picture, and which depths there are behind them:
        those of points outside of the picture are behind nothing, both of shape (...) [m].
    """
    pixels = np.nan_to_num(camera.project(points), nan=-1.0)
    columns, rows = np.rint(pixels).astype(int).transpose(-1, *range(pixels.ndim - 1))
    inside = (rows >= 0) & (rows < camera.height) & (columns >= 0) & (columns < camera.width)
    far = (points - camera.position_world) @ camera.world_from_optical[:3, 2]
    # Outside of it a depth of 0 counts as seen: in front of all but what is behind the camera.
    far = np.where(inside | (far + BEHIND < 0.0), far + BEHIND, np.inf)
    places = np.where(inside, rows * camera.width + columns, 0)
    return places.astype(np.int32), far


def free_share(observation: Observation, block: BlockPose) -> float:
    """How much of a block's inside the camera sees through, 0..1; none where depth is unknown."""
    depth, camera = observation.depth, observation.camera
    if depth is None or camera is None:
        return 0.0
    with np.errstate(invalid="ignore"):
        seen = np.where(np.isfinite(depth) & (depth > 0.0), depth, 0.0)
    points = np.stack(np.meshgrid(*[INSIDE] * 3, indexing="ij"), axis=-1) * block.size
    c, s = np.cos(block.yaw), np.sin(block.yaw)
    points = points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + block.position_world
    return float(_is_free(seen, *_seen(camera, points)).mean())


def with_clear_heights(places: Sequence[Place], camera: PinholeCamera) -> tuple[Place, ...]:
    """The places with how high a stack on each may be that hides nothing on each other one."""
    corners = np.array([[i, j] for i in (-1.0, 0.0, 1.0) for j in (-1.0, 0.0, 1.0)]) * HALF_WIDTH
    clear = []
    for near in places:
        heights = []
        for far in places:
            feet = np.column_stack([corners, np.zeros(len(corners))]) + far.position_world
            hides = near.row < far.row
            heights.append(
                float(_height_over(feet, np.array(near.position_world), camera, HALF_WIDTH))
                if hides
                else np.inf
            )
        clear.append(tuple(heights))
    return tuple(replace(place, clear=heights) for place, heights in zip(places, clear))


def _height_over(feet: Array, near: Array, camera: PinholeCamera, half: float) -> float:
    """Height over the table of the lowest ray from the camera to points, over a square [m].

    Infinite where no ray passes over it.
    """
    start = camera.position_world
    way = feet - start
    with np.errstate(divide="ignore", invalid="ignore"):
        bounds = [(near[:2] + sign * half - start[:2]) / way[:, :2] for sign in (-1.0, 1.0)]
    enter, leave = np.minimum(*bounds).max(axis=1), np.maximum(*bounds).min(axis=1)
    over = (leave > enter) & (leave > 0.0) & (enter < 1.0)
    if not over.any():
        return float("inf")
    heights = start[2] + np.minimum(leave[over], 1.0) * way[over, 2] - near[2]
    return max(0.0, float(heights.min()))
