# SPDX-License-Identifier: Apache-2.0
"""Obstacles that are told while the arm moves, and that nothing of the table shows."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Final

import numpy as np
from geometry_msgs.msg import Point, Pose, Vector3
from rclpy.node import Node
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import LATCHED
from visualization_msgs.msg import Marker, MarkerArray

from faults.injections import Once
from faults.setting import Setting

#: A box over a place, which no hand gets past from above [m].
_SIZE: Final = (0.1, 0.1, 0.2)
_HEIGHT: Final = 0.3
#: Until a message has been heard for certain [s].
_HEARD: Final = 0.5


@dataclass(frozen=True)
class InTheWay(Once):
    """A box hangs over each place but the one that the hand is nearest to: any move meets one."""

    def begin(self, setting: Setting) -> None:
        truth, said = setting.eyes.fresh_truth(), setting.eyes.motion()
        hand = np.array([said.hand.x, said.hand.y]) if said is not None else np.zeros(2)
        places = sorted(
            (place.position_world for place in truth.places),
            key=lambda place: float(np.linalg.norm(np.array(place[:2]) - hand)),
        )
        teller = _Teller()
        setting.others.append(teller)
        teller.tell([(x, y, z + _HEIGHT) for x, y, z in places[1:]])

    def end(self, setting: Setting) -> None:
        """They are gone, as a message says."""
        setting.stop_others()


class _Teller:
    """Publishes on ``obstacles``; leaving takes all away."""

    def __init__(self) -> None:
        self._node = Node("fault_obstacles")
        self._publisher = self._node.create_publisher(MarkerArray, "obstacles", LATCHED)
        self._thread = NodeThread(self._node)

    def tell(self, centres: list[tuple[float, float, float]]) -> None:
        """Where the boxes are, in world [m]."""
        markers = [Marker(action=Marker.DELETEALL)]
        for number, (x, y, z) in enumerate(centres):
            marker = Marker(ns="bar", id=number, type=Marker.CUBE, action=Marker.ADD)
            marker.header.frame_id = "world"
            marker.pose = Pose(position=Point(x=x, y=y, z=z))
            marker.pose.orientation.w = 1.0
            marker.scale = Vector3(x=_SIZE[0], y=_SIZE[1], z=_SIZE[2])
            markers.append(marker)
        self._publisher.publish(MarkerArray(markers=markers))

    def __exit__(self, *_error: object) -> None:
        self.tell([])
        time.sleep(_HEARD)
        self._thread.stop()
        self._node.destroy_node()
