# SPDX-License-Identifier: Apache-2.0
"""Subscriptions that also hear publishers who offer less than was asked for."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Final, cast

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import QoSRequestedIncompatibleQoSInfo, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)

#: Of so many messages it is remembered that they were handled. The two copies of a message arrive
#: one after the other, but for what waits in the queues.
_REMEMBERED: Final = 64


class AdaptiveSubscription:
    """Asks for a profile, and for less besides as soon as a publisher appears that offers less.

    DDS connects a reliable subscription to no best-effort publisher, and one that wants earlier
    messages (transient local) to none that keeps none (volatile); without a word, nothing arrives.
    It begins with the profile wanted, since Fast DDS drops a best-effort message that is larger
    than its shared-memory segment. A message that both subscriptions receive is handled once.

    Args:
        node: it gets the subscriptions.
        kind, topic, callback: as for ``create_subscription``; the callback takes the message.
        wanted: the profile to begin with.
        callback_group: in which the callback runs.
    """

    def __init__(
        self,
        node: Node,
        kind: type,
        topic: str,
        callback: Callable[[Any], None],
        wanted: QoSProfile,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self._node, self._kind, self._topic = node, kind, topic
        self._callback, self._wanted, self._group = callback, wanted, callback_group
        self._handled: deque[int] = deque(maxlen=_REMEMBERED)
        self._relaxed = False
        # rclpy's types know no callbacks of two arguments, though it has them: the second is info.
        self._heard = cast(Callable[[Any], None], self._receive)
        node.create_subscription(
            kind,
            topic,
            self._heard,
            wanted,
            callback_group=callback_group,
            event_callbacks=SubscriptionEventCallbacks(incompatible_qos=self._on_incompatible),
        )

    @property
    def relaxed(self) -> bool:
        """Whether a publisher appeared that offers less than the profile wanted."""
        return self._relaxed

    def _on_incompatible(self, event: QoSRequestedIncompatibleQoSInfo) -> None:
        if self._relaxed or not self._node.context.ok():
            return
        self._relaxed = True
        self._node.create_subscription(
            self._kind,
            self._topic,
            self._heard,
            QoSProfile(
                history=self._wanted.history,
                depth=self._wanted.depth,
                reliability=ReliabilityPolicy.BEST_EFFORT,
                durability=DurabilityPolicy.VOLATILE,
            ),
            callback_group=self._group,
        )
        self._node.get_logger().info(
            f"{self._topic} is published with less than asked for "
            f"({_offered(event.last_policy_kind)}); it is heard like that, too"
        )

    def _receive(self, message: Any, info: dict[str, Any]) -> None:
        # The time at which the publisher wrote it tells a message from all others of the topic.
        written = info.get("source_timestamp", 0)
        if written:
            if written in self._handled:
                return
            self._handled.append(written)
        self._callback(message)


def _offered(policy: QoSPolicyKind) -> str:
    """What the publisher seems to offer, by the policy that does not fit."""
    if policy == QoSPolicyKind.RELIABILITY:
        return "best effort: large images may get lost"
    if policy == QoSPolicyKind.DURABILITY:
        return "volatile: what was sent before is not repeated"
    return f"its policy is {qos_policy_name_from_kind(policy)}"
