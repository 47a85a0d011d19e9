# SPDX-License-Identifier: Apache-2.0
"""Where sim_node's types meet messages."""

from __future__ import annotations

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, Quaternion, Transform, TransformStamped, Vector3
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import CameraInfo, JointState
from std_msgs.msg import Header
from tamp_runtime.messages.images import image_from_array
from tamp_runtime.messages.stamps import seconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from scene_graph import rotation_from_quaternion

from .frame import Frame
from .scene import CameraConfig
from .scene.cameras import Vector
from .sensor.config import METRES, MILLIMETRES
from .sensor.depth import millimetres
from .trajectory import TrajectoryError

WORLD_FRAME = "world"


def optical_frame(config: CameraConfig) -> str:
    """The name of a camera's frame: ``camera_optical_frame`` for the first one."""
    return f"{config.name}_optical_frame"


def camera_messages(
    frame: Frame, config: CameraConfig, stamp: Time, depth_encoding: str = METRES
) -> tuple:
    """Info, colour, depth and segmentation image, and the info of depth, with one header.

    Args:
        depth_encoding: METRES or MILLIMETRES.
    """
    header = Header(stamp=stamp, frame_id=optical_frame(config))
    k = config.intrinsics
    info = CameraInfo(
        header=header,
        width=config.width,
        height=config.height,
        distortion_model="plumb_bob",
        d=list(config.distortion),
        k=k.ravel().tolist(),
        r=np.eye(3).ravel().tolist(),
        p=np.hstack([k, np.zeros((3, 1))]).ravel().tolist(),
    )
    depth = millimetres(frame.depth) if depth_encoding == MILLIMETRES else frame.depth
    return (
        info,
        image_from_array(frame.rgb, "rgb8", header),
        image_from_array(depth, depth_encoding, header),
        image_from_array(frame.labels, "16UC1", header),
        info,
    )


def extrinsics_message(config: CameraConfig, stamp: Time) -> TransformStamped:
    """The transform world → camera optical: the optical frame's pose in world."""
    pose = config.world_from_optical
    x, y, z, w = Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
    position = pose[:3, 3].tolist()
    return TransformStamped(
        header=Header(stamp=stamp, frame_id=WORLD_FRAME),
        child_frame_id=optical_frame(config),
        transform=Transform(
            translation=Vector3(x=position[0], y=position[1], z=position[2]),
            rotation=Quaternion(x=x, y=y, z=z, w=w),
        ),
    )


def sight_from_message(message: PoseStamped) -> tuple[Vector, Vector]:
    """Where a camera is to be, and a point 1 m before it, of its optical frame's pose in world."""
    at, turn = message.pose.position, message.pose.orientation
    forward = rotation_from_quaternion((turn.x, turn.y, turn.z, turn.w))[:, 2]
    position = (at.x, at.y, at.z)
    x, y, z = np.add(position, forward).tolist()
    return position, (x, y, z)


def joint_state_message(
    names: tuple[str, ...],
    positions: NDArray[np.float64],
    velocities: NDArray[np.float64],
    efforts: NDArray[np.float64],
    stamp: Time,
) -> JointState:
    """Positions, velocities and efforts of the named joints, shapes (n,) [rad, m; …]."""
    return JointState(
        header=Header(stamp=stamp),
        name=list(names),
        position=positions.tolist(),
        velocity=velocities.tolist(),
        effort=efforts.tolist(),
    )


def trajectory_arrays(
    message: JointTrajectory,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64] | None]:
    """Times (t,), positions (t, n) and velocities (t, n) or None.

    Raises:
        TrajectoryError: if the points have different numbers of values.
    """
    points: list[JointTrajectoryPoint] = message.points
    joints = len(message.joint_names)
    has_velocities = all(point.velocities for point in points)
    for index, point in enumerate(points):
        if len(point.positions) != joints:
            raise TrajectoryError(
                f"point {index} has {len(point.positions)} positions for {joints} joints"
            )
        if point.velocities and len(point.velocities) != joints:
            raise TrajectoryError(
                f"point {index} has {len(point.velocities)} velocities for {joints} joints"
            )
    times = np.array([seconds(point.time_from_start) for point in points])
    positions = np.array([point.positions for point in points], dtype=float)
    velocities = (
        np.array([point.velocities for point in points], dtype=float) if has_velocities else None
    )
    return times, positions, velocities
