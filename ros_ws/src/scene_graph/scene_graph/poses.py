# SPDX-License-Identifier: Apache-2.0
"""Poses of blocks that stand upright, and the turns they are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Quaternion = tuple[float, float, float, float]


def quaternion_from_yaw(yaw: float) -> Quaternion:
    """(x, y, z, w) of a turn about z [rad]."""
    return 0.0, 0.0, float(np.sin(0.5 * yaw)), float(np.cos(0.5 * yaw))


def rotation_from_quaternion(quaternion: Quaternion) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) of a quaternion (x, y, z, w) of any positive norm."""
    x, y, z, w = np.array(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def wrap_line(angle: float) -> float:
    """The angle of an undirected line, in (-pi/2, pi/2] [rad]."""
    return float(np.pi / 2 - np.mod(np.pi / 2 - angle, np.pi))


@dataclass(frozen=True)
class BlockPose:
    """Where a block stands upright, and how large it is.

    Attributes:
        position_world: centre (x, y, z) [m].
        yaw: direction of its first horizontal axis, counter-clockwise from world x [rad].
        size: full extents along its first and second horizontal axis and vertically [m].
    """

    position_world: tuple[float, float, float]
    yaw: float
    size: tuple[float, float, float]

    @property
    def quaternion_world(self) -> Quaternion:
        """(x, y, z, w) of the turn by ``yaw`` about z."""
        return quaternion_from_yaw(self.yaw)

    @property
    def bottom(self) -> float:
        """Height of the lower face [m]."""
        return self.position_world[2] - 0.5 * self.size[2]

    @property
    def top(self) -> float:
        """Height of the upper face [m]."""
        return self.position_world[2] + 0.5 * self.size[2]

    @property
    def half_world(self) -> tuple[float, float]:
        """Half extents along world x and y of the box that encloses it [m]."""
        c, s = abs(np.cos(self.yaw)), abs(np.sin(self.yaw))
        a, b = 0.5 * self.size[0], 0.5 * self.size[1]
        return float(c * a + s * b), float(s * a + c * b)
