# SPDX-License-Identifier: Apache-2.0
"""Where messages meet the types of motion_node."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from tamp_interfaces.msg import SymbolicPlan
from tamp_runtime.messages.scene_graph import graph_from_message, moves_from_messages
from tamp_runtime.messages.stamps import duration_from_seconds, stamp_from_nanoseconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from .errors import InvalidPlanError, JointStateError
from .execution.plan import Plan
from .robots import Arm
from .robots.joints import JointValues
from .timing.trajectory import Trajectory

Array = NDArray[np.float64]


def plan_from_message(message: SymbolicPlan) -> Plan:
    """Raises InvalidPlanError if the scene's names repeat or a predicate is unknown."""
    try:
        graph = graph_from_message(message.initial)
    except ValueError as error:
        raise InvalidPlanError(f"the plan's scene cannot be read: {error}") from error
    return Plan(
        plan_id=message.plan_id,
        graph=graph,
        moves=moves_from_messages(message.moves),
        object_names=tuple(move.object_name for move in message.moves),
        frame=message.initial.header.frame_id or message.header.frame_id,
    )


def trajectory_to_message(trajectory: Trajectory, arm: Arm) -> JointTrajectory:
    """Names all joints; the stamp stays zero, which asks the controller to start at once."""
    positions, velocities = trajectory.positions.joined(), trajectory.velocities.joined()
    return _message(arm.joint_names, trajectory.times, positions, velocities)


def trajectory_to_two_messages(
    trajectory: Trajectory, arm: Arm, begins: float | None
) -> tuple[JointTrajectory, JointTrajectory]:
    """One that names the arm's joints, and one that names the fingers', with the same stamp.

    Args:
        begins: when it starts, by the clock of the controllers [s]; None: at once.
    """
    times, positions, velocities = trajectory.times, trajectory.positions, trajectory.velocities
    messages = (
        _message(arm.arm_joints, times, positions.arm, velocities.arm),
        _message(arm.gripper.finger_joints, times, positions.fingers, velocities.fingers),
    )
    if begins is not None:
        for message in messages:
            message.header.stamp = stamp_from_nanoseconds(round(begins * 1e9))
    return messages


def _message(
    names: Sequence[str], times: Array, positions: Array, velocities: Array
) -> JointTrajectory:
    message = JointTrajectory(joint_names=list(names))
    message.points = [
        JointTrajectoryPoint(
            positions=position,
            velocities=velocity,
            time_from_start=duration_from_seconds(time),
        )
        for time, position, velocity in zip(times.tolist(), positions.tolist(), velocities.tolist())
    ]
    return message


def joint_positions(message: JointState, arm: Arm) -> JointValues:
    """Positions of all joints of an arm [rad, m].

    Raises:
        JointStateError: if one is missing or not finite; the sentence names it.
    """
    names, values = len(message.name), len(message.position)
    if values != names:
        raise JointStateError(f"joint_states arrive with {names} names and {values} positions")
    found = dict(zip(message.name, message.position))
    if missing := [name for name in arm.joint_names if name not in found]:
        raise JointStateError(f"joint_states arrive without {', '.join(missing)}")
    positions = np.array([found[name] for name in arm.joint_names])
    if not np.isfinite(positions).all():
        bad = [name for name, fine in zip(arm.joint_names, np.isfinite(positions)) if not fine]
        raise JointStateError(f"joint_states arrive without finite positions of {', '.join(bad)}")
    return JointValues(*np.split(positions, [len(arm.arm_joints)]))
