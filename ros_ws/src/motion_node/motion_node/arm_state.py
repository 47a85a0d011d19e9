# SPDX-License-Identifier: Apache-2.0
"""The newest state of the arm's joints, handed from the thread that hears it to those that wait."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Joints that move by less than this between two looks rest [rad or m].
REST_TOLERANCE = 2e-3


@dataclass(frozen=True)
class ArmState:
    """Joint positions at one moment.

    Attributes:
        stamp: time of the measurement by the clock of the arm's driver [s].
        received: time.monotonic() of its arrival [s].
        positions: of the arm's joints, then the two fingers, shape (n + 2,) [rad, m].
        resting: for how long no joint has moved, by the driver's clock [s].
    """

    stamp: float
    received: float
    positions: Array
    resting: float


class ArmStateBox:
    """Keeps the newest state; any thread may put, any may wait."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._newest: ArmState | None = None
        self._rest_positions: Array | None = None
        self._rest_since = 0.0

    def put(self, stamp: float, positions: Array) -> None:
        """A new measurement; see :class:`ArmState`."""
        with self._changed:
            anchor = self._rest_positions
            backwards = self._newest is not None and stamp < self._newest.stamp
            moved = anchor is None or bool(np.abs(positions - anchor).max() > REST_TOLERANCE)
            if moved or backwards:
                self._rest_positions, self._rest_since = positions, stamp
            resting = stamp - self._rest_since
            self._newest = ArmState(stamp, time.monotonic(), positions, resting)
            self._changed.notify_all()

    def newest(self) -> ArmState | None:
        """The newest state, however old; None if there has been none."""
        with self._changed:
            return self._newest

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        """The first state that differs from ``after``, or None after ``timeout`` seconds."""
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not after, timeout)
            return None if self._newest is after else self._newest
