# SPDX-License-Identifier: Apache-2.0
"""The features g and h of equations 3.3 and 3.4 for one configuration, symbolic in CasADi.

Two vector functions of a configuration q (n,), each with its Jacobian and the Hessian of its
product with multipliers, all evaluated over many steps at once with ``Function.map``:

* ``path(q, mode)``: lean of the hand (2 rows), then clearances of bodies to stacks and table;
* ``switch(q, reference)``: deviation of the tool centre point from a vertical line and of the
  fingers from a direction, and the point's height.

Clearance: the hand, with what hangs from it, is a box. It is apart from the upright box of a stack
if the two are apart along one of the world's axes or along the hand's own axis across the fingers
(the separating-axis test, restricted to the axes that matter). The links behind the hand are
spheres, apart from a stack if they are above it or beside the upright cylinder around it. Both are
on the safe side. The largest of the k gaps d_i is smoothed from below by

    (1/s) log(sum_i exp(s d_i)) - log(k)/s  <=  max_i d_i,

whose gradient never vanishes, so a solver finds the way out of any overlap. The smallest gap of a
body's spheres is smoothed from below likewise.
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
from .robots import Arm

Array = NDArray[np.float64]

#: Sharpness s of the smooth maximum [1/m].
SHARPNESS: Final = 150.0
#: Of the smooth minimum over the spheres of a body [1/m].
SHARPNESS_OF_BODIES: Final = 400.0
#: What the safe side costs at most, where one of four gaps dominates: log(4)/s [m].
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


def _smooth_max(values: list[ca.SX]) -> ca.SX:
    """From below; see the module."""
    return (ca.logsumexp(SHARPNESS * ca.vertcat(*values)) - np.log(len(values))) / SHARPNESS


def _smooth_min(values: list[ca.SX]) -> ca.SX:
    """From below."""
    return -ca.logsumexp(-SHARPNESS_OF_BODIES * ca.vertcat(*values)) / SHARPNESS_OF_BODIES


class _Hand:
    """The box of the hand and what hangs from it, in the world.

    Args:
        rotation, position: pose of the hand's frame.
        top, bottom: z of the box's ends in that frame [m].
        half: half extents along the frame's x and y axes [m].
    """

    def __init__(
        self, rotation: ca.SX, position: ca.SX, top: float, bottom: ca.SX, half: list[ca.SX]
    ) -> None:
        self._rotation = rotation
        self._half = ca.vertcat(*half, (bottom - top) / 2)
        self._center = position + rotation[:, 2] * (top + bottom) / 2

    def _extent(self, axis: int) -> ca.SX:
        """Half extent along a world axis [m]: the support function sum_j |R_ij| half_j."""
        return ca.dot(_smooth_abs(self._rotation[axis, :].T), self._half)

    def gap(self, column: ca.SX, floor: ca.SX) -> ca.SX:
        """To a column (center x, y, half x, y, top) [m]."""
        middle = ca.vertcat(column[0], column[1], (column[4] + floor) / 2)
        halves = ca.vertcat(column[2], column[3], (column[4] - floor) / 2)
        delta = self._center - middle
        across = self._rotation[:, 0]
        reach = ca.dot(_smooth_abs(across), halves) + self._half[0]
        return _smooth_max(
            [
                delta[2] - halves[2] - self._extent(2),
                _smooth_abs(ca.dot(across, delta)) - reach,
                _smooth_abs(delta[0]) - halves[0] - self._extent(0),
                _smooth_abs(delta[1]) - halves[1] - self._extent(1),
            ]
        )

    def height(self) -> ca.SX:
        """Of its lowest point [m]."""
        return self._center[2] - self._extent(2)


def _sphere_gap(center: ca.SX, radius: float, column: ca.SX) -> ca.SX:
    """Of a sphere to a column (center x, y, half x, y, top) [m]."""
    delta = center[:2] - column[:2]
    beside = ca.sqrt(ca.dot(delta, delta) + 1e-6) - ca.sqrt(ca.dot(column[2:4], column[2:4]) + 1e-9)
    return _smooth_max([center[2] - column[4] - radius, beside - radius])


class Features:
    """The features for one arm and a number of stacks.

    Args:
        stacks: m, the number of stacks.
    """

    def __init__(self, kinematics: Kinematics, robot: Arm, stacks: int) -> None:
        self.robot = robot
        self.stacks = stacks
        self.dimension = len(robot.arm_joints)
        self._q = ca.SX.sym("q", self.dimension)
        links = {robot.gripper.hand_link, *(body.link for body in robot.bodies)}
        self._poses = kinematics.world_from_links(self._q, sorted(links))

    @property
    def mode_size(self) -> int:
        """Length of the parameters of ``path``: columns (5 each), hand (3), floor, margin."""
        return 5 * self.stacks + 5

    def mode(self, columns: tuple[Column, ...], tool: Tool, floor: float, margin: float) -> Array:
        """Parameters of ``path``, shape (mode_size,): the mode s_k of 5.1 [m]."""
        boxes = [(*column.center, *column.half, column.top) for column in columns]
        half_x = max(tool.half_x, self.robot.gripper.hand_half[0])
        half_y = max(tool.half_y, self.robot.gripper.hand_half[1])
        return np.array([*np.ravel(boxes), half_x, half_y, tool.bottom, floor, margin])

    @cached_property
    def path(self) -> Feature:
        """Rows: lean of the hand along x and y, then each body's clearance less the margin [m]."""
        robot = self.robot
        parameters = ca.SX.sym("mode", self.mode_size)
        columns = ca.reshape(parameters[: 5 * self.stacks], 5, self.stacks)
        half_x, half_y, bottom, floor, margin = ca.vertsplit(parameters[5 * self.stacks :])
        hand = _Hand(
            *self._poses[robot.gripper.hand_link], robot.gripper.hand_top, bottom, [half_x, half_y]
        )
        spheres: dict[str, list[tuple[ca.SX, float]]] = {}
        for body in robot.bodies:
            rotation, position = self._poses[body.link]
            center = position + rotation @ ca.DM(body.center)
            spheres.setdefault(body.name, []).append((center, body.radius))
        rotation, _ = self._poses[robot.gripper.hand_link]
        rows = [rotation[0, 2], rotation[1, 2]]
        for column in ca.horzsplit(columns, 1):
            rows.append(hand.gap(column, floor) - margin)
            for parts in spheres.values():
                gaps = [_sphere_gap(*sphere, column) for sphere in parts]
                rows.append(_smooth_min(gaps) - margin)
        rows.append(hand.height() - floor - margin)
        return _feature("path", self._q, parameters, ca.vertcat(*rows))

    def path_names(self, tool: Tool) -> list[str]:
        """The rows of ``path`` in words."""
        hand = f"hand with {tool.held}" if tool.held else "hand"
        bodies = [hand, *self._body_names]
        names = ["tilt of the hand"] * LEAN_ROWS
        for index in range(self.stacks):
            names += [f"clearance of {body} to {base_name(index)}" for body in bodies]
        return [*names, f"clearance of {hand} to the table"]

    @cached_property
    def switch(self) -> Feature:
        """Rows: x and y of the tool centre point less the reference's [m], sine of the angle of
        the fingers' direction to the reference's, height of the point [m].

        The reference is (x, y, yaw).
        """
        reference = ca.SX.sym("reference", REFERENCE_SIZE)
        rotation, position = self._poses[self.robot.gripper.hand_link]
        point = position + rotation[:, 2] * self.robot.gripper.tcp_offset
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
        """Row of ``path`` that holds the clearance of the hand to the table."""
        return LEAN_ROWS + self.stacks * (1 + len(self._body_names))

    @property
    def _body_names(self) -> list[str]:
        """Of the links behind the hand, each once."""
        return list(dict.fromkeys(body.name for body in self.robot.bodies))

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
        """q -> residual (7,) and its Jacobian (7, n), for :mod:`inverse_kinematics`.

        Rows: tool centre point, lean of the hand along x and y, fingers' direction along x and y.
        """
        rotation, position = self._poses[self.robot.gripper.hand_link]
        point = position + rotation[:, 2] * self.robot.gripper.tcp_offset
        residual = ca.vertcat(point, rotation[0, 2], rotation[1, 2], rotation[0, 1], rotation[1, 1])
        jacobian = ca.densify(ca.jacobian(residual, self._q))
        return ca.Function("pose", [self._q], [ca.densify(residual), jacobian], {"cse": True})
