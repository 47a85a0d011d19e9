# SPDX-License-Identifier: Apache-2.0
"""A quick stream of small messages, heard by a thread of its own past the executor.

rclpy's executor looks at everything that a node has each time that anything arrives: 0.3 ms of the
interpreter for a time that takes a hundredth of that to note. A simulation that runs ten times as
fast as time sends 600 of them a second, and as many joint states.
"""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from typing import Any, Final

from rclpy.callback_groups import CallbackGroup
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

#: Between two looks whether ROS was shut down, should its signal have woken nobody [s].
_LOOK_SECONDS: Final = 0.5


class StreamThread:
    """Calls the callback of one subscription, message by message, until :meth:`stop`.

    The callback must be quick, and may run at the same time as any other of the node. What it
    raises is logged, and the stream goes on.

    Args:
        node: it has the subscription.
        subscription: no executor may have begun to wait for it.
    """

    def __init__(self, node: Node, subscription: Subscription) -> None:
        self._node, self._subscription = node, subscription
        # Its events, too: they share one condition with its messages, so that each message would
        # wake an executor that waits for them.
        events: Any = subscription.event_handlers  # rclpy's type says that it is one
        for heard in (subscription, *events):
            heard.callback_group = _Aside()
        self._stopping = False
        self._wake = GuardCondition(None, None, context=node.context)
        self._thread = threading.Thread(
            target=self._run, name=f"hears {subscription.topic_name}", daemon=True
        )
        self._thread.start()

    @classmethod
    def subscribe(
        cls, node: Node, kind: type, topic: str, callback: Callable[[Any], None], qos: QoSProfile
    ) -> StreamThread:
        """As ``node.create_subscription``, which it calls, before the node is spun.

        That a publisher offers less than ``qos`` is not said: it is to be best effort and volatile.
        """
        return cls(node, node.create_subscription(kind, topic, callback, qos))

    @classmethod
    def of_clock(cls, node: Node) -> StreamThread | None:
        """For the time that a node with ``use_sim_time`` hears; None where it does not.

        One that is told so later hears it by its executor.
        """
        name = node.resolve_topic_name("/clock")
        for subscription in node.subscriptions:
            if subscription.topic_name == name:
                return cls(node, subscription)
        return None

    def stop(self) -> None:
        """Ends the thread, before the node is destroyed; the callback does not run afterwards."""
        self._stopping = True
        self._wake.trigger()
        self._thread.join()
        self._wake.destroy()

    def _run(self) -> None:
        try:
            self._hear()
        except Exception:  # ROS may be shut down while it waits or takes
            if self._node.context.ok():
                raise

    def _hear(self) -> None:
        context, subscription = self._node.context, self._subscription
        handle = context.handle
        assert handle is not None  # of a context that is initialised, since it has a node
        with subscription.handle, self._wake.handle, handle:
            wait_set = _rclpy.WaitSet(1, 1, 0, 0, 0, 0, handle)
            while context.ok() and not self._stopping:
                wait_set.clear_entities()
                wait_set.add_subscription(subscription.handle)
                wait_set.add_guard_condition(self._wake.handle)
                wait_set.wait(round(_LOOK_SECONDS * 1e9))
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
                if taken is not None and not self._stopping:
                    self._call(taken[0])

    def _call(self, message: Any) -> None:
        try:
            self._subscription.callback(message)
        except Exception:
            if self._node.context.ok():
                self._node.get_logger().error(f"a callback failed:\n{traceback.format_exc()}")


class _Aside(CallbackGroup):
    """What is in it is nothing for an executor."""

    def can_execute(self, entity: Any) -> bool:
        del entity
        return False

    def beginning_execution(self, entity: Any) -> bool:
        return self.can_execute(entity)

    def ending_execution(self, entity: Any) -> None:
        """Nothing has begun."""
