# SPDX-License-Identifier: Apache-2.0
"""The newest state of the arm's joints, handed from the thread that hears it to those that wait."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

from ..robots.joints import JointValues
from .clock_rate import ClockRate
from .lived_time import LivedTime
from .shaking import Shaking

#: Joints that move by less than this between two looks rest [rad or m].
REST_TOLERANCE = 2e-3
#: Whoever waits looks at the clock this often, so that it counts what is really waited [s].
_SLICE: Final = 0.2


@dataclass(frozen=True)
class ArmState:
    """Joint positions at one moment.

    Attributes:
        stamp: time of the measurement by the clock of the arm's driver [s].
        received: time of its arrival by this machine's clock, :meth:`ArmStates.now` [s].
        positions: of shapes (n,) and (2,) [rad, m].
        resting: for how long no joint has moved, by the driver's clock [s].
        stamped: whether the driver gave the stamp; otherwise it is the time of arrival.
        rate: seconds of the driver's clock a second of this machine's.
    """

    stamp: float
    received: float
    positions: JointValues
    resting: float
    stamped: bool = True
    rate: float = 1.0


class ArmStates(Protocol):
    """Where the states of an arm can be had."""

    @property
    def closed(self) -> bool:
        """Whether nobody shall wait any more: the node ends."""

    @property
    def problem(self) -> str:
        """What is wrong with the joint states that arrive and cannot be used; empty: nothing."""

    def now(self) -> float:
        """This process's time, which never goes back; see :class:`LivedTime` [s]."""

    def newest(self) -> ArmState | None:
        """The newest state, however old; None if there has been none."""

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        """The first state that differs from ``after``, or None after ``timeout`` seconds.

        None at once if ``closed``.
        """


class ArmStateBox:
    """Keeps the newest state; any thread may put, any may wait.

    Args:
        clock: gives :meth:`now`.
    """

    def __init__(self, clock: Callable[[], float] | None = None) -> None:
        self._clock = clock or LivedTime()
        self._changed = threading.Condition()
        self._newest: ArmState | None = None
        self._rest_positions: JointValues | None = None
        self._rest_since = 0.0
        self._shaking = Shaking()
        self._rate = ClockRate()
        self._problem = ""
        self._closed = False

    @property
    def closed(self) -> bool:
        """See :class:`ArmStates`."""
        return self._closed

    @property
    def problem(self) -> str:
        """See :class:`ArmStates`."""
        return self._problem

    def now(self) -> float:
        """See :class:`ArmStates`."""
        return self._clock()

    def put(self, stamp: float | None, positions: JointValues) -> None:
        """A new measurement; see :class:`ArmState`. Without a stamp, its arrival counts.

        One of joints that have only been shaking for a while is refused.
        """
        with self._changed:
            stamped = stamp is not None
            stamp = self.now() if stamp is None else stamp
            anchor = self._rest_positions
            backwards = self._newest is not None and stamp < self._newest.stamp
            moved = anchor is None or max(positions.furthest(anchor)) > REST_TOLERANCE
            if moved or backwards:
                self._rest_positions, self._rest_since = positions, stamp
            resting = stamp - self._rest_since
            if problem := self._shaking.problem(stamp, positions, resting):
                self._problem = problem
                return
            now = self.now()
            self._rate.hear(stamp, now)
            self._newest = ArmState(stamp, now, positions, resting, stamped, self._rate.value)
            self._problem = ""
            self._changed.notify_all()

    def refuse(self, problem: str) -> None:
        """Something arrived that is no measurement; ``problem`` says why."""
        self._problem = problem

    def close(self) -> None:
        """Wakes all who wait; nobody waits any more."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def newest(self) -> ArmState | None:
        """See :class:`ArmStates`."""
        with self._changed:
            return self._newest

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        """See :class:`ArmStates`."""
        end = self.now() + timeout
        with self._changed:
            while self._newest is after and not self._closed:
                left = end - self.now()
                if left <= 0.0:
                    break
                self._changed.wait(min(left, _SLICE))
            return None if self._newest is after or self._closed else self._newest
