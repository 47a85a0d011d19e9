# SPDX-License-Identifier: Apache-2.0
"""The part of a picture in which blocks can be, as points over the table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception_node.observation import Observation

from .volume import Volume

Array = NDArray[np.float32]
Mask = NDArray[np.bool_]


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
    columns, rows = np.meshgrid(*(np.arange(side.start, side.stop) for side in box[::-1]))
    rays = camera.rays_world(np.stack([columns, rows], axis=-1)).astype(np.float32)
    points = camera.position_world.astype(np.float32) + rays * near[..., None]
    with np.errstate(invalid="ignore"):
        across = points[..., :2]
        inside = ((across > volume.low[:2]) & (across < volume.high[:2])).all(axis=-1)
        inside &= points[..., 2] < volume.high[2]
    sure = ~np.isnan(near) if observation.sure is None else observation.sure[box]
    return Region(box, part, near, sure, points, inside)
