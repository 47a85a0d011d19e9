# SPDX-License-Identifier: Apache-2.0
"""The last of several cameras is asked to look at what is hidden from all of them."""

from __future__ import annotations

from typing import Final

import numpy as np
from geometry_msgs.msg import PoseStamped
from numpy.typing import NDArray
from rclpy.node import Node
from std_msgs.msg import Header
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.qos import NEWEST

from scene_graph import SceneGraph, is_hidden

from .camera import PinholeCamera
from .config import PerceptionConfig
from .conversions import pose_to_message
from .next_view import next_view

#: A camera is where it was asked to be by so much before its pictures from there are used [ns].
ARRIVING: Final = 2 * 10**9


class ViewRequests:
    """Publishes where a camera would have to be, if anybody listens.

    Attributes:
        camera: its name.
        seen: as it took the newest picture that could be used; None before, or where none could.

    Args:
        node: it gets the publisher.
        camera: see above.
    """

    def __init__(self, node: Node, camera: str) -> None:
        self.camera = camera
        self.seen: PinholeCamera | None = None
        self._node = node
        self._publisher = node.create_publisher(PoseStamped, f"{camera}/view_request", NEWEST)
        self._asked: NDArray[np.float64] | None = None
        self._asked_at = 0

    def ask(self, graph: SceneGraph, config: PerceptionConfig, header: Header) -> bool:
        """Says from where the camera would see what is hidden, whenever that is elsewhere.

        Args:
            graph: what all cameras see.
            config: where the places are.
            header: of the picture, in the frame of all poses.

        Returns:
            Whether it may be about to be seen from there.
        """
        hidden = any(is_hidden(item.name) for item in graph.objects)
        if not hidden or not self._publisher.get_subscription_count():
            return False
        stamp = nanoseconds(header.stamp)
        arriving = 0 <= stamp - self._asked_at < ARRIVING
        view = None if self.seen is None else next_view(graph, self.seen, config)
        if self.seen is None or view is None:
            return arriving
        there = view.world_from_optical
        if np.allclose(there, self.seen.world_from_optical, atol=0.01):
            return arriving
        if self._asked is None or not np.allclose(self._asked, there, atol=0.01):
            self._node.get_logger().info(f"{self.camera} is asked to look at what is hidden")
        self._asked, self._asked_at = there, stamp
        self._publisher.publish(PoseStamped(header=header, pose=pose_to_message(there)))
        return True
