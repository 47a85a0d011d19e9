# SPDX-License-Identifier: Apache-2.0
"""Where this package's types meet messages."""

from __future__ import annotations

from typing import Final

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, TransformStamped, Vector3
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import ColorRGBA, Header
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from visualization_msgs.msg import Marker, MarkerArray

from scene_graph import BOX, COLORS, CYLINDER, PRISM, SPHERE, SceneGraph, is_hidden

from .calibration import FramePose, LensModel
from .pipeline import Perceived

#: Colour of what is hidden, whatever it is.
_UNKNOWN: Final = (0.5, 0.5, 0.5)
_MARKER_TYPES: Final = {
    BOX: Marker.CUBE,
    CYLINDER: Marker.CYLINDER,
    SPHERE: Marker.SPHERE,
    PRISM: Marker.CUBE,  # RViz has no prism
}
#: Of what is shown of blocks of unknown colours, sRGB in 0..1.
_NO_COLOR: Final = (1.0, 1.0, 1.0)


def lens_from_message(info: CameraInfo) -> LensModel:
    """The camera as the message describes it; whether one can be like this is not looked at."""
    roi = info.roi
    return LensModel(
        frame=info.header.frame_id,
        width=info.width,
        height=info.height,
        k=tuple(info.k),
        distortion_model=info.distortion_model,
        d=tuple(info.d),
        r=tuple(info.r),
        p=tuple(info.p),
        region=(roi.x_offset, roi.y_offset, roi.width, roi.height),
    )


def frame_pose_from_message(message: TransformStamped) -> FramePose:
    """The pose that the message holds; whether its quaternion is one is not looked at."""
    shift, turn = message.transform.translation, message.transform.rotation
    return FramePose(
        message.header.frame_id,
        message.child_frame_id,
        (shift.x, shift.y, shift.z),
        (turn.x, turn.y, turn.z, turn.w),
    )


def pose_to_message(pose: NDArray[np.float64]) -> Pose:
    """Of a homogeneous matrix, shape (4, 4) [m]."""
    x, y, z = pose[:3, 3].tolist()
    qx, qy, qz, qw = Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))


def perceived_to_message(
    perceived: Perceived, header: Header, processing_seconds: float
) -> SceneGraphMsg:
    """The message; ``processing_seconds`` is how long it took from the image's arrival."""
    message = graph_to_message(perceived.graph, header)
    message.status = int(perceived.status)
    message.message = perceived.message
    message.probability = float(perceived.probability)
    message.coverage = float(perceived.coverage)
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
        red, green, blue = COLORS.get(item.color, _NO_COLOR)
        markers.append(
            Marker(
                header=header,
                ns="blocks",
                id=number,
                type=_MARKER_TYPES[item.shape],
                pose=pose,
                scale=Vector3(**dict(zip("xyz", item.size))),
                color=ColorRGBA(r=red, g=green, b=blue, a=0.3 if is_hidden(item.name) else 0.9),
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
