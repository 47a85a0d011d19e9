# SPDX-License-Identifier: Apache-2.0
"""Where messages meet the types of motion_node."""

from __future__ import annotations

import numpy as np
from builtin_interfaces.msg import Duration, Time
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.conversions import graph_from_message, moves_from_messages
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from .errors import InvalidPlanError
from .executive import Plan
from .report import Report
from .trajectory import Trajectory

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
    )


def report_to_message(report: Report, stamp: Time) -> MotionStatus:
    return MotionStatus(
        header=Header(stamp=stamp),
        plan_id=report.plan_id,
        state=int(report.state),
        reason=int(report.reason),
        message=report.message,
        bound=report.bound,
        object_name=report.object_name,
        constraint=report.constraint,
        move=report.move,
        moves_done=report.moves_done,
        moves_total=report.moves_total,
        phase=report.phase,
        progress=float(min(max(report.progress, 0.0), 1.0)),
        optimisation_seconds=float(report.optimisation_seconds),
        duration=float(report.duration),
    )


def trajectory_to_message(trajectory: Trajectory) -> JointTrajectory:
    """The stamp stays zero, which asks the controller to start at once."""
    message = JointTrajectory(joint_names=list(trajectory.joint_names))
    points = []
    for time, positions, velocities in zip(
        trajectory.times.tolist(), trajectory.positions.tolist(), trajectory.velocities.tolist()
    ):
        nanoseconds = round(time * 1e9)
        points.append(
            JointTrajectoryPoint(
                positions=positions,
                velocities=velocities,
                time_from_start=Duration(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9),
            )
        )
    message.points = points
    return message


def joint_positions(message: JointState, names: tuple[str, ...]) -> Array | None:
    """Positions of the named joints, shape (n,) [rad, m]; None if one is missing or not finite."""
    index = {name: position for position, name in enumerate(message.name)}
    if len(message.position) != len(message.name) or any(name not in index for name in names):
        return None
    positions = np.array([message.position[index[name]] for name in names])
    return positions if np.isfinite(positions).all() else None


def seconds(stamp: Time) -> float:
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)
