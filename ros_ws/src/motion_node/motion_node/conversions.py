# SPDX-License-Identifier: Apache-2.0
"""Where messages meet the types of motion_node."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from tamp_interfaces.msg import SymbolicPlan
from tamp_runtime.messages.scene_graph import graph_from_message, moves_from_messages
from tamp_runtime.messages.stamps import duration_from_seconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from .errors import InvalidPlanError
from .executive import Plan
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


def trajectory_to_message(trajectory: Trajectory) -> JointTrajectory:
    """The stamp stays zero, which asks the controller to start at once."""
    message = JointTrajectory(joint_names=list(trajectory.joint_names))
    points = []
    for time, positions, velocities in zip(
        trajectory.times.tolist(), trajectory.positions.tolist(), trajectory.velocities.tolist()
    ):
        points.append(
            JointTrajectoryPoint(
                positions=positions,
                velocities=velocities,
                time_from_start=duration_from_seconds(time),
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
