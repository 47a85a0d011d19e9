# SPDX-License-Identifier: Apache-2.0
"""Whatever quality of service a publisher offers, its messages arrive, and each of them once."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int64
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE
from tamp_runtime.stream_thread import StreamThread
from tamp_runtime.subscriptions import AdaptiveSubscription

BEST_EFFORT = QoSProfile(depth=20, reliability=ReliabilityPolicy.BEST_EFFORT)
KEPT_BEST_EFFORT = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class Listener(Node):
    """Keeps the numbers that arrive on ``numbers``."""

    def __init__(self, wanted: QoSProfile, **fields: Any) -> None:
        super().__init__("listener", **fields)
        self.heard: list[int] = []
        self.stream = StreamThread(self, "numbers")
        self.subscription = AdaptiveSubscription(
            self.stream, Int64, "numbers", lambda message: self.heard.append(message.data), wanted
        )
        self.stream.start()

    def destroy_node(self) -> None:
        self.stream.stop()
        super().destroy_node()


class Speaker(Node):
    """Publishes numbers by each of its profiles; the hundreds tell which one."""

    def __init__(self, profiles: list[QoSProfile], **fields: Any) -> None:
        super().__init__("speaker", **fields)
        self.topics = [self.create_publisher(Int64, "numbers", item) for item in profiles]
        self.number = 0

    def speak(self) -> None:
        self.number += 1
        for index, topic in enumerate(self.topics):
            topic.publish(Int64(data=1_000_000 * index + self.number))


@pytest.mark.parametrize("wanted", [NEWEST, RELIABLE, LATCHED], ids=["newest", "all", "latched"])
@pytest.mark.parametrize(
    "offered", [BEST_EFFORT, RELIABLE, KEPT_BEST_EFFORT], ids=["best effort", "volatile", "kept"]
)
def test_fault_8_a_publisher_that_offers_less_is_heard(
    ros_context: Any, wanted: QoSProfile, offered: QoSProfile
) -> None:
    listener = ros_context.add(Listener(wanted, context=ros_context.context))
    speaker = ros_context.add(Speaker([offered], context=ros_context.context))

    def heard() -> bool:
        speaker.speak()
        return len(listener.heard) > 5

    ros_context.wait_until(heard)
    assert listener.heard == sorted(set(listener.heard))


@pytest.mark.parametrize("wanted", [NEWEST, LATCHED], ids=["newest", "latched"])
def test_what_is_offered_as_wanted_is_heard_by_one_subscription(
    ros_context: Any, wanted: QoSProfile
) -> None:
    listener = ros_context.add(Listener(wanted, context=ros_context.context))
    speaker = ros_context.add(Speaker([wanted], context=ros_context.context))

    def heard() -> bool:
        speaker.speak()
        return len(listener.heard) > 20

    ros_context.wait_until(heard)
    assert not listener.subscription.relaxed
    assert listener.count_subscribers("numbers") == 1


def test_what_was_latched_before_is_heard_by_who_comes_later(ros_context: Any) -> None:
    speaker = ros_context.add(Speaker([LATCHED], context=ros_context.context))
    speaker.speak()
    listener = ros_context.add(Listener(LATCHED, context=ros_context.context))
    ros_context.wait_until(lambda: listener.heard == [1])


def test_fault_8_no_message_is_handled_twice_where_both_kinds_of_publisher_are(
    ros_context: Any,
) -> None:
    listener = ros_context.add(Listener(RELIABLE, context=ros_context.context))
    speaker = ros_context.add(Speaker([RELIABLE, BEST_EFFORT], context=ros_context.context))

    def both_are_heard() -> bool:
        speaker.speak()
        return (
            sum(number < 1_000_000 for number in listener.heard) > 50
            and sum(number >= 1_000_000 for number in listener.heard) > 50
        )

    ros_context.wait_until(both_are_heard)
    assert listener.count_subscribers("numbers") == 2  # so the reliable ones arrive twice
    assert len(listener.heard) == len(set(listener.heard))
