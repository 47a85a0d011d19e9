# SPDX-License-Identifier: Apache-2.0
"""Subscriptions that also hear publishers who offer less than was asked for."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Final

from rclpy.event_handler import QoSRequestedIncompatibleQoSInfo, SubscriptionEventCallbacks
from rclpy.qos import (
    DurabilityPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)

from .stream_thread import ASIDE, StreamThread

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
        stream: the thread that hears them; its node gets the subscriptions.
        kind, topic, callback: as for ``create_subscription``; the callback takes the message.
        wanted: the profile to begin with.
    """

    def __init__(
        self,
        stream: StreamThread,
        kind: type,
        topic: str,
        callback: Callable[[Any], None],
        wanted: QoSProfile,
    ) -> None:
        self._stream, self._kind, self._topic = stream, kind, topic
        self._callback, self._wanted = callback, wanted
        self._handled: deque[int] = deque(maxlen=_REMEMBERED)
        self._relaxed = False
        self._subscribe(wanted, SubscriptionEventCallbacks(incompatible_qos=self._on_incompatible))

    def _subscribe(
        self, profile: QoSProfile, events: SubscriptionEventCallbacks | None = None
    ) -> None:
        subscription = self._stream.node.create_subscription(
            self._kind,
            self._topic,
            self._callback,
            profile,
            callback_group=ASIDE,
            event_callbacks=events,
        )
        self._stream.hear(subscription, self._receive)

    @property
    def relaxed(self) -> bool:
        """Whether a publisher appeared that offers less than the profile wanted."""
        return self._relaxed

    def _on_incompatible(self, event: QoSRequestedIncompatibleQoSInfo) -> None:
        if self._relaxed or not self._stream.node.context.ok():
            return
        self._relaxed = True
        self._subscribe(
            QoSProfile(
                history=self._wanted.history,
                depth=self._wanted.depth,
                reliability=ReliabilityPolicy.BEST_EFFORT,
                durability=DurabilityPolicy.VOLATILE,
            )
        )
        self._stream.node.get_logger().info(
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
