# SPDX-License-Identifier: Apache-2.0
"""Where this package's types meet messages."""

from __future__ import annotations

from typing import Final

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, TransformStamped, Vector3
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import ColorRGBA, Header
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from visualization_msgs.msg import Marker, MarkerArray

from scene_graph import BOX, COLORS, CYLINDER, PRISM, SPHERE, SceneGraph, rotation_from_quaternion

from .camera import PinholeCamera
from .errors import BadImageError
from .pipeline import Perceived

#: How much longer or shorter than 1 the camera's quaternion may be.
QUATERNION_TOLERANCE: Final = 2e-4

_MARKER_TYPES: Final = {
    BOX: Marker.CUBE,
    CYLINDER: Marker.CYLINDER,
    SPHERE: Marker.SPHERE,
    PRISM: Marker.CUBE,  # RViz has no prism
}


def camera_from_messages(info: CameraInfo, extrinsics: TransformStamped) -> PinholeCamera:
    """The calibrated camera; raises BadImageError if the messages do not describe one."""
    if any(abs(value) > 1e-9 for value in info.d):
        raise BadImageError("the image is distorted; publish a rectified image with d = 0")
    rotation, shift = extrinsics.transform.rotation, extrinsics.transform.translation
    quaternion = (rotation.x, rotation.y, rotation.z, rotation.w)
    if not abs(np.linalg.norm(quaternion) - 1.0) < QUATERNION_TOLERANCE:
        raise BadImageError("camera/extrinsics does not hold a unit quaternion")
    pose = np.eye(4)
    pose[:3, :3] = rotation_from_quaternion(quaternion)
    pose[:3, 3] = shift.x, shift.y, shift.z
    intrinsics = np.array(info.k, dtype=np.float64).reshape(3, 3)
    return PinholeCamera(intrinsics, pose, info.width, info.height)


def perceived_to_message(
    perceived: Perceived, header: Header, processing_seconds: float
) -> SceneGraphMsg:
    """The message; ``processing_seconds`` is how long it took from the image's arrival."""
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
