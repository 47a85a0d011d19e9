# SPDX-License-Identifier: Apache-2.0
"""Who knows how the blocks really stand."""

from __future__ import annotations

from typing import Any

from rclpy.node import Node
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import LATCHED


class Judge(Node):
    """Reads the ground truth, which the nodes under test must not."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("judge", **kwargs)
        self._truth: SceneGraph | None = None
        self.create_subscription(SceneGraph, "sim/ground_truth", self._on_truth, LATCHED)

    def _on_truth(self, message: SceneGraph) -> None:
        self._truth = message

    @property
    def stacks(self) -> Any:
        """The newest arrangement; None before the first."""
        return graph_from_message(self._truth).stacks() if self._truth else None

    def place_of(self, name: str) -> int:
        """The place that a block is on."""
        return next(i for i, stack in enumerate(self.stacks) if name in stack)
