# SPDX-License-Identifier: Apache-2.0
"""Streams of messages, heard by a thread of their own past the executor.

rclpy's executor looks at everything that a node has each time that anything arrives: 0.3 ms of the
interpreter for a time that takes a hundredth of that to note. A simulation that runs ten times as
fast as time sends 600 of them a second, and as many joint states. A picture comes in three messages
or four, and who waits for its graph waits for each of them.
"""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any, Final

from rclpy.callback_groups import CallbackGroup
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

#: Between two looks whether ROS was shut down, should its signal have woken nobody [s].
_LOOK_SECONDS: Final = 0.5

#: A message, and what the middleware says of it.
Callback = Callable[[Any, dict[str, Any]], None]


class StreamThread:
    """Calls the callbacks of some subscriptions, message by message, until :meth:`stop`.

    One callback at a time, but at the same time as any other of the node. What it raises is logged,
    and the stream goes on. While one runs, each subscription keeps what its profile says.

    Args:
        node: it has the subscriptions.
        name: of the thread.

    Attributes:
        node: see above.
        between: who holds it runs between two callbacks.
    """

    def __init__(self, node: Node, name: str) -> None:
        self.node = node
        self._heard: list[tuple[Subscription, Callback]] = []
        self.between = threading.Lock()
        self._stopping = False
        self._wake = GuardCondition(None, None, context=node.context)
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    @classmethod
    def subscribe(
        cls, node: Node, kind: type, topic: str, callback: Callable[[Any], None], qos: QoSProfile
    ) -> StreamThread:
        """As ``node.create_subscription``, which it calls, before the node is spun; it begins."""
        return cls._of(node, node.create_subscription(kind, topic, callback, qos))

    @classmethod
    def of_clock(cls, node: Node) -> StreamThread | None:
        """For the time that a node with ``use_sim_time`` hears; None where it does not.

        One that is told so later hears it by its executor.
        """
        name = node.resolve_topic_name("/clock")
        for subscription in node.subscriptions:
            if subscription.topic_name == name:
                return cls._of(node, subscription)
        return None

    @classmethod
    def _of(cls, node: Node, subscription: Subscription) -> StreamThread:
        stream = cls(node, f"hears {subscription.topic_name}")
        stream.hear(subscription, lambda message, _info: subscription.callback(message))
        stream.start()
        return stream

    def hear(self, subscription: Subscription, callback: Callback) -> None:
        """Takes over a subscription that no executor has begun to wait for.

        Its events, too: they share one condition with its messages, so that each message would wake
        an executor that waits for them.
        """
        events: Any = subscription.event_handlers  # rclpy's type says that it is one
        for heard in (subscription, *events):
            heard.callback_group = ASIDE
        self._heard.append((subscription, callback))
        self._wake.trigger()

    def start(self) -> None:
        """Begins to hear."""
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread, before the node is destroyed; no callback runs afterwards."""
        self._stopping = True
        self._wake.trigger()
        self._thread.join()
        self._wake.destroy()

    def _run(self) -> None:
        try:
            with ExitStack() as stack:
                self._hear(stack)
        except Exception:  # ROS may be shut down while it waits or takes
            if self.node.context.ok():
                raise

    def _hear(self, stack: ExitStack) -> None:
        context = self.node.context
        handle, wake = context.handle, self._wake.handle
        assert handle is not None  # of a context that is initialised, since it has a node
        stack.enter_context(handle)
        stack.enter_context(wake)
        heard: list[tuple[Subscription, Callback]] = []
        events: list[Any] = []
        wait_set = _rclpy.WaitSet(0, 1, 0, 0, 0, 0, handle)
        while context.ok() and not self._stopping:
            if new := self._heard[len(heard) :]:
                for subscription, _ in new:
                    stack.enter_context(subscription.handle)
                    own: Any = subscription.event_handlers
                    for event in own:
                        stack.enter_context(event)
                    events += own
                heard += new
                wait_set = _rclpy.WaitSet(len(heard), 1, 0, 0, 0, len(events), handle)
            wait_set.clear_entities()
            for subscription, _ in heard:
                wait_set.add_subscription(subscription.handle)
            for event in events:
                event.add_to_wait_set(wait_set)
            wait_set.add_guard_condition(wake)
            wait_set.wait(round(_LOOK_SECONDS * 1e9))
            for event in events:
                if event.is_ready(wait_set) and (told := event.take_data()):
                    self._call(event.callback, told)
            for subscription, callback in heard:
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
                if taken is not None:
                    self._call(callback, *taken)

    def _call(self, callback: Callable[..., None], *told: Any) -> None:
        if self._stopping:
            return
        try:
            with self.between:
                callback(*told)
        except Exception:
            if self.node.context.ok():
                self.node.get_logger().error(f"a callback failed:\n{traceback.format_exc()}")


class _Aside(CallbackGroup):
    """What is in it is nothing for an executor."""

    def can_execute(self, entity: Any) -> bool:
        del entity
        return False

    def beginning_execution(self, entity: Any) -> bool:
        return self.can_execute(entity)

    def ending_execution(self, entity: Any) -> None:
        """Nothing has begun."""


#: The group of what a :class:`StreamThread` hears, or is to hear.
ASIDE: Final = _Aside()
