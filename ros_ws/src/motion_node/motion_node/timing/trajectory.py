# SPDX-License-Identifier: Apache-2.0
"""Trajectories of all joints: timed points, what happens when, braking and cutting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..phases import HOME, Phase
from ..robots.joints import JointValues

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Interval:
    """What a stretch of a trajectory does.

    Attributes:
        start, end: [s] since the trajectory's start.
        phase: the phase it belongs to.
        gripping: whether the arm stands still at the phase's switch while the fingers move.
    """

    start: float
    end: float
    phase: Phase
    gripping: bool

    @property
    def holding(self) -> bool:
        """Whether a block is held throughout the interval, the closing of the fingers left out."""
        return bool(self.phase.tool.held)


@dataclass(frozen=True)
class Trajectory:
    """Positions and velocities of all joints at growing times, cubic in between (Hermite).

    Attributes:
        times: shape (t,), from 0 [s].
        positions, velocities: of shapes (t, n) and (t, 2) [rad, m; per s].
        intervals: what happens when, in order, without gaps.
    """

    times: Array
    positions: JointValues
    velocities: JointValues
    intervals: tuple[Interval, ...]

    @property
    def duration(self) -> float:
        """Length in time [s]."""
        return float(self.times[-1])

    def sample(self, times: Array | float) -> tuple[JointValues, JointValues]:
        """Positions and velocities at times [s], clipped to its ends; leading axes are theirs."""
        at = np.clip(np.asarray(times, dtype=float), 0.0, self.duration)
        index = np.clip(np.searchsorted(self.times, at, side="right") - 1, 0, len(self.times) - 2)
        span = (self.times[index + 1] - self.times[index])[..., None]
        u = (at - self.times[index])[..., None] / span

        def cubic(values: Array, rates: Array) -> tuple[Array, Array]:
            p0, p1 = values[index], values[index + 1]
            v0, v1 = rates[index] * span, rates[index + 1] * span
            delta = p1 - p0
            position = p0 + u * (v0 + u * (3 * delta - 2 * v0 - v1 + u * (v0 + v1 - 2 * delta)))
            rate = v0 + u * (6 * delta - 4 * v0 - 2 * v1 + 3 * u * (v0 + v1 - 2 * delta))
            return position, rate / span

        arm, arm_rate = cubic(self.positions.arm, self.velocities.arm)
        fingers, finger_rate = cubic(self.positions.fingers, self.velocities.fingers)
        return JointValues(arm, fingers), JointValues(arm_rate, finger_rate)

    def interval_at(self, time: float) -> Interval:
        """The interval of a time [s], clipped to the trajectory's."""
        for interval in self.intervals:
            if time < interval.end:
                return interval
        return self.intervals[-1]

    def moves_done(self, time: float) -> int:
        """How many moves have been carried out at a time: their blocks have been let go."""
        interval = self.interval_at(time)
        if time >= self.duration and interval.phase.kind != HOME:
            return interval.phase.move + 1
        return interval.phase.move

    def cut(self, start: float, end: float) -> Trajectory:
        """The part between two times [s], starting at 0 again."""
        inside = self.times[(self.times > start + 1e-3) & (self.times < end - 1e-3)]
        times = np.concatenate([[start], inside, [end]])
        positions, velocities = self.sample(times)
        intervals = tuple(
            Interval(max(i.start - start, 0.0), min(i.end, end) - start, i.phase, i.gripping)
            for i in self.intervals
            if i.end > start and i.start < end
        )
        return Trajectory(times - start, positions, velocities, intervals)

    def back(self, start: float, end: float, step: float = 0.02) -> Trajectory:
        """From one time of it back to an earlier one, from rest to rest, at half its speed.

        The path is the same, which is known to be free: s(t) = start + (end - start) (3u² - 2u³),
        u = t / T, whose speed is three quarters of the path's at most with T = 2 |end - start|.
        """
        seconds = max(2.0 * abs(end - start), step)
        times = np.linspace(0.0, seconds, max(2, int(np.ceil(seconds / step))) + 1)
        u = times / seconds
        along = start + (end - start) * (3 - 2 * u) * u**2
        rate = ((end - start) / seconds * 6 * u * (1 - u))[:, None]
        positions, speeds = self.sample(along)
        velocities = JointValues(speeds.arm * rate, speeds.fingers * rate)
        interval = Interval(0.0, seconds, self.interval_at(min(start, end)).phase, False)
        return Trajectory(times, positions, velocities, (interval,))

    def brake(self, now: float, lead: float, seconds: float, step: float = 0.02) -> Trajectory:
        """Comes to rest along the same path, which is known to be free, shortly after a time.

        The path is followed ever more slowly, s(t) = start + t - t²/(2 seconds), but not beyond
        the next switch; the fingers stay as they are at its start. Where the fingers move while
        the arm stands still they end open: closing is undone, opening is completed, at the
        fingers' own speed.

        Args:
            now: how far the trajectory has come [s].
            lead: how far ahead of that the new one starts, to be there in time [s].
            seconds: how long the arm takes to come to rest [s].
        """
        interval = self.interval_at(now)
        start = min(now + lead, interval.end)
        if interval.gripping:
            ends = np.array([interval.start, interval.end])
            end = float(ends[np.argmax(self.sample(ends)[0].fingers.mean(axis=1))])
            seconds = max(abs(end - start), step)
        count = max(2, int(np.ceil(seconds / step)) + 1)
        times = np.linspace(0.0, seconds, count)
        if interval.gripping:
            along, rate = np.linspace(start, end, count), np.full(count, (end - start) / seconds)
        else:
            along = start + times - times**2 / (2 * seconds)
            rate = np.where(along <= interval.end, 1 - times / seconds, 0.0)
        positions, velocities = self.sample(np.minimum(along, interval.end))
        fingers, speeds = positions.fingers, velocities.fingers * rate[:, None]
        if not interval.gripping:
            fingers, speeds = np.tile(fingers[0], (count, 1)), np.zeros_like(fingers)
        return Trajectory(
            times,
            JointValues(positions.arm, fingers),
            JointValues(velocities.arm * rate[:, None], speeds),
            (Interval(0.0, seconds, interval.phase, interval.gripping),),
        )
