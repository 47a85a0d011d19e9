# SPDX-License-Identifier: Apache-2.0
"""A node that another one depends on: does it live, and is it still the same one?

Of a process that was killed, DDS says for 20 s that its services are there; a request to it is
lost. Its signs of life (:mod:`tamp_runtime.presence`) tell sooner.
"""

from __future__ import annotations

import threading
from typing import Final

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

from .presence import BEAT_SECONDS
from .qos import RELIABLE

#: Who was heard within so many beats lives.
LIVING_BEATS: Final = 4
#: Who is silent for so many beats while another one lives was replaced by it: 3 s.
REPLACED_BEATS: Final = 6
#: Who is silent for so many beats is gone, 8 s: one that stood still for 5 s is not.
GONE_BEATS: Final = 16
#: Where nobody was heard in so many beats, nobody gives signs of life: 3 s.
MUTE_BEATS: Final = 6
#: After so many signs of life its services have been found, too.
FOUND_SIGNS: Final = 3
_FORGOTTEN_BEATS: Final = 240


class Sightings:
    """Which instances of one role live, counted in beats; plain values, for any thread.

    The beats are the listener's own. If it stood still itself, or the machine did, then the others
    were not silent for any longer than it did not listen.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._beats = 0
        self._waits_since: int | None = None
        self._silence: dict[str, int] = {}
        self._signs: dict[str, int] = {}

    def hear(self, identity: str) -> None:
        """A sign of life."""
        with self._lock:
            self._silence[identity] = 0
            self._signs[identity] = self._signs.get(identity, 0) + 1

    def beat(self) -> None:
        """Another ``BEAT_SECONDS`` have passed for the listener."""
        with self._lock:
            self._beats += 1
            for identity in list(self._silence):
                self._silence[identity] += 1
                if self._silence[identity] > _FORGOTTEN_BEATS:
                    del self._silence[identity]
                    del self._signs[identity]

    def living(self) -> frozenset[str]:
        """Who lives; two are one too many, or one that has just been replaced."""
        with self._lock:
            return self._living()

    def are_found(self, servers: int) -> bool:
        """Whether a request will reach one that lives; ``servers`` is how many DDS knows of.

        To be asked once there is one, again and again until it is true.
        """
        with self._lock:
            living = self._living()
            if not living:  # dead, or of a kind that gives no signs of life
                if self._waits_since is None:
                    self._waits_since = self._beats
                return not self._signs and self._beats >= self._waits_since + MUTE_BEATS
            return servers == len(living) or all(
                self._signs[identity] >= FOUND_SIGNS for identity in living
            )

    def are_gone(self, those: frozenset[str]) -> bool:
        """Whether none of ``those``, who lived when it was asked, will answer any more.

        Of nobody (no sign of life had been heard), as soon as somebody lives.
        """
        with self._lock:
            others = bool(self._living() - those)
            if not those:
                return others
            silence = min(self._silence.get(item, _FORGOTTEN_BEATS) for item in those)
            return silence >= (REPLACED_BEATS if others else GONE_BEATS)

    def _living(self) -> frozenset[str]:
        return frozenset(key for key, beats in self._silence.items() if beats <= LIVING_BEATS)


class Neighbour(Sightings):
    """Listens to the signs of life of one role in the namespace of a node."""

    def __init__(self, node: Node, role: str) -> None:
        """The node gets a subscription and a timer, in its default callback group."""
        super().__init__()
        self._role = role
        node.create_subscription(DiagnosticArray, "diagnostics", self._on_diagnostics, RELIABLE)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(BEAT_SECONDS, self.beat, clock=steady)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == self._role and status.hardware_id:
                self.hear(status.hardware_id)
