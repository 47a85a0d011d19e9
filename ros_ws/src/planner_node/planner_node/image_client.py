# SPDX-License-Identifier: Apache-2.0
"""Asking perception what a goal image shows (A.2.6)."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import Image
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ImageToSceneGraph

from .errors import CancelledError, GoalImageError
from .loop.scene_watch import POLL_SECONDS
from .settings import Settings


class ImageClient:
    """Client of ``image_to_scene_graph``. Blocks its thread; the executor needs another one."""

    def __init__(self, node: Node, settings: Settings) -> None:
        self._settings = settings
        self._client = node.create_client(
            ImageToSceneGraph, "image_to_scene_graph", callback_group=ReentrantCallbackGroup()
        )

    def interpret(
        self, image: Image, segmentation: Image, cancelled: Callable[[], bool]
    ) -> SceneGraph:
        """The scene graph of an image.

        Raises:
            GoalImageError: perception does not answer.
            CancelledError: ``cancelled`` returned True.
        """
        limit = self._settings.image_service_timeout
        deadline = time.monotonic() + limit
        self._wait(self._client.service_is_ready, deadline, cancelled)
        answered = threading.Event()
        future = self._client.call_async(
            ImageToSceneGraph.Request(image=image, segmentation=segmentation)
        )
        future.add_done_callback(lambda _future: answered.set())
        try:
            self._wait(lambda: answered.wait(POLL_SECONDS), deadline, cancelled)
        except Exception:
            self._client.remove_pending_request(future)
            raise
        return future.result().scene_graph

    def _wait(
        self, ready: Callable[[], bool], deadline: float, cancelled: Callable[[], bool]
    ) -> None:
        while not ready():
            if cancelled():
                raise CancelledError("cancelled while perception interpreted the goal image")
            if time.monotonic() >= deadline:
                raise GoalImageError(
                    "perception did not interpret the goal image within "
                    f"{self._settings.image_service_timeout:g} s; is perception_node running?"
                )
            time.sleep(POLL_SECONDS / 10)
