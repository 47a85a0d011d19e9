# SPDX-License-Identifier: Apache-2.0
"""Where this package's types meet messages."""

from __future__ import annotations

import array
from collections.abc import Iterable

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, TransformStamped, Vector3
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import ColorRGBA, Header
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from visualization_msgs.msg import Marker, MarkerArray

from scene_graph import BOX, COLORS, CYLINDER, SPHERE, SceneGraph

from .camera_model import PinholeCamera
from .errors import BadImageError
from .perception import Perceived

_MARKER_TYPES = {BOX: Marker.CUBE, CYLINDER: Marker.CYLINDER, SPHERE: Marker.SPHERE}


def camera_from_messages(info: CameraInfo, extrinsics: TransformStamped) -> PinholeCamera:
    """The calibrated camera; raises BadImageError if the messages do not describe one."""
    if any(abs(value) > 1e-9 for value in info.d):
        raise BadImageError("the image is distorted; publish a rectified image with d = 0")
    rotation, shift = extrinsics.transform.rotation, extrinsics.transform.translation
    pose = np.eye(4)
    pose[:3, :3] = _rotation_matrix(rotation.x, rotation.y, rotation.z, rotation.w)
    pose[:3, 3] = shift.x, shift.y, shift.z
    intrinsics = np.array(info.k, dtype=np.float64).reshape(3, 3)
    return PinholeCamera(intrinsics, pose, info.width, info.height)


def perceived_to_message(
    perceived: Perceived, header: Header, processing_seconds: float
) -> SceneGraphMsg:
    message = graph_to_message(perceived.graph, header)
    message.status = int(perceived.status)
    message.message = perceived.message
    message.processing_seconds = float(processing_seconds)
    return message


def markers_from_graph(graph: SceneGraph, header: Header) -> MarkerArray:
    """One solid and one name per block; everything shown before is deleted first."""
    markers = [Marker(header=header, action=Marker.DELETEALL)]
    for number, item in enumerate(graph.objects):
        if not all(item.size):
            continue  # without depth there are no poses
        x, y, z = item.position_world
        qx, qy, qz, qw = item.quaternion_world
        pose = Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))
        red, green, blue = COLORS[item.color]
        markers.append(
            Marker(
                header=header,
                ns="blocks",
                id=number,
                type=_MARKER_TYPES[item.shape],
                pose=pose,
                scale=Vector3(**dict(zip("xyz", item.size))),
                color=ColorRGBA(r=red, g=green, b=blue, a=0.9),
            )
        )
        markers.append(
            Marker(
                header=header,
                ns="names",
                id=number,
                type=Marker.TEXT_VIEW_FACING,
                pose=Pose(position=Point(x=x + item.size[0], y=y, z=z)),
                scale=Vector3(z=0.4 * item.size[2]),
                color=ColorRGBA(r=1.0, g=1.0, b=1.0, a=1.0),
                text=item.name,
            )
        )
    return MarkerArray(markers=markers)


def positions_from_parameter(values: Iterable[float]) -> tuple[tuple[float, float, float], ...]:
    """x, y, z of the first place, of the second, …; raises ValueError for a broken triple."""
    numbers = [float(value) for value in array.array("d", values)]
    if len(numbers) % 3:
        raise ValueError(f"needs x, y, z of each place, but has {len(numbers)} numbers")
    return tuple((x, y, z) for x, y, z in zip(numbers[0::3], numbers[1::3], numbers[2::3]))


def _rotation_matrix(x: float, y: float, z: float, w: float) -> np.ndarray:
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
