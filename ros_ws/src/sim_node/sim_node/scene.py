# SPDX-License-Identifier: Apache-2.0
"""What stands where: table, places, blocks, camera. The frame ``world`` is the robot's base."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scene_graph import ROW_OF_THREE
from scene_graph.places import Point


@dataclass(frozen=True)
class CameraConfig:
    """A pinhole camera that looks at the places from the front, opposite to the robot.

    Attributes:
        width, height: image size [px].
        position_world, target_world: where it is and what it looks at [m].
        vertical_fov: full opening angle [rad].
        near, far: clipping distances [m].
    """

    width: int = 256
    height: int = 256
    position_world: tuple[float, float, float] = (1.45, 0.0, 0.40)
    target_world: tuple[float, float, float] = (0.50, 0.0, 0.155)
    vertical_fov: float = 0.52
    near: float = 0.1
    far: float = 3.0

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


@dataclass(frozen=True)
class SceneConfig:
    """The table of 5.3.1: m = 3 stacks in a row, blocks of one size.

    Attributes:
        stack_positions: centres of the places on the table, from the left of the image [m].
        block_size: edge of a box; diameter and height of a cylinder; diameter of a sphere [m].
        block_mass: [kg].
        position_jitter, yaw_jitter: blocks are put down up to this far from the ideal [m, rad].
    """

    stack_positions: tuple[Point, ...] = ROW_OF_THREE
    block_size: float = 0.045
    block_mass: float = 0.08
    position_jitter: float = 0.002
    yaw_jitter: float = 0.05
    camera: CameraConfig = field(default_factory=CameraConfig)

    @property
    def stack_count(self) -> int:
        """m."""
        return len(self.stack_positions)
