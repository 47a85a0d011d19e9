# SPDX-License-Identifier: Apache-2.0
"""Brings together the frames that cameras took at the same time; one that is silent is left out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .frame_pairing import FramePairing, StampedSet

#: A camera is silent if no frame of it came for so long [s], and so many of another one did.
SILENCE: Final = 2.0
FRAMES: Final = 5


class Moments:
    """Hands out the frames of one moment, one of each camera that is not silent, the newest only.

    Args:
        names: of the cameras, the first one first.
        tolerance: by which their stamps may differ [ns].
        now: on any monotonic clock [s].
    """

    def __init__(self, names: Sequence[str], tolerance: int, now: float) -> None:
        self._names, self._tolerance = tuple(names), tolerance
        self._last = dict.fromkeys(names, now)
        self._missed = dict.fromkeys(names, 0)
        self._heard = self._names
        self._pairing = FramePairing(self._heard, tolerance)
        self._since: float | None = None

    def add(self, name: str, frame: StampedSet, now: float) -> dict[str, StampedSet] | None:
        """Takes a frame in; returns those of the moment that it completes, the first camera first.

        Args:
            name: of the camera.
            now: when it arrived [s].
        """
        self._missed = {other: count + 1 for other, count in self._missed.items()}
        self._missed[name], self._last[name] = 0, now
        heard = tuple(other for other in self._names if not self._is_silent(other, now))
        if heard != self._heard:
            self._heard, self._pairing = heard, FramePairing(heard, self._tolerance)
        moment = self._pairing.add(name, frame.stamp, frame, now)
        if moment is None:
            self._since = self._since or now
            return None
        self._since = None
        return {other: moment.messages[other] for other in heard}

    def note(self) -> str:
        """A sentence about the cameras that are silent; empty where none is."""
        silent = [name for name in self._names if name not in self._heard]
        if not silent:
            return ""
        return f"no picture of {' and '.join(silent)} comes, so the others are looked at alone"

    def problem(self, now: float) -> str:
        """A sentence where frames come that make no moment, once in a while [s]."""
        if self._since is None or now - self._since < 2.0 * SILENCE:
            return ""
        self._since = now
        return self._pairing.problem({name: f"frame of {name}" for name in self._heard})

    def _is_silent(self, name: str, now: float) -> bool:
        return self._missed[name] >= FRAMES and now - self._last[name] > SILENCE
