# SPDX-License-Identifier: Apache-2.0
"""How far hulls of the arm are from an obstacle, symbolic: separating axes that matter.

The hand is two boxes, the palm with the flange, and what hangs below it: fingers and a held block.
The links behind it are spheres. An obstacle is an upright box, or a cylinder in it; of a cylinder
the diagonals are axes too, so that it counts as the octagon around it for the hand.

An obstacle is (center x, y, z, half x, y, z, cos yaw, sin yaw, radius) [m], shape (9, 1): radius
is half its diagonal from above, or a cylinder's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..obstacles import Obstacle
from ..robots.model import ArmModel
from .smooth import smooth_abs

Array = NDArray[np.float64]

OBSTACLE_SIZE: Final = 9
#: Of the smooth maximum over axes [1/m]: sharper than that of stacks, since places are narrow.
SHARPNESS: Final = 500.0
#: Within this of an edge distances are rounded, downwards [m].
_ROUNDED: Final = 1e-3
#: Far below everything: stands where there is none.
_NOWHERE: Final = (0.0, 0.0, -9.0, 0.01, 0.01, 0.01, 1.0, 0.0, 0.02)


def obstacle_parameters(obstacles: Sequence[Obstacle], count: int) -> Array:
    """``count`` obstacles one after another, those that are missing far away, shape (9 count,)."""
    numbers = []
    for item in obstacles:
        half = np.array(item.size) / 2
        radius = half[0] if item.round else np.hypot(half[0], half[1])
        turn = (np.cos(item.yaw), np.sin(item.yaw))
        numbers.append([*item.position_world, *half, *turn, radius])
    numbers += [list(_NOWHERE)] * (count - len(obstacles))
    return np.array(numbers, dtype=float).ravel()


def split_obstacles(parameters: ca.SX) -> list[ca.SX]:
    """The obstacles whose parameters these are, each of shape (OBSTACLE_SIZE, 1)."""
    return list(ca.horzsplit(ca.reshape(parameters, OBSTACLE_SIZE, -1), 1))


class ObstacleHull:
    """An obstacle and its axes."""

    def __init__(self, parameters: ca.SX) -> None:
        self.center, self.half = parameters[:3], parameters[3:6]
        cos, sin, self.radius = parameters[6], parameters[7], parameters[8]
        self.first, self.second = ca.vertcat(cos, sin, 0), ca.vertcat(-sin, cos, 0)
        diagonal = ca.fmin((self.half[0] + self.half[1]) / np.sqrt(2.0), self.radius)
        self.axes = [
            (ca.SX(ca.DM([0.0, 0.0, 1.0])), self.half[2]),
            (self.first, self.half[0]),
            (self.second, self.half[1]),
            ((self.first + self.second) / np.sqrt(2.0), diagonal),
            ((self.first - self.second) / np.sqrt(2.0), diagonal),
        ]

    def reach(self, axis: ca.SX) -> ca.SX:
        """Half extent along any unit vector [m]."""
        box = smooth_abs(ca.dot(axis, self.first)) * self.half[0]
        box += smooth_abs(ca.dot(axis, self.second)) * self.half[1]
        level = ca.sqrt(axis[0] ** 2 + axis[1] ** 2 + 1e-6)
        return ca.fmin(box, level * self.radius) + smooth_abs(axis[2]) * self.half[2]


class HandPart:
    """A box in the hand's frame, in the world.

    Args:
        half: half extents along the hand's x and y axes [m].
        upper, lower: where it begins and ends along the hand's z axis [m].
    """

    def __init__(
        self, model: ArmModel, half: Sequence[ca.SX | float], upper: ca.SX, lower: ca.SX
    ) -> None:
        self._rotation, position = model.hand_pose
        self._half = ca.vertcat(half[0], half[1], (lower - upper) / 2)
        self._center = position + self._rotation[:, 2] * (upper + lower) / 2

    def gap(self, obstacle: ObstacleHull) -> ca.SX:
        """To an obstacle [m]."""
        delta = self._center - obstacle.center
        gaps = []
        for axis, reach in obstacle.axes:
            extent = ca.dot(smooth_abs(self._rotation.T @ axis), self._half)
            gaps.append(smooth_abs(ca.dot(axis, delta)) - reach - extent)
        for column in (0, 1):
            axis = self._rotation[:, column]
            gaps.append(smooth_abs(ca.dot(axis, delta)) - obstacle.reach(axis) - self._half[column])
        return _largest(gaps)


def sphere_gap(center: ca.SX, radius: float, obstacle: ObstacleHull) -> ca.SX:
    """Of a sphere to an obstacle [m]: past an edge the distance, not only that along an axis."""
    delta = center - obstacle.center
    beside = [
        smooth_abs(ca.dot(axis, delta)) - obstacle.half[index]
        for index, axis in enumerate((obstacle.first, obstacle.second))
    ]
    above = smooth_abs(delta[2]) - obstacle.half[2]
    around = ca.sqrt(ca.sumsqr(delta[:2]) + _ROUNDED**2) - _ROUNDED - obstacle.radius
    # The box is in the circle around it, or the cylinder in its box: the greater one is true.
    level = ca.fmax(sum(ca.fmax(side, 0.0) ** 2 for side in beside), ca.fmax(around, 0.0) ** 2)
    outside = ca.sqrt(level + ca.fmax(above, 0.0) ** 2 + _ROUNDED**2) - _ROUNDED
    inside = ca.fmin(_largest([*beside, above, around]), 0.0)
    return outside + inside - radius


def _largest(gaps: Sequence[ca.SX]) -> ca.SX:
    """From below, as :func:`smooth_max`, but sharper."""
    return (ca.logsumexp(SHARPNESS * ca.vertcat(*gaps)) - np.log(len(gaps))) / SHARPNESS
