# SPDX-License-Identifier: Apache-2.0
"""Nodes tell that they live, and notice two that do the work of one in the same domain."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from typing import Final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

from .qos import RELIABLE

#: Between two signs of life [s].
BEAT_SECONDS: Final = 0.5
#: Who has been silent for this long is not there any more [s].
GONE_SECONDS: Final = 3.0


class Roster:
    """Who has given signs of life, by role; plain values, ``clock`` gives the time [s]."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._seen: dict[str, dict[str, tuple[float, float]]] = {}

    def note(self, role: str, identity: str) -> None:
        """A sign of life."""
        now = self._clock()
        beings = self._seen.setdefault(role, {})
        first, _ = beings.get(identity, (now, now))
        beings[identity] = (first, now)
        for other in [key for key, (_, last) in beings.items() if now - last > GONE_SECONDS]:
            del beings[other]

    def crowded(self) -> tuple[str, ...]:
        """The roles of which there are two: both were heard after the younger one appeared.

        One that was stopped, and another started in its place, are not two.
        """
        now, found = self._clock(), []
        for role, beings in self._seen.items():
            alive = [(first, last) for first, last in beings.values() if now - last <= GONE_SECONDS]
            youngest = max((first for first, _ in alive), default=0.0)
            if sum(last >= youngest for _, last in alive) > 1:
                found.append(role)
        return tuple(sorted(found))


class Presence:
    """The sign of life of one node, on ``diagnostics``, and its ear for those of the others.

    ``name`` of its DiagnosticStatus is the role, ``hardware_id`` names this very instance.

    Args:
        node: it gets a timer and a subscription in a group of their own.
        role: of which there is to be one in a namespace, such as ``planner_node``.
    """

    def __init__(self, node: Node, role: str) -> None:
        self._node, self._role = node, role
        self._identity = uuid.uuid4().hex
        self._roster = Roster()
        self._said = ""
        self._topic = node.create_publisher(DiagnosticArray, "diagnostics", RELIABLE)
        group = MutuallyExclusiveCallbackGroup()
        node.create_subscription(
            DiagnosticArray, "diagnostics", self._hear, RELIABLE, callback_group=group
        )
        node.create_timer(
            BEAT_SECONDS,
            self._beat,
            callback_group=group,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def conflict(self) -> str:
        """A sentence if two nodes do the work of one; empty otherwise. Any thread may ask."""
        crowded = self._roster.crowded()
        if not crowded:
            return ""
        return (
            f"there are two of {', '.join(crowded)} in this domain; stop one of the two graphs, or "
            "give it a ROS_DOMAIN_ID or a namespace of its own"
        )

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id:
                self._roster.note(status.name, status.hardware_id)

    def _beat(self) -> None:
        if not self._node.context.ok():
            return
        conflict = self.conflict()
        if conflict != self._said:
            self._said = conflict
            if conflict:
                self._node.get_logger().error(conflict)
        status = DiagnosticStatus(
            level=DiagnosticStatus.ERROR if conflict else DiagnosticStatus.OK,
            name=self._role,
            message=conflict or "lives",
            hardware_id=self._identity,
            values=[KeyValue(key="node", value=self._node.get_fully_qualified_name())],
        )
        message = DiagnosticArray(status=[status])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._topic.publish(message)
