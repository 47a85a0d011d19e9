# SPDX-License-Identifier: Apache-2.0
"""An arm with its URDF: where its links are, symbolic in CasADi, and where its hand is."""

from __future__ import annotations

from functools import cached_property
from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .arm import Arm
from .kinematics import Kinematics

Array = NDArray[np.float64]

#: Rows of :attr:`ArmModel.hand`: position, lean and direction of the fingers.
POSITION_ROWS: Final = 3
HAND_ROWS: Final = POSITION_ROWS + 2 + 2
#: Of a pose in space: more joints than this can move without moving the hand.
FREEDOMS_OF_A_POSE: Final = 6


class ArmModel:
    """The symbols that all rows of all constraints share, and the kinematics on top of them.

    Args:
        description: the URDF's text.
        limit_margin: distance kept to the joints' position limits [rad].

    Attributes:
        q: symbols of a configuration, shape (n, 1).
        lower, upper: joint limits that are kept, shape (n,) [rad].
        home: configuration at rest, shape (n,) [rad].

    Raises:
        RobotDescriptionError: if the description lacks a joint or link of ``arm``.
    """

    def __init__(self, description: str, arm: Arm, limit_margin: float = 0.0) -> None:
        self.arm = arm
        self.kinematics = Kinematics(description, arm.arm_joints)
        self.kinematics.check_links(
            [arm.gripper.hand_link, *(body.link for body in arm.bodies)],
        )
        self.lower = self.kinematics.lower + limit_margin
        self.upper = self.kinematics.upper - limit_margin
        self.home = np.array(arm.home)
        self.q = ca.SX.sym("q", self.dimension)
        self._link_poses = self.kinematics.link_poses(self.q)

    @property
    def dimension(self) -> int:
        """n, the number of joints."""
        return len(self.arm.arm_joints)

    def link_pose(self, link: str) -> tuple[ca.SX, ca.SX]:
        """Rotation (3, 3) and position (3, 1) of a link in the world.

        Raises:
            RobotDescriptionError: if the link does not exist.
        """
        return self._link_poses(link)

    @property
    def hand_pose(self) -> tuple[ca.SX, ca.SX]:
        """Rotation (3, 3) and position (3, 1) of the hand's frame in the world."""
        return self.link_pose(self.arm.gripper.hand_link)

    @property
    def tool_center(self) -> ca.SX:
        """Tool centre point in the world, shape (3, 1) [m]."""
        rotation, position = self.hand_pose
        return position + rotation[:, 2] * self.arm.gripper.tcp_offset

    @cached_property
    def hand(self) -> ca.Function:
        """q -> (rows (HAND_ROWS,), Jacobian (HAND_ROWS, n)).

        Rows: tool centre point, lean of the hand along x and y, fingers' direction along x and y.
        """
        rotation, _ = self.hand_pose
        rows = ca.vertcat(
            self.tool_center, rotation[0, 2], rotation[1, 2], rotation[0, 1], rotation[1, 1]
        )
        jacobian = ca.densify(ca.jacobian(rows, self.q))
        return ca.Function("hand", [self.q], [ca.densify(rows), jacobian], {"cse": True})

    def hand_at(self, q: Array) -> tuple[Array, float]:
        """Tool centre point (3,) [m] and direction of the fingers about world z [rad]."""
        rows = np.array(self.hand(q)[0]).ravel()
        return rows[:POSITION_ROWS], float(np.arctan2(rows[-1], rows[-2]))

    def tool_at(self, q: Array) -> Array:
        """Tool centre point (3,) [m], without CasADi, so that any thread may ask."""
        pose = self.kinematics.pose_at(self.arm.gripper.hand_link, q)
        return np.asarray(pose[:3, 3] + pose[:3, 2] * self.arm.gripper.tcp_offset)
