# SPDX-License-Identifier: Apache-2.0
"""Whether something that is not a block hides part of the places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from .camera_model import PinholeCamera

Array = NDArray[np.float64]

#: Things lower than this above the table hide nothing: shadows, the table itself [m].
MIN_HEIGHT: Final = 0.01


@dataclass(frozen=True)
class PlaceVolumes:
    """The upright columns of space in which blocks can stand.

    Attributes:
        positions_world: centres of the m places on the table, shape (m, 3) [m].
        half_width: half the side of a column [m].
        height: of a column: the highest tower [m].
    """

    positions_world: Array
    half_width: float
    height: float

    def region(self, camera: PinholeCamera, place: int) -> NDArray[np.bool_]:
        """Pixels behind which a column may be, shape (height, width)."""
        x, y, z = self.positions_world[place]
        return box_region(
            camera,
            (x, y, z + 0.5 * self.height),
            (2.0 * self.half_width, 2.0 * self.half_width, self.height),
        )

    def greatest_depth(self, camera: PinholeCamera) -> float:
        """Depth along the optical axis that no point of the columns exceeds [m]."""
        forward = camera.world_from_optical[:3, 2]
        feet = (self.positions_world - camera.position_world) @ forward
        aside = self.half_width * (abs(forward[0]) + abs(forward[1]))
        return float(feet.max() + aside + max(self.height * forward[2], 0.0))

    def hides(self, points_world: Array, camera: PinholeCamera) -> NDArray[np.bool_]:
        """Whether points are inside the slab that holds the columns, or between it and the camera.

        Args:
            points_world: shape (..., 3) [m]; NaN hides nothing.
        """
        toward = camera.position_world[:2] - self.positions_world[:, :2].mean(0)
        if len(self.positions_world) > 1:
            row = self.positions_world[-1, :2] - self.positions_world[0, :2]
            toward = toward - row * (toward @ row) / (row @ row)
        toward = toward / np.linalg.norm(toward)
        back = (self.positions_world[:, :2] @ toward).min() - self.half_width
        table = self.positions_world[:, 2].min()
        with np.errstate(invalid="ignore"):
            return (points_world[..., :2] @ toward > back) & (
                points_world[..., 2] > table + MIN_HEIGHT
            )


def box_region(
    camera: PinholeCamera,
    centre_world: tuple[float, float, float],
    size: tuple[float, float, float],
    yaw: float = 0.0,
) -> NDArray[np.bool_]:
    """Pixels behind which an upright box may be; none if part of it is behind the camera.

    Args:
        centre_world, size: of the box [m].
        yaw: about world z [rad].

    Returns:
        Shape (height, width).
    """
    corners = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    corners = corners * size
    c, s = np.cos(yaw), np.sin(yaw)
    corners = corners @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + centre_world
    region = np.zeros((camera.height, camera.width), np.uint8)
    pixels = camera.project(corners)
    if np.isfinite(pixels).all():
        hull = cv2.convexHull(np.round(np.clip(pixels, -1e6, 1e6)).astype(np.int32))
        cv2.fillConvexPoly(region, hull, 1)
    return region.astype(bool)


def hidden_pixels(
    labels: NDArray[np.integer],
    depth: NDArray[np.floating],
    camera: PinholeCamera,
    volumes: PlaceVolumes,
    region: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Pixels of a region where something without a label is in front of or among the places.

    Args:
        labels, depth, region: shape (height, width); depth in m.

    Returns:
        Shape (height, width).
    """
    # What is deeper than every column is behind them: most of the image, without any geometry.
    with np.errstate(invalid="ignore"):
        near = (depth > 0) & (depth < volumes.greatest_depth(camera))
    rows, columns = np.nonzero(region & (labels == 0) & near)
    rays = camera.rays_world(np.stack([columns, rows], axis=-1))
    points = camera.position_world + rays * depth[rows, columns, None]
    hidden = np.zeros(labels.shape, bool)
    hides = volumes.hides(points, camera)
    hidden[rows[hides], columns[hides]] = True
    return hidden
