# SPDX-License-Identifier: Apache-2.0
"""How the arm's joints were when a picture was taken, if they rested then."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Final

#: Joints that moved by less rested: the furthest part of an arm moved by a centimetre [rad, m].
STILL: Final = 0.01
#: For so long before and after a picture, as the clocks of arm and camera may be apart [ns].
AROUND: Final = 250_000_000
#: How the joints are is told at least so often, or nothing is known [ns].
_NEAR: Final = 150_000_000
#: Joint states are kept so far apart, whatever their rate, and so many of them [ns].
_APART: Final = 15_000_000
_KEPT: Final = 400


class JointHistory:
    """The newest joint states. One thread may add to them while others ask."""

    def __init__(self) -> None:
        self._states: deque[tuple[int, dict[str, float]]] = deque(maxlen=_KEPT)
        self._changing = threading.Lock()

    def add(self, stamp: int, names: Sequence[str], positions: Sequence[float]) -> None:
        """Adds a state; those that are told too often, or without a stamp, are passed over.

        Args:
            stamp: when the joints were so [ns].
            names, positions: of the joints [rad, m].
        """
        with self._changing:
            if self._states and stamp < self._states[-1][0]:
                self._states.clear()  # the clock went back: another life of the arm
            if stamp and (not self._states or stamp - self._states[-1][0] >= _APART):
                self._states.append((stamp, dict(zip(names, positions))))

    def at_rest(self, stamp: int) -> Mapping[str, float] | None:
        """Positions of the joints by their names [rad, m]; None where they moved, or nobody knows.

        Args:
            stamp: of the picture [ns].
        """
        with self._changing:
            around = []
            for state in reversed(self._states):
                if state[0] < stamp - AROUND:
                    break
                if state[0] <= stamp + AROUND:
                    around.append(state)
        if not around:
            return None
        nearest, positions = min(around, key=lambda state: abs(state[0] - stamp))
        if abs(nearest - stamp) > _NEAR:
            return None
        for _, other in around:
            if other.keys() != positions.keys():
                return None
            if any(abs(other[name] - value) > STILL for name, value in positions.items()):
                return None
        return positions
