# SPDX-License-Identifier: Apache-2.0
"""Where messages meet the types of motion_node."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from tamp_interfaces.msg import PlanSighting as PlanSightingMsg
from tamp_interfaces.msg import SymbolicPlan
from tamp_runtime.messages.scene_graph import (
    graph_from_message,
    moves_from_messages,
    object_from_message,
)
from tamp_runtime.messages.stamps import duration_from_seconds, seconds, stamp_from_nanoseconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker, MarkerArray

from scene_graph import rotation_from_quaternion

from .errors import InvalidPlanError, JointStateError
from .execution.last_look import PlanSighting, Sight
from .execution.plan import Plan
from .obstacles import (
    MOST,
    Obstacle,
    ObstacleError,
    capsule,
    upright_box,
    upright_cylinder,
    within_range,
)
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
        explain=message.explain,
        watched=message.watched,
        frame=message.initial.header.frame_id or message.header.frame_id,
    )


def sighting_from_message(message: PlanSightingMsg) -> PlanSighting:
    """What the planner sees of a plan that is watched.

    Raises:
        ValueError: if it is of a kind that is not known.
    """
    return PlanSighting(
        message.plan_id,
        seconds(message.header.stamp),
        message.move,
        Sight(message.sight),
        tuple(object_from_message(item) for item in message.moved),
    )


def trajectory_to_message(
    trajectory: Trajectory, arm: Arm, begins: float | None = None
) -> JointTrajectory:
    """Names all joints.

    Args:
        begins: when it starts, or has started, by the clock of the controller [s]; None: at once.
    """
    positions, velocities = trajectory.positions.joined(), trajectory.velocities.joined()
    message = _message(arm.joint_names, trajectory.times, positions, velocities)
    return _stamped(message, begins)


def trajectory_to_two_messages(
    trajectory: Trajectory, arm: Arm, begins: float | None
) -> tuple[JointTrajectory, JointTrajectory]:
    """One that names the arm's joints, and one that names the fingers', with the same stamp.

    Args:
        begins: when it starts, by the clock of the controllers [s]; None: at once.
    """
    times, positions, velocities = trajectory.times, trajectory.positions, trajectory.velocities
    own = _message(arm.arm_joints, times, positions.arm, velocities.arm)
    fingers = _message(arm.gripper.finger_joints, times, positions.fingers, velocities.fingers)
    return _stamped(own, begins), _stamped(fingers, begins)


def _stamped(message: JointTrajectory, begins: float | None) -> JointTrajectory:
    """With a stamp of zero a controller starts at once."""
    if begins is not None:
        message.header.stamp = stamp_from_nanoseconds(round(begins * 1e9))
    return message


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


def obstacles_from_markers(
    message: MarkerArray,
    known: Mapping[str, tuple[Obstacle, ...]],
    check_frame: Callable[[str], None],
) -> dict[str, tuple[Obstacle, ...]]:
    """What stands around after a message, by the markers' names; what ``known`` has stays.

    Markers as RViz takes them: ADD puts one of a namespace and id there, or in another place;
    DELETE and DELETEALL take away. A CUBE, a CYLINDER and a SPHERE are what they are called; each
    pair of points of a LINE_LIST is a capsule as thick as its ``scale.x``. What is not upright
    counts as the upright box around it. Poses are absolute; colours are not read.

    Args:
        check_frame: raises InvalidPlanError for a frame that is not the arm's.

    Raises:
        ObstacleError: nothing of the message counts then; the sentence names marker and key.
    """
    found = dict(known)
    for index, marker in enumerate(message.markers):
        key = f"markers[{index}]"
        if marker.action == Marker.DELETEALL:
            found = {n: own for n, own in found.items() if marker.ns and not _of(n, marker.ns)}
            continue
        name = f"{marker.ns or 'obstacle'} {marker.id}" if marker.id else marker.ns or "obstacle"
        if marker.action == Marker.DELETE:
            found.pop(name, None)
            continue
        if marker.action != Marker.ADD:
            raise ObstacleError(
                f"{key}.action = {marker.action} is unknown; ADD, DELETE, DELETEALL"
            )
        if marker.lifetime.sec or marker.lifetime.nanosec:
            raise ObstacleError(f"{key}.lifetime is not 0: obstacles stay until they are deleted")
        try:
            check_frame(marker.header.frame_id)
        except InvalidPlanError as error:
            raise ObstacleError(f"{key}.header: {error}", frame=True) from error
        found[name] = tuple(within_range(item, key) for item in _parts(marker, name, key))
    if sum(map(len, found.values())) > MOST:
        raise ObstacleError(f"more than {MOST} obstacles are not kept clear of", number=True)
    return found


def _of(name: str, namespace: str) -> bool:
    return name == namespace or name.rpartition(" ")[0] == namespace


def _parts(marker: Marker, name: str, key: str) -> list[Obstacle]:
    turn = marker.pose.orientation
    quaternion = np.array([turn.x, turn.y, turn.z, turn.w])
    norm = float(np.linalg.norm(quaternion))
    if not 0.5 < norm < 2.0:  # nan, too
        raise ObstacleError(f"{key}.pose.orientation = {quaternion.tolist()} is no quaternion")
    x, y, z, w = (float(value) for value in quaternion / norm)
    rotation = rotation_from_quaternion((x, y, z, w))
    at = marker.pose.position
    position = (at.x, at.y, at.z)
    size = (marker.scale.x, marker.scale.y, marker.scale.z)
    if marker.type == Marker.CUBE:
        return [upright_box(name, size, position, rotation)]
    if marker.type in (Marker.CYLINDER, Marker.SPHERE):
        round_ = rotation if marker.type == Marker.CYLINDER else np.eye(3)
        if marker.type == Marker.SPHERE and len(set(size)) > 1:
            raise ObstacleError(
                f"{key}.scale = {list(size)}: a sphere is as wide in all directions"
            )
        return [upright_cylinder(name, size, position, round_)]
    if marker.type != Marker.LINE_LIST:
        raise ObstacleError(
            f"{key}.type = {marker.type} is unknown; CUBE, CYLINDER, SPHERE, or LINE_LIST"
        )
    points = [rotation @ (p.x, p.y, p.z) + position for p in marker.points]
    if not points or len(points) % 2 or not np.isfinite(points).all():
        raise ObstacleError(f"{key}.points are not pairs of finite points")
    ends = [(float(a), float(b), float(c)) for a, b, c in points]
    return [capsule(name, pair, marker.scale.x / 2) for pair in zip(ends[::2], ends[1::2])]
