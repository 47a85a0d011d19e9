# SPDX-License-Identifier: Apache-2.0
"""The part of a picture around one block, as points in world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class BlockView:
    """The part of the image around a block, with one pixel more on every side.

    Attributes:
        mask: shape (h, w).
        rays: directions of the pixels in world, also of those outside the image, shape (h, w, 3).
        points: in world, NaN without depth, shape (h, w, 3) [m].
        origin: the camera's centre in world, shape (3,) [m].
    """

    mask: Mask
    rays: Array
    points: Array
    origin: Array

    @classmethod
    def around(
        cls,
        mask: Mask,
        depth: NDArray[np.floating],
        camera: PinholeCamera,
        rows: NDArray[np.intp],
        columns: NDArray[np.intp],
    ) -> BlockView:
        """``rows`` and ``columns`` are those that show the block, in order."""
        top, bottom, left, right = rows[0] - 1, rows[-1] + 2, columns[0] - 1, columns[-1] + 2
        u, v = np.meshgrid(np.arange(left, right), np.arange(top, bottom))
        rays = camera.rays_world(np.stack([u, v], axis=-1))
        height, width = mask.shape
        inside = np.s_[max(top, 0) : min(bottom, height), max(left, 0) : min(right, width)]
        shifted = np.s_[
            inside[0].start - top : inside[0].stop - top,
            inside[1].start - left : inside[1].stop - left,
        ]
        part = np.zeros(u.shape, bool)
        part[shifted] = mask[inside]
        distance = np.full(u.shape, np.nan)
        distance[shifted] = depth[inside]
        distance[~(distance > 0.0) | np.isinf(distance)] = np.nan
        origin = camera.position_world
        return cls(part, rays, origin + rays * distance[..., None], origin)
