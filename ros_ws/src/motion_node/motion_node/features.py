# SPDX-License-Identifier: Apache-2.0
"""The features g and h of equations 3.3 and 3.4 for one configuration, symbolic in CasADi.

Two vector functions of a configuration q (n,), each with its Jacobian and the Hessian of its
product with multipliers, all evaluated over many steps at once with ``Function.map``:

* ``path(q, mode)``: lean of the hand (2 rows), then clearances of bodies to stacks and table;
* ``switch(q, reference)``: deviation of the tool centre point from a vertical line and of the
  fingers from a direction, and the point's height.

Clearance: a body's box and a stack's upright box are apart if they are apart along one of the world
axes, or along the body's own axis across the arm (the separating-axis test, restricted to four
axes, hence on the safe side). The largest of the four gaps d_i is smoothed from below by

    (1/s) log(sum_i exp(s d_i)) - log(4)/s  <=  max_i d_i,

whose gradient never vanishes, so a solver finds the way out of any overlap.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from scene_graph import base_name

from .kinematics import Kinematics
from .phases import Column, Switch, Tool
from .robot import RobotGeometry

Array = NDArray[np.float64]

#: Sharpness s of the smooth maximum [1/m].
SHARPNESS: Final = 150.0
#: What the safe side of the smooth maximum costs where one gap dominates, log(4)/s [m].
SMOOTHING: Final = float(np.log(4.0)) / SHARPNESS
LEAN_ROWS: Final = 2
SWITCH_ROWS: Final = 4
REFERENCE_SIZE: Final = 3


@dataclass(frozen=True)
class Feature:
    """A vector function of a configuration with its derivatives.

    Attributes:
        value: (q, parameters) -> (rows,).
        jacobian: (q, parameters) -> (rows, n), dense.
        curvature: (q, parameters, multipliers) -> (n, n) Hessian of multipliers . value.
        rows: number of rows.
    """

    value: ca.Function
    jacobian: ca.Function
    curvature: ca.Function
    rows: int


def _feature(name: str, q: ca.SX, parameters: ca.SX, rows: ca.SX) -> Feature:
    multipliers = ca.SX.sym("multipliers", rows.numel())
    hessian, _ = ca.hessian(ca.dot(multipliers, rows), q)
    options = {"cse": True}
    return Feature(
        ca.Function(name, [q, parameters], [rows], options),
        ca.Function(f"{name}_jac", [q, parameters], [ca.densify(ca.jacobian(rows, q))], options),
        ca.Function(f"{name}_hess", [q, parameters, multipliers], [ca.densify(hessian)], options),
        rows.numel(),
    )


def _smooth_abs(value: ca.SX) -> ca.SX:
    return ca.sqrt(value * value + 1e-6)


@dataclass(frozen=True)
class _PosedBox:
    """A body's box in the world.

    Attributes:
        center: in the world, 3 values [m].
        extent: half extents along the world axes, 3 values [m].
        across: unit vector of the box's axis across the arm, 3 values.
        half_across: half extent along it [m].
    """

    center: list[ca.SX]
    extent: list[ca.SX]
    across: list[ca.SX]
    half_across: ca.SX

    @staticmethod
    def of(
        rotation: ca.SX, position: ca.SX, center: ca.SX, half: list[ca.SX], across: int
    ) -> _PosedBox:
        moved = position + rotation @ center
        # Support function of a box along a world axis: sum_j |R_ij| half_j.
        extent = [
            ca.sum1(ca.vertcat(*[_smooth_abs(rotation[i, j]) * half[j] for j in range(3)]))
            for i in range(3)
        ]
        axis = [rotation[i, across] for i in range(3)]
        return _PosedBox([moved[i] for i in range(3)], extent, axis, half[across])

    def gap_to_column(self, column: ca.SX, floor: ca.SX) -> ca.SX:
        """Smooth gap [m] to a column (center x, y, half x, y, top), on the safe side."""
        middle, half = (column[4] + floor) / 2, (column[4] - floor) / 2
        delta = [self.center[0] - column[0], self.center[1] - column[1], self.center[2] - middle]
        halves = [column[2], column[3], half]
        along = sum(axis * distance for axis, distance in zip(self.across, delta))
        reach = sum(_smooth_abs(axis) * value for axis, value in zip(self.across, halves))
        gaps = ca.vertcat(
            _smooth_abs(delta[0]) - column[2] - self.extent[0],
            _smooth_abs(delta[1]) - column[3] - self.extent[1],
            self.center[2] - column[4] - self.extent[2],
            _smooth_abs(along) - reach - self.half_across,
        )
        return ca.logsumexp(SHARPNESS * gaps) / SHARPNESS - SMOOTHING

    def gap_to_floor(self, floor: ca.SX) -> ca.SX:
        return self.center[2] - self.extent[2] - floor


class Features:
    """The features for one arm and a number of stacks.

    Args:
        stacks: m, the number of stacks.
    """

    def __init__(self, kinematics: Kinematics, robot: RobotGeometry, stacks: int) -> None:
        self.robot = robot
        self.stacks = stacks
        self.dimension = len(robot.arm_joints)
        self._q = ca.SX.sym("q", self.dimension)
        links = {robot.hand_link, *(body.link for body in robot.bodies)}
        self._poses = kinematics.world_from_links(self._q, sorted(links))

    @property
    def mode_size(self) -> int:
        """Length of the parameters of ``path``: columns (5 each), tool (3), floor, margin."""
        return 5 * self.stacks + 5

    def mode(self, columns: tuple[Column, ...], tool: Tool, floor: float, margin: float) -> Array:
        """Parameters of ``path``, shape (mode_size,): the mode s_k of 5.1 [m]."""
        boxes = [(*column.center, *column.half, column.top) for column in columns]
        return np.array([*np.ravel(boxes), tool.half_x, tool.half_y, tool.bottom, floor, margin])

    @cached_property
    def path(self) -> Feature:
        """Rows: lean of the hand along x and y, then each body's clearance less the margin [m]."""
        robot = self.robot
        parameters = ca.SX.sym("mode", self.mode_size)
        columns = ca.reshape(parameters[: 5 * self.stacks], 5, self.stacks)
        half_x, half_y, bottom, floor, margin = ca.vertsplit(parameters[5 * self.stacks :])
        rotation, position = self._poses[robot.hand_link]
        tool_center = ca.vertcat(0, 0, (robot.palm + bottom) / 2)
        tool = [half_x, half_y, (bottom - robot.palm) / 2]
        boxes = [_PosedBox.of(rotation, position, tool_center, tool, 0)]
        for body in robot.bodies:
            pose = self._poses[body.link]
            half = [ca.SX(value) for value in body.half]
            boxes.append(_PosedBox.of(*pose, ca.SX(ca.DM(body.center)), half, body.across))
        rows = [rotation[0, 2], rotation[1, 2]]
        rows += [
            box.gap_to_column(columns[:, index], floor) - margin
            for index in range(self.stacks)
            for box in boxes
        ]
        rows += [box.gap_to_floor(floor) - margin for box in boxes[:3]]
        return _feature("path", self._q, parameters, ca.vertcat(*rows))

    def path_names(self, tool: Tool) -> list[str]:
        """The rows of ``path`` in words."""
        below = tool.held or "fingers"
        bodies = [below, *(body.name for body in self.robot.bodies)]
        names = ["tilt of the hand"] * LEAN_ROWS
        for index in range(self.stacks):
            names += [f"clearance of {body} to {base_name(index)}" for body in bodies]
        return names + [f"clearance of {body} to the table" for body in bodies[:3]]

    @cached_property
    def switch(self) -> Feature:
        """Rows: x and y of the tool centre point less the reference's [m], sine of the angle of
        the fingers' direction to the reference's, height of the point [m].

        The reference is (x, y, yaw).
        """
        reference = ca.SX.sym("reference", REFERENCE_SIZE)
        rotation, position = self._poses[self.robot.hand_link]
        point = position + rotation[:, 2] * self.robot.tcp_offset
        cos, sin = ca.cos(reference[2]), ca.sin(reference[2])
        rows = ca.vertcat(
            point[0] - reference[0],
            point[1] - reference[1],
            rotation[1, 1] * cos - rotation[0, 1] * sin,
            point[2],
        )
        return _feature("switch", self._q, reference, rows)

    @property
    def tool_floor_row(self) -> int:
        """Row of ``path`` that holds the clearance of the tool to the table."""
        return LEAN_ROWS + self.stacks * (1 + len(self.robot.bodies))

    def switch_names(self, switch: Switch) -> list[str]:
        """The rows of ``switch`` in words."""
        place = base_name(switch.stack)
        x, y, z = switch.position_world
        reach = f"reach of the hand to ({x:.2f}, {y:.2f}, {z:.2f}) at {place}"
        return [reach, reach, f"direction of the fingers at {place}", reach]

    def hand_pose(self, q: Array) -> tuple[Array, float]:
        """Tool centre point (3,) [m] and direction of the fingers about world z [rad]."""
        residual = np.array(self.pose(q)[0]).ravel()
        return residual[:3], float(np.arctan2(residual[6], residual[5]))

    @cached_property
    def pose(self) -> ca.Function:
        """q -> residual (7,) and its Jacobian (7, n), for :mod:`inverse_kinematics`: tool centre point, lean of the hand along x and y, and the fingers' direction along x and y."""
        rotation, position = self._poses[self.robot.hand_link]
        point = position + rotation[:, 2] * self.robot.tcp_offset
        residual = ca.vertcat(point, rotation[0, 2], rotation[1, 2], rotation[0, 1], rotation[1, 1])
        jacobian = ca.densify(ca.jacobian(residual, self._q))
        return ca.Function("pose", [self._q], [ca.densify(residual), jacobian], {"cse": True})
