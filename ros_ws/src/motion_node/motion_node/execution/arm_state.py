# SPDX-License-Identifier: Apache-2.0
"""The newest state of the arm's joints, handed from the thread that hears it to those that wait."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from ..robots.joints import JointValues

#: Joints that move by less than this between two looks rest [rad or m].
REST_TOLERANCE = 2e-3


@dataclass(frozen=True)
class ArmState:
    """Joint positions at one moment.

    Attributes:
        stamp: time of the measurement by the clock of the arm's driver [s].
        received: time of its arrival by this machine's clock, :meth:`ArmStates.now` [s].
        positions: of shapes (n,) and (2,) [rad, m].
        resting: for how long no joint has moved, by the driver's clock [s].
    """

    stamp: float
    received: float
    positions: JointValues
    resting: float


class ArmStates(Protocol):
    """Where the states of an arm can be had."""

    def now(self) -> float:
        """This machine's time, which never goes back [s]."""

    def newest(self) -> ArmState | None:
        """The newest state, however old; None if there has been none."""

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        """The first state that differs from ``after``, or None after ``timeout`` seconds."""


class ArmStateBox:
    """Keeps the newest state; any thread may put, any may wait.

    Args:
        clock: gives :meth:`now`.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._changed = threading.Condition()
        self._newest: ArmState | None = None
        self._rest_positions: JointValues | None = None
        self._rest_since = 0.0

    def now(self) -> float:
        """See :class:`ArmStates`."""
        return self._clock()

    def put(self, stamp: float, positions: JointValues) -> None:
        """A new measurement; see :class:`ArmState`."""
        with self._changed:
            anchor = self._rest_positions
            backwards = self._newest is not None and stamp < self._newest.stamp
            moved = anchor is None or max(positions.furthest(anchor)) > REST_TOLERANCE
            if moved or backwards:
                self._rest_positions, self._rest_since = positions, stamp
            resting = stamp - self._rest_since
            self._newest = ArmState(stamp, self.now(), positions, resting)
            self._changed.notify_all()

    def newest(self) -> ArmState | None:
        """See :class:`ArmStates`."""
        with self._changed:
            return self._newest

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        """See :class:`ArmStates`."""
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not after, timeout)
            return None if self._newest is after else self._newest
