# SPDX-License-Identifier: Apache-2.0
"""Where this package's types meet messages."""

from __future__ import annotations

from typing import Final

from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from std_msgs.msg import ColorRGBA, Header
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from visualization_msgs.msg import Marker, MarkerArray

from scene_graph import BOX, COLORS, CYLINDER, PRISM, SPHERE, SceneGraph

from .pipeline import Perceived

_MARKER_TYPES: Final = {
    BOX: Marker.CUBE,
    CYLINDER: Marker.CYLINDER,
    SPHERE: Marker.SPHERE,
    PRISM: Marker.CUBE,  # RViz has no prism
}


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
