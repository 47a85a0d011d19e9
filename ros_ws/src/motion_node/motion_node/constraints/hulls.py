# SPDX-License-Identifier: Apache-2.0
"""How far hulls of the arm are from a stack, symbolic; a new hull is a function or class here.

The hand, with what hangs from it, is a box. It is apart from the upright box of a stack if the two
are apart along one of the world's axes or along the hand's own axis across the fingers (the
separating-axis test, restricted to the axes that matter). The links behind the hand are spheres,
apart from a stack if they are above it or beside the upright cylinder around it. Both are on the
safe side.

A column is (center x, y, half x, y, top) [m], shape (5, 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..blocks import Column
from ..phases import Tool
from ..robots import Gripper
from ..robots.model import ArmModel
from .smooth import smooth_abs, smooth_max

Array = NDArray[np.float64]

COLUMN_SIZE: Final = 5
HAND_SIZE: Final = 3


def column_parameters(columns: Sequence[Column]) -> Array:
    """Columns one after another, shape (COLUMN_SIZE * len(columns),) [m]."""
    return np.array([n for c in columns for n in (*c.center, *c.half, c.top)])


def split_columns(parameters: ca.SX) -> list[ca.SX]:
    """The columns whose parameters these are, each of shape (COLUMN_SIZE, 1)."""
    return list(ca.horzsplit(ca.reshape(parameters, COLUMN_SIZE, -1), 1))


def hand_parameters(gripper: Gripper, tool: Tool) -> Array:
    """Of :class:`HandBox`: half extents along the hand's x and y, lower end, shape (3,) [m]."""
    half_x, half_y = gripper.hand_half
    return np.array([max(tool.half_x, half_x), max(tool.half_y, half_y), tool.bottom])


class HandBox:
    """The box of the hand and what hangs from it, in the world.

    Args:
        parameters: see :func:`hand_parameters`, shape (HAND_SIZE, 1).
    """

    def __init__(self, model: ArmModel, parameters: ca.SX) -> None:
        top, bottom = model.arm.gripper.hand_top, parameters[2]
        self._rotation, position = model.hand_pose
        self._half = ca.vertcat(parameters[:2], (bottom - top) / 2)
        self._center = position + self._rotation[:, 2] * (top + bottom) / 2

    def _extent(self, axis: int) -> ca.SX:
        """Half extent along a world axis [m]: the support function sum_j |R_ij| half_j."""
        return ca.dot(smooth_abs(self._rotation[axis, :].T), self._half)

    def gap(self, column: ca.SX, floor: ca.SX) -> ca.SX:
        """To a column that stands on a floor [m]."""
        middle = ca.vertcat(column[0], column[1], (column[4] + floor) / 2)
        halves = ca.vertcat(column[2], column[3], (column[4] - floor) / 2)
        delta = self._center - middle
        across = self._rotation[:, 0]
        reach = ca.dot(smooth_abs(across), halves) + self._half[0]
        return smooth_max(
            [
                delta[2] - halves[2] - self._extent(2),
                smooth_abs(ca.dot(across, delta)) - reach,
                smooth_abs(delta[0]) - halves[0] - self._extent(0),
                smooth_abs(delta[1]) - halves[1] - self._extent(1),
            ]
        )

    def height(self) -> ca.SX:
        """Of its lowest point [m]."""
        return self._center[2] - self._extent(2)


def sphere_gap(center: ca.SX, radius: float, column: ca.SX) -> ca.SX:
    """Of a sphere to a column [m]."""
    delta = center[:2] - column[:2]
    beside = ca.sqrt(ca.dot(delta, delta) + 1e-6) - ca.sqrt(ca.dot(column[2:4], column[2:4]) + 1e-9)
    return smooth_max([center[2] - column[4] - radius, beside - radius])
