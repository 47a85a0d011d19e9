# SPDX-License-Identifier: Apache-2.0
"""Brings together the images that were taken at the same time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

#: Incomplete sets that are kept waiting; more arrive only if a stream is broken.
_WAITING: Final = 8


@dataclass(frozen=True)
class StampedSet:
    """One message of each stream, all of one time.

    Attributes:
        stamp: time of acquisition [ns].
        arrival: when the first of them arrived, on the clock of the caller [s].
        messages: by stream.
    """

    stamp: int
    arrival: float
    messages: dict[str, Any]


class FramePairing:
    """Collects messages by stamp; hands out each complete set once, the newest only."""

    def __init__(self, streams: Sequence[str]) -> None:
        self._streams = frozenset(streams)
        self._waiting: dict[int, tuple[float, dict[str, Any]]] = {}
        self._newest = -(2**63)

    def add(self, stream: str, stamp: int, message: Any, arrival: float) -> StampedSet | None:
        """Takes a message in; returns the set that it completes, if it is newer than the last one.

        A message whose stamp goes back by more than the sets that can be waiting, as after a
        restart of the camera's clock, starts everything anew.

        Args:
            stamp: time of acquisition [ns].
            arrival: now, on any monotonic clock [s].
        """
        if stamp <= self._newest:
            if self._newest - stamp < 5_000_000_000:
                return None
            self._waiting.clear()
            self._newest = -(2**63)
        first, messages = self._waiting.setdefault(stamp, (arrival, {}))
        messages[stream] = message
        if messages.keys() != self._streams:
            while len(self._waiting) > _WAITING:
                del self._waiting[min(self._waiting)]
            return None
        self._newest = stamp
        self._waiting = {key: kept for key, kept in self._waiting.items() if key > stamp}
        return StampedSet(stamp, first, messages)

    def missing(self) -> tuple[str, ...]:
        """Streams that the waiting sets lack, sorted; empty if none is waiting.

        What all of them lack, as the newest may just be on its way; if there is no such stream,
        what the newest lacks.
        """
        if not self._waiting:
            return ()
        lacking = {
            stamp: self._streams.difference(messages)
            for stamp, (_, messages) in self._waiting.items()
        }
        always = frozenset.intersection(*lacking.values())
        return tuple(sorted(always or lacking[max(lacking)]))
