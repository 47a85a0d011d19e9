# SPDX-License-Identifier: Apache-2.0
"""Quick streams are heard by a thread of their own, and no executor is troubled with them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from tamp_runtime.messages.stamps import stamp_from_nanoseconds
from tamp_runtime.qos import RELIABLE, SENSOR_DATA
from tamp_runtime.stream_thread import StreamThread

SIM_TIME = [Parameter("use_sim_time", value=True)]


class Listener:
    """A node that no executor spins, and one that publishes what it hears."""

    def __init__(self, ros_context: Any) -> None:
        self.ros = ros_context
        self.node = Node("listener", context=ros_context.context)
        self.source = Node("source", context=ros_context.context)
        self.publisher = self.source.create_publisher(Clock, "stream", RELIABLE)
        ros_context.add(self.source)

    @contextmanager
    def hears(self, callback: Callable[[Clock], None]) -> Iterator[StreamThread]:
        stream = StreamThread.subscribe(self.node, Clock, "stream", callback, RELIABLE)
        self.ros.wait_until(lambda: self.publisher.get_subscription_count() == 1)
        try:
            yield stream
        finally:
            stream.stop()

    def say(self, second: int) -> None:
        self.publisher.publish(Clock(clock=stamp_from_nanoseconds(second * 10**9)))


@pytest.fixture
def listener(ros_context: Any) -> Iterator[Listener]:
    listener = Listener(ros_context)
    yield listener
    listener.node.destroy_node()


def test_messages_arrive_in_their_order(listener: Listener) -> None:
    heard: list[int] = []
    with listener.hears(lambda message: heard.append(message.clock.sec)):
        for second in range(20):
            listener.say(second)
            listener.ros.wait_until(lambda: second in heard)  # noqa: B023
    assert heard == list(range(20))


def test_what_a_callback_raises_does_not_end_the_stream(listener: Listener) -> None:
    heard: list[int] = []

    def hear(message: Clock) -> None:
        heard.append(message.clock.sec)
        raise RuntimeError(f"second {message.clock.sec}")

    with listener.hears(hear):
        for second in (1, 2):
            listener.say(second)
            listener.ros.wait_until(lambda: second in heard)  # noqa: B023
    assert heard == [1, 2]


def test_nothing_is_heard_after_its_end(listener: Listener) -> None:
    heard: list[int] = []
    with listener.hears(lambda message: heard.append(message.clock.sec)):
        listener.say(1)
        listener.ros.wait_until(lambda: heard)
    listener.say(2)
    assert heard == [1]


def test_no_executor_waits_for_it(listener: Listener) -> None:
    """Nor for its events: data makes the condition that they share true."""
    with listener.hears(lambda _message: None):
        (subscription,) = (s for s in listener.node.subscriptions if s.topic_name == "/stream")
        events: Any = subscription.event_handlers
        assert events
        assert set(events) <= set(listener.node.waitables)
        for waited_for in (subscription, *events):
            assert not waited_for.callback_group.can_execute(waited_for)


def test_several_subscriptions_are_heard_one_message_at_a_time(ros_context: Any) -> None:
    node = Node("listener", context=ros_context.context)
    source = ros_context.add(Node("source", context=ros_context.context))
    topics = [source.create_publisher(Clock, name, RELIABLE) for name in ("one", "two", "late")]
    stream, heard, running = StreamThread(node, "several"), set[str](), threading.Lock()
    alone: list[bool] = []

    def hear(topic: str) -> None:
        def on_message(_message: Clock, _info: dict[str, Any]) -> None:
            alone.append(running.acquire(blocking=False))
            heard.add(topic)
            running.release()

        stream.hear(node.create_subscription(Clock, topic, print, RELIABLE), on_message)

    def arrive(names: set[str]) -> None:
        def all_heard() -> bool:
            for topic in topics:
                topic.publish(Clock())
            return heard >= names

        ros_context.wait_until(all_heard)

    hear("one")
    hear("two")
    stream.start()
    try:
        arrive({"one", "two"})
        hear("late")  # while it runs
        arrive({"late"})
        with stream.between:
            heard.clear()
            for topic in topics:
                topic.publish(Clock())
            assert not heard
        arrive({"one", "two", "late"})
        assert all(alone)
    finally:
        stream.stop()
        node.destroy_node()


@pytest.mark.parametrize(
    ("namespace", "rules"), [("", []), ("left", ["--ros-args", "-r", "/clock:=clock"])]
)
def test_a_node_hears_the_time_of_its_graph(
    ros_context: Any, namespace: str, rules: list[str]
) -> None:
    node = Node(
        "sleeper",
        context=ros_context.context,
        namespace=namespace,
        cli_args=rules,
        parameter_overrides=SIM_TIME,
    )
    source = ros_context.add(Node("source", context=ros_context.context, namespace=namespace))
    clock = source.create_publisher(Clock, "clock", SENSOR_DATA)
    stream = StreamThread.of_clock(node)  # nothing else spins it
    assert stream is not None
    try:
        ros_context.wait_until(lambda: clock.get_subscription_count() == 1)
        message = Clock(clock=stamp_from_nanoseconds(7_500_000_000))

        def has_the_time() -> bool:
            clock.publish(message)  # best effort: one may get lost
            return bool(node.get_clock().now().nanoseconds == 7_500_000_000)

        ros_context.wait_until(has_the_time)
    finally:
        stream.stop()
        node.destroy_node()


def test_a_node_with_the_hosts_time_has_no_thread_for_it(ros_context: Any) -> None:
    node = ros_context.add(Node("awake", context=ros_context.context))
    assert StreamThread.of_clock(node) is None
