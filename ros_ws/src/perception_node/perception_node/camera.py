# SPDX-License-Identifier: Apache-2.0
"""The pinhole camera: between pixels and points in the world."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import BadImageError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PinholeCamera:
    """A calibrated camera without distortion. Pixel (u, v) = (column, row), centres at integers.

    One is equal to itself only: what follows from where a camera is, whatever it sees, is kept by
    it from picture to picture.

    Attributes:
        intrinsics: K, shape (3, 3) [px].
        world_from_optical: pose of the optical frame (x right, y down, z forward), shape (4, 4)
            [m].
        width, height: image size [px].
    """

    intrinsics: Array
    world_from_optical: Array
    width: int
    height: int

    def __post_init__(self) -> None:
        k, pose = self.intrinsics, self.world_from_optical
        if k.shape != (3, 3) or not np.isfinite(k).all() or k[0, 0] <= 0 or k[1, 1] <= 0:
            raise BadImageError("camera_info has no usable intrinsics K; calibrate the camera")
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise BadImageError("camera/extrinsics is not a finite transform")
        rotation = pose[:3, :3]
        if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-3:
            raise BadImageError("camera/extrinsics does not hold a unit quaternion")

    @functools.cached_property
    def position_world(self) -> Array:
        """The camera's centre, shape (3,) [m]."""
        return self.world_from_optical[:3, 3]

    def resized(self, width: int, height: int) -> PinholeCamera:
        """The same camera delivering images of another size.

        Raises:
            BadImageError: if the ratio of the sides differs, which resizing cannot explain.
        """
        if (width, height) == (self.width, self.height):
            return self
        x, y = width / self.width, height / self.height
        if abs(x / y - 1.0) > 0.02:
            raise BadImageError(
                f"image is {width}x{height} but the camera delivers {self.width}x{self.height}; "
                "send images with the camera's ratio of sides"
            )
        k = self.intrinsics.copy()
        k[0] *= x
        k[1] *= y
        # Pixel centres are at integers, so resizing also moves the origin by half a pixel.
        k[0, 2] += 0.5 * x - 0.5
        k[1, 2] += 0.5 * y - 0.5
        return PinholeCamera(k, self.world_from_optical, width, height)

    def project(self, points_world: ArrayLike) -> Array:
        """Pixels (u, v) of points, shape (..., 3) [m] -> (..., 2) [px]; NaN behind the camera."""
        points = np.asarray(points_world, dtype=np.float64) - self.position_world
        optical = points @ self.world_from_optical[:3, :3]
        depth = np.where(optical[..., 2] > 1e-6, optical[..., 2], np.nan)
        k, pixels = self.intrinsics, np.empty((*depth.shape, 2))
        for axis in (0, 1):
            pixels[..., axis] = k[axis, axis] * optical[..., axis] / depth + k[axis, 2]
        return pixels

    def rays_world(self, pixels: ArrayLike) -> Array:
        """Directions through pixels, (..., 2) [px] -> (..., 3), of length 1 along the optical axis.

        A point of depth d on the ray of a pixel is ``position_world + d * ray``.
        """
        pixels = np.asarray(pixels, dtype=np.float64)
        k, optical = self.intrinsics, np.ones((*pixels.shape[:-1], 3))
        for axis in (0, 1):
            optical[..., axis] = (pixels[..., axis] - k[axis, 2]) / k[axis, axis]
        return optical @ self.world_from_optical[:3, :3].T

    def points_world(
        self, depth: NDArray[np.float32], box: tuple[slice, slice]
    ) -> NDArray[np.float32]:
        """Where the pixels of a part of a picture are, shape (h, w, 3) [m]; NaN of NaN.

        Args:
            depth: along the optical axis, shape (h, w) [m].
            box: the rows and columns of the picture that the part has.
        """
        across, down = self.rays_apart(box)
        points = np.empty((*depth.shape, 3), np.float32)
        for axis, origin in enumerate(self.position_world):
            rays = down[:, None, axis] + across[:, axis]
            np.add(rays * depth, np.float32(origin), out=points[..., axis])
        return points

    def rays_apart(
        self, box: tuple[slice, slice]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """What the columns of a part of a picture add to the rays of its pixels, and its rows.

        Args:
            box: the rows and columns of the picture that the part has.

        Returns:
            Shapes (w, 3) and (h, 3), see :meth:`rays_world`.
        """
        (first_row, last_row), (first_column, last_column) = ((s.start, s.stop) for s in box)
        return _rays_apart(self, first_row, last_row, first_column, last_column)


@functools.lru_cache(maxsize=16)
def _rays_apart(
    camera: PinholeCamera, top: int, bottom: int, left: int, right: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    rows, columns = np.arange(top, bottom), np.arange(left, right)
    across = camera.rays_world(np.stack([columns, np.zeros_like(columns)], axis=-1))
    down = camera.rays_world(np.stack([np.zeros_like(rows), rows], axis=-1))
    down -= camera.rays_world((0.0, 0.0))
    return across.astype(np.float32), down.astype(np.float32)
