# SPDX-License-Identifier: Apache-2.0
"""Cameras: where they are, what they look at, and their lenses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray

from .distortion import FoldedPictureError, undistorted
from .errors import SceneError
from .reading import Count, Key, Within

Vector = tuple[float, float, float]
Array = NDArray[np.float64]

_Place = Within(-5.0, 5.0, "m")
#: The name of the first camera, whose topics perception listens to.
FIRST: Final = "camera"
#: Directions closer than this to the vertical leave open which side of the picture is up [rad].
_LEAST_TILT: Final = 0.005


@dataclass(frozen=True)
class CameraConfig:
    """A camera that looks at the places from the front, opposite to the robot.

    Attributes:
        width, height: image size [px].
        position_world, target_world: where it is and what it looks at [m].
        vertical_fov: full opening angle, without distortion [rad].
        near, far: clipping distances [m].
        name: its topics are ``NAME/image_raw``, …
        distortion: of the lens, "plumb_bob": k1, k2, p1, p2, k3.
    """

    width: Annotated[int, Within(128, 1280, "px")] = 256
    height: Annotated[int, Within(128, 720, "px")] = 256
    position_world: Annotated[Vector, Key("position"), _Place] = (1.45, 0.0, 0.40)
    target_world: Annotated[Vector, Key("target"), _Place] = (0.50, 0.0, 0.155)
    vertical_fov: Annotated[float, Within(0.1, 2.5, "rad")] = 0.52
    near: Annotated[float, Key(None)] = 0.1
    far: Annotated[float, Key(None)] = 3.0
    name: str = FIRST
    distortion: Annotated[tuple[float, ...], Count(5, 5), Within(-2.0, 2.0)] = (0.0,) * 5

    @property
    def intrinsics(self) -> NDArray[np.float64]:
        """K, shape (3, 3) [px], of pixels whose centres have whole coordinates.

        pybullet's software renderer looks through the left and lower corner of each pixel.
        """
        focal = 0.5 * self.height / np.tan(0.5 * self.vertical_fov)
        return np.array(
            [
                [focal, 0.0, 0.5 * self.width],
                [0.0, focal, 0.5 * self.height - 1.0],
                [0.0, 0.0, 1.0],
            ]
        )

    @property
    def world_from_optical(self) -> NDArray[np.float64]:
        """Pose of the optical frame (x right, y down, z forward) in world, shape (4, 4) [m]."""
        position, target = np.array(self.position_world), np.array(self.target_world)
        forward = (target - position) / np.linalg.norm(target - position)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        pose = np.eye(4)
        pose[:3, 0], pose[:3, 1], pose[:3, 2] = right, np.cross(forward, right), forward
        pose[:3, 3] = position
        return pose

    def pixels(self, points_world: Array) -> Array:
        """Where points are in the picture, without distortion: shape (n, 3) [m] -> (n, 3).

        Columns and rows [px], and the distances along the optical axis [m].
        """
        pose = self.world_from_optical
        x, y, z = ((points_world - pose[:3, 3]) @ pose[:3, :3]).T
        with np.errstate(divide="ignore", invalid="ignore"):
            k = self.intrinsics
            return np.column_stack([k[0, 0] * x / z + k[0, 2], k[1, 1] * y / z + k[1, 2], z])

    def sees(self, points_world: Array) -> NDArray[np.bool_]:
        """Which points are in the picture, if nothing hides them: shape (n, 3) [m] -> (n,)."""
        column, row, depth = self.pixels(points_world).T
        inside = (column >= 0) & (column <= self.width - 1) & (row >= 0) & (row <= self.height - 1)
        return np.asarray(inside & (depth > self.near) & (depth < self.far))


def check_cameras(cameras: Sequence[CameraConfig], places_world: Array, key: str) -> None:
    """Raises SceneError for cameras that cannot be, or that see none of the places.

    Args:
        places_world: shape (m, 3) [m].
    """
    names: list[str] = []
    for number, camera in enumerate(cameras):
        here = f"{key}[{number}]"
        _check_name(camera.name, names, here)
        names.append(camera.name)
        sight = np.subtract(camera.target_world, camera.position_world)
        if np.linalg.norm(sight) < 0.01:
            raise SceneError(
                f"{here}.target", f"= {list(camera.target_world)} is where the camera itself is"
            )
        if np.linalg.norm(sight[:2]) < _LEAST_TILT * np.linalg.norm(sight):
            raise SceneError(
                f"{here}.target",
                f"= {list(camera.target_world)} is straight below or above position, and nothing "
                "says which side of the picture is up; move one of them by a centimetre",
            )
        if camera.position_world[2] < 0.02:
            raise SceneError(
                f"{here}.position", "is not above the table; its third number, the height, is "
                "0.02 m or more",
            )  # fmt: skip
        _check_lens(camera, f"{here}.distortion")
        if not camera.sees(places_world).any():
            raise SceneError(
                f"{here}.target",
                f"= {list(camera.target_world)} leaves none of the places in the picture within "
                f"{camera.near:g} to {camera.far:g} m",
            )


def _check_name(name: str, others: Sequence[str], key: str) -> None:
    if not others and name != FIRST:
        raise SceneError(f"{key}.name", f"= {name!r}: the first one is called {FIRST}")
    if name in others:
        raise SceneError(f"{key}.name", f"= {name!r} is that of another one; give it its own")
    if not (name.isidentifier() and name.isascii() and name.islower()) or "__" in name:
        raise SceneError(
            f"{key}.name", f"= {name!r} cannot name a topic; small letters, digits and _ can"
        )
    if name == "sim":
        raise SceneError(f"{key}.name", "= 'sim' names the simulator's own topics")


def _check_lens(camera: CameraConfig, key: str) -> None:
    k = camera.intrinsics
    x, y = np.meshgrid(np.linspace(0, camera.width, 41), np.linspace(0, camera.height, 41))
    seen = np.column_stack([(x.ravel() - k[0, 2]) / k[0, 0], (y.ravel() - k[1, 2]) / k[1, 1]])
    try:
        undistorted(seen, camera.distortion)
    except FoldedPictureError as error:
        raise SceneError(
            key,
            f"= {list(camera.distortion)} folds the picture, or shrinks its rim to less than a "
            "quarter or enlarges it more than thrice; take smaller coefficients, or a smaller "
            "vertical_fov",
        ) from error
