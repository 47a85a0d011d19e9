# SPDX-License-Identifier: Apache-2.0
"""Brings together the images that were taken at the same time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

#: How long incomplete sets are kept, for a detector that takes its time over its labels [s], and
#: how many: more arrive only if a stream is broken.
PATIENCE: Final = 1.0
_WAITING: Final = 64
#: A stream of which so many times less came than of another one is silent; its last message may
#: have been one of a set that was lost otherwise.
_SILENT: Final = 8


@dataclass(frozen=True)
class StampedSet:
    """One message of each stream, all of one time.

    Attributes:
        stamp: time of acquisition, of the first that arrived [ns].
        arrival: when the first of them arrived, on the clock of the caller [s].
        messages: by stream.
    """

    stamp: int
    arrival: float
    messages: dict[str, Any]


@dataclass
class _Arrivals:
    """What came of one stream since the newest complete set."""

    count: int = 0
    advances: int = 0
    last: int = -(2**63)

    @property
    def stands_still(self) -> bool:
        """Whether its stamps do not grow: the first may be new, each of the others is to be."""
        return self.count >= 3 if self.advances == 1 else self.count > self.advances == 0


class FramePairing:
    """Collects messages by stamp; hands out each complete set once, the newest only.

    Args:
        streams: of which a set has one message each.
        tolerance: by which stamps of one set may differ; a message goes to the nearest set that
            still lacks it [ns].
    """

    def __init__(self, streams: Sequence[str], tolerance: int = 0) -> None:
        self._streams = frozenset(streams)
        self._tolerance = tolerance
        self._waiting: dict[int, tuple[float, dict[str, Any]]] = {}
        self._newest = -(2**63)
        self._since: dict[str, _Arrivals] = {stream: _Arrivals() for stream in streams}

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
                self._note(stream, stamp)
                return None
            self._waiting.clear()
            self._newest = -(2**63)
            self._since = {name: _Arrivals() for name in self._streams}
        self._note(stream, stamp)
        key = self._nearest(stream, stamp)
        first, messages = self._waiting.setdefault(key, (arrival, {}))
        messages[stream] = message
        if messages.keys() != self._streams:
            self._forget(arrival)
            return None
        self._newest = key
        self._since = {stream: _Arrivals(last=key) for stream in self._streams}
        self._waiting = {other: kept for other, kept in self._waiting.items() if other > key}
        return StampedSet(key, first, messages)

    def _nearest(self, stream: str, stamp: int) -> int:
        """The stamp of the set that a message belongs to."""
        if not self._tolerance:
            return stamp
        near = [
            key
            for key, (_, messages) in self._waiting.items()
            if abs(key - stamp) <= self._tolerance and stream not in messages
        ]
        return min(near, key=lambda key: abs(key - stamp), default=stamp)

    def _forget(self, now: float) -> None:
        """Sets that have waited for too long, and the oldest of too many."""
        # A stream that is late begins sets that are newer than others and have older stamps.
        kept = {
            stamp: waiting
            for stamp, waiting in self._waiting.items()
            if waiting[0] >= now - PATIENCE
        }
        self._waiting = {stamp: kept[stamp] for stamp in sorted(kept)[-_WAITING:]}

    def missing(self) -> tuple[str, ...]:
        """Streams that the waiting sets lack, sorted; empty if none is waiting.

        What all of them lack, as the newest may just be on its way; if there is no such stream,
        what the fullest of the newest lacks.
        """
        if not self._waiting:
            return ()
        lacking = {
            stamp: self._streams.difference(messages)
            for stamp, (_, messages) in self._waiting.items()
        }
        always = frozenset.intersection(*lacking.values())
        fullest = min(lacking, key=lambda stamp: (len(lacking[stamp]), -stamp))
        return tuple(sorted(always or lacking[fullest]))

    def problem(self, topics: Mapping[str, str]) -> str:
        """A sentence that says which streams keep sets from getting complete, and how.

        Args:
            topics: what a person calls each stream.
        """

        def named(streams: Iterable[str]) -> str:
            return ", ".join(topics[stream] for stream in sorted(streams))

        most = max(seen.count for seen in self._since.values())
        if silent := [n for n, seen in self._since.items() if seen.count * _SILENT <= most]:
            return f"no {named(silent)} arrives; is the camera's driver complete?"
        if still := [name for name, seen in self._since.items() if seen.stands_still]:
            return (
                f"the stamps of {named(still)} do not advance; every picture needs the time at "
                "which it was taken: check the camera's driver and its clock"
            )
        return (
            f"{named(self.missing() or self._streams)} arrives with other stamps than the other "
            f"images, or more than {PATIENCE:g} s after them; have the camera stamp what it takes "
            "at the same time alike, or set pairing_tolerance"
        )

    def _note(self, stream: str, stamp: int) -> None:
        seen = self._since[stream]
        seen.count += 1
        seen.advances += stamp > seen.last
        seen.last = max(seen.last, stamp)
