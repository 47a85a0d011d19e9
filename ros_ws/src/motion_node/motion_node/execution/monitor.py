# SPDX-License-Identifier: Apache-2.0
"""Watches from joint states how far a trajectory has been carried out, and whether all is well.

When the arm begins is not known exactly: the trajectory travels, and a simulation may run faster
or slower than this clock. So the trajectory's time is found from the arm itself: it starts when the
arm leaves its first position, and follows where the arm is on the path, near where it should be.
Only differences of the joint states' own stamps count; the speed of a simulation does not matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from ..phases import PICK, PLACE, Phase
from ..robots.joints import JointValues
from ..timing.trajectory import Interval, Trajectory
from .arm_state import ArmState
from .lasting import Lasting

Array = NDArray[np.float64]


class Verdict(Enum):
    """What the joint states say."""

    GOING = auto()
    ARRIVED = auto()
    NOT_STARTED = auto()
    UNSEEN = auto()
    OFF_THE_PATH = auto()
    BEHIND = auto()
    NOT_ARRIVED = auto()
    GRASP_LOST = auto()
    NOT_CLOSED = auto()
    NOT_OPENED = auto()
    CLOCK_WENT_BACK = auto()
    ARM_OUT_OF_STEP = auto()
    FINGERS_TOO_WIDE = auto()
    FINGERS_TOO_NARROW = auto()


@dataclass(frozen=True)
class MonitorSettings:
    """Tolerances of the execution; times by the joint states' stamps unless said otherwise.

    Attributes:
        tracking_tolerance: largest deviation of an arm joint from the path [rad].
        tracking_seconds: for how long it may be exceeded [s].
        max_lag: how far the arm may be behind the trajectory [s].
        start_seconds: within which the arm has to start, in wall time and by stamps [s]; a
            trajectory that comes later than that may meet another one.
        goal_tolerance: deviation of every arm joint at the end [rad].
        settle_seconds: within which the end is to be reached after the trajectory's end [s].
        grasp_tolerance: a finger this near to where it was sent holds nothing [m].
        grasp_seconds: for how long the fingers must say so [s].
        close_seconds: for how long they must stand wider than what they are to hold [s]; short, as
            open fingers are carried down beside the next blocks.
        open_seconds: for how long they must stand narrower than they should [s].
    """

    tracking_tolerance: float = 0.15
    tracking_seconds: float = 0.3
    max_lag: float = 2.0
    start_seconds: float = 8.0
    goal_tolerance: float = 0.02
    settle_seconds: float = 3.0
    grasp_tolerance: float = 0.002
    grasp_seconds: float = 0.1
    close_seconds: float = 0.15
    open_seconds: float = 0.3


@dataclass(frozen=True)
class _Travel:
    """A stretch on which the arm moves, and how far its fingers should be apart.

    Attributes:
        ends: where it begins and ends, shape (2, n) [rad].
        block: the phase whose block the fingers hold, or have just let go; None: neither.
        middle: half way between the block's half width and fully open fingers [m].
        opens: whether the fingers open on it to go around the block that is picked next.
    """

    ends: Array
    block: Phase | None
    middle: float
    opens: bool


def _travels(trajectory: Trajectory) -> dict[Interval, _Travel]:
    """Of the stretches of a trajectory on which the arm moves."""
    result: dict[Interval, _Travel] = {}
    placed: Phase | None = None
    for interval in trajectory.intervals:
        phase = interval.phase
        if interval.gripping:
            placed = phase if phase.kind == PLACE else None
            continue
        block = phase if phase.kind == PLACE and interval.holding else placed
        middle = 0.0
        if block is not None and block.grasp is not None:
            middle = (block.grasp.width / 2 + block.grip) / 2
        ends = trajectory.sample(np.array([interval.start, interval.end]))[0].arm
        result[interval] = _Travel(ends, block if middle else None, middle, phase.kind == PICK)
    return result


class Monitor:
    """Follows one trajectory.

    Args:
        state: the arm when the trajectory was sent.
    """

    #: Deviations by which the arm or a finger shows that it has started [rad, m].
    STARTED = 0.01
    STARTED_FINGER = 0.001
    #: How much a second away from the expected time counts against a deviation [rad/s].
    TIME_WEIGHT = 0.03
    #: How much a finger counts that is elsewhere, where the arm set out unseen [rad/m].
    FINGER_WEIGHT = 10.0
    #: An arm that was not heard of for longer than this as it set out may be anywhere by now [s].
    UNSEEN = 0.3
    #: Spacing of the times at which the arm is looked for when it has started [s].
    STEP = 0.02
    #: An arm this far from both ends of a stretch is on its way for certain [rad].
    ON_ITS_WAY = 0.05
    #: An opening finger this far behind where it was sent does not open [m].
    BEHIND_FINGER = 0.01

    def __init__(self, trajectory: Trajectory, state: ArmState, settings: MonitorSettings) -> None:
        self.trajectory, self.settings = trajectory, settings
        self.time = 0.0
        self.lag = 0.0
        self._sent = self._last = state
        self._anchor, self._leapt = state.stamp, False
        self._stood, self._unseen = state.stamp, False
        arm, fingers = trajectory.positions.furthest(trajectory.positions[0])
        # One that goes nowhere cannot be seen to start.
        self._started = bool(
            arm.max() <= 2 * self.STARTED and fingers.max() < 2 * self.STARTED_FINGER
        )
        self._off = Lasting(settings.tracking_seconds)
        self._empty = Lasting(settings.grasp_seconds)
        self._not_closed = Lasting(settings.close_seconds)
        self._not_opened = Lasting(settings.open_seconds)
        self._travels = _travels(trajectory)
        # Where each interval ends, and where the block that it is about stops closing fingers.
        self._ends = np.array([interval.end for interval in trajectory.intervals])
        grasps = [interval.phase.grasp for interval in trajectory.intervals]
        self._half_widths = np.array([grasp.width / 2 if grasp else 0.0 for grasp in grasps])

    @property
    def block(self) -> Phase | None:
        """The place phase of the block that the fingers hold now, or have just let go."""
        travel = self._travels.get(self.trajectory.interval_at(self.time))
        return travel.block if travel else None

    @property
    def started(self) -> bool:
        """Whether the arm has been seen to move along."""
        return self._started

    def update(self, state: ArmState) -> Verdict:
        """Takes in a new state; ``time`` is the trajectory's time afterwards [s]."""
        previous, self._last = self._last, state
        if state.stamp < previous.stamp - 0.1:
            return Verdict.CLOCK_WENT_BACK
        if not self._started and not self._starts(state, previous):
            late = (
                state.received - self._sent.received > self.settings.start_seconds
                and state.stamp - self._sent.stamp > self.settings.start_seconds
            )
            # In a leap of the stamps the arm may have gone and come back.
            self._leapt |= state.stamp - previous.stamp > self.settings.start_seconds / 2
            if not late:
                return Verdict.GOING
            return Verdict.UNSEEN if self._leapt else Verdict.NOT_STARTED
        error = self._locate(state, max(0.0, state.stamp - previous.stamp))
        elapsed = state.stamp - self._anchor
        self.lag = max(0.0, min(elapsed, self.trajectory.duration) - self.time)
        if self._off.lasts(error > self.settings.tracking_tolerance, state.stamp):
            return Verdict.OFF_THE_PATH
        if self._empty.lasts(self._is_empty(state), state.stamp):
            return Verdict.GRASP_LOST
        wrong = self._fingers_elsewhere(state)
        if self._not_closed.lasts(wrong is Verdict.NOT_CLOSED, state.stamp):
            return Verdict.NOT_CLOSED
        if self._not_opened.lasts(wrong is Verdict.NOT_OPENED, state.stamp):
            return Verdict.NOT_OPENED
        if self.lag > self.settings.max_lag:
            return Verdict.BEHIND
        over = elapsed - self.trajectory.duration
        if over >= 0.0:
            off, _ = state.positions.furthest(self.trajectory.positions[-1])
            if off <= self.settings.goal_tolerance:
                self.time = self.trajectory.duration
                return Verdict.ARRIVED
            if over > self.settings.settle_seconds:
                return Verdict.NOT_ARRIVED
        return Verdict.GOING

    def _starts(self, state: ArmState, previous: ArmState) -> bool:
        """Whether the arm or the fingers have left where they were, as in the state before."""
        self._started = bool(self._left(state.positions, self._sent.positions))
        if self._started:
            # The trajectory needed some time to come this far, and so did these news; look for it
            # from its beginning to where it can be at most.
            begun = self._left(self.trajectory.positions, self.trajectory.positions[0])
            first = float(self.trajectory.times[int(np.argmax(begun))])
            self._stood = previous.stamp - first
            self._unseen = state.stamp - previous.stamp > self.UNSEEN
            self._search(state, first)
        return self._started

    def _search(self, state: ArmState, earliest: float) -> float:
        """Finds the arm anywhere on the path that it can have come to; returns its deviation [rad].

        One that was not heard of has most likely set out at once. A hand goes down and up the same
        way: there the fingers tell.
        """
        latest = min(state.stamp - self._stood, self.trajectory.duration)
        times = np.append(earliest, np.arange(earliest, latest, self.STEP))
        error = self._match(state, times, latest if self._unseen else earliest)
        self._anchor = max(self._sent.stamp, state.stamp - self.time)
        return error

    def _left(self, positions: JointValues, start: JointValues) -> NDArray[np.bool_]:
        """Whether positions are away from where the arm started, shape (...,)."""
        arm, fingers = positions.furthest(start)
        return np.asarray((arm > self.STARTED) | (fingers > self.STARTED_FINGER))

    def _locate(self, state: ArmState, step: float) -> float:
        """Moves ``time`` to where the arm is on the path; returns its deviation there [rad]."""
        expected = self.time + step
        latest = state.stamp - self._anchor + 0.2
        low = max(0.0, self.time - 0.3)
        high = max(low, min(expected + 0.5, latest, self.trajectory.duration))
        count = max(41, int(np.ceil((high - low) / self.STEP)) + 1)
        times = np.append(np.linspace(low, high, count), np.clip(expected, low, high))
        before, anchor = self.time, self._anchor
        error = self._match(state, times, expected)
        if self._unseen and error > self.settings.tracking_tolerance:
            there = self.time
            if self._search(state, before) <= self.settings.tracking_tolerance:
                return 0.0
            self.time, self._anchor = there, anchor
        return error

    def _match(self, state: ArmState, times: Array, expected: float) -> float:
        """Sets ``time`` to that of ``times`` at which the path is nearest; see ``_locate``."""
        positions, _ = self.trajectory.sample(times)
        errors, _ = positions.furthest(state.positions)
        away = self.TIME_WEIGHT * np.abs(times - expected)
        if self._unseen:
            asked = np.mean(positions.fingers, axis=1)
            at = np.minimum(np.searchsorted(self._ends, times), len(self._ends) - 1)
            stopped = self._half_widths[at]
            seen = float(np.mean(state.positions.fingers))
            away += self.FINGER_WEIGHT * np.abs(np.maximum(asked, stopped) - seen)
        best = int(np.argmin(errors + away))
        self.time = float(times[best])
        return float(errors[best])

    def _is_empty(self, state: ArmState) -> bool:
        """Whether the fingers have closed as far as they were sent, though a block is held."""
        interval = self.trajectory.interval_at(self.time)
        if not interval.holding or interval.gripping or self.time < interval.start + 0.05:
            return False
        fingers = float(np.mean(state.positions.fingers))
        return fingers <= interval.phase.tool.finger + self.settings.grasp_tolerance

    def _fingers_elsewhere(self, state: ArmState) -> Verdict:
        """NOT_CLOSED or NOT_OPENED if the fingers are nearer to where they were; else GOING.

        Only while the arm is on its way for certain: at the ends of a stretch, where it stands
        still, the time is a guess, and the fingers may be moving.
        """
        interval = self.trajectory.interval_at(self.time)
        travel = self._travels.get(interval)
        if travel is None or not (travel.block or travel.opens):
            return Verdict.GOING
        if np.abs(travel.ends - state.positions.arm).max(axis=1).min() < self.ON_ITS_WAY:
            return Verdict.GOING
        fingers = float(np.mean(state.positions.fingers))
        if travel.block is None:
            asked = float(np.mean(self.trajectory.sample(self.time)[0].fingers))
            return Verdict.NOT_OPENED if fingers < asked - self.BEHIND_FINGER else Verdict.GOING
        if interval.holding:
            return Verdict.NOT_CLOSED if fingers > travel.middle else Verdict.GOING
        return Verdict.NOT_OPENED if fingers < travel.middle else Verdict.GOING
