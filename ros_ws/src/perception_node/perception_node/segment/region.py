# SPDX-License-Identifier: Apache-2.0
"""The part of a picture in which blocks can be, as points over the table."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from perception_node.camera import PinholeCamera
from perception_node.observation import Observation

from .volume import Volume

Array = NDArray[np.float32]
Mask = NDArray[np.bool_]
Box = tuple[slice, slice]

_FILE: Final = Path(__file__).with_suffix(".c")


@dataclass(frozen=True)
class Region:
    """A rectangle of a picture.

    Attributes:
        box: where it is in the picture: rows, columns.
        rgb: shape (h, w, 3).
        depth: NaN where it is unknown, shape (h, w) [m].
        sure: where it is as measured, shape (h, w).
        points: in world, NaN without depth, shape (h, w, 3) [m].
        inside: pixels whose points are over or beside the places, shape (h, w).
    """

    box: tuple[slice, slice]
    rgb: NDArray[np.uint8]
    depth: Array
    sure: Mask
    points: Array
    inside: Mask

    def part(self, box: tuple[slice, slice]) -> Region:
        """A smaller rectangle, given by its rows and columns of this one."""
        where = tuple(
            slice(outer.start + inner.start, outer.start + inner.stop)
            for outer, inner in zip(self.box, box)
        )
        return Region(
            (where[0], where[1]),
            self.rgb[box],
            self.depth[box],
            self.sure[box],
            self.points[box],
            self.inside[box],
        )


def look_at(observation: Observation, volume: Volume) -> Region | None:
    """The part of a picture that shows a volume; None where none of it is in the picture.

    Args:
        observation: with depth and camera.
    """
    camera, depth = observation.camera, observation.depth
    assert camera is not None and depth is not None
    box = volume.seen_by(camera)
    if box is None:
        return None
    part = np.ascontiguousarray(observation.rgb[box])
    near = depth[box].astype(np.float32)
    near[~(near > 0.0) | np.isinf(near)] = np.nan
    points, inside = _points(camera, near, box, volume)
    sure = ~np.isnan(near) if observation.sure is None else observation.sure[box]
    return Region(box, part, near, sure, points, inside)


def _points(camera: PinholeCamera, depth: Array, box: Box, volume: Volume) -> tuple[Array, Mask]:
    """Points in world, shape (h, w, 3) [m], and which are over or beside the places, (h, w)."""
    library = written(_FILE)
    if library is None:
        return points_by_numpy(camera, depth, box, volume)
    across, down = camera.rays_apart(box)
    points, inside = np.empty((3, *depth.shape), np.float32), np.empty(depth.shape, bool)
    origin = camera.position_world.astype(np.float32)
    arrays = (depth, across.T, down, origin, *_between(volume), points, inside)
    library.points(*depth.shape, *map(address, map(np.ascontiguousarray, arrays)))
    return points.transpose(1, 2, 0), inside


def _between(volume: Volume) -> tuple[Array, Array]:
    """The numbers of 32 bits that are next to a volume's corners: above those and below these.

    A number of 32 bits is less than one of 64, or greater, where it is than these.
    """
    low, high = volume.low.astype(np.float32), volume.high.astype(np.float32)
    low = np.where(low > volume.low, np.nextafter(low, np.float32(-np.inf)), low)
    high = np.where(high < volume.high, np.nextafter(high, np.float32(np.inf)), high)
    return low, high


def points_by_numpy(
    camera: PinholeCamera, depth: Array, box: Box, volume: Volume
) -> tuple[Array, Mask]:
    """As :func:`_points`."""
    points = camera.points_world(depth, box)
    with np.errstate(invalid="ignore"):
        inside = points[..., 2] < volume.high[2]
        for axis in (0, 1):
            column = points[..., axis]
            inside &= (column > volume.low[axis]) & (column < volume.high[axis])
    return points, inside
