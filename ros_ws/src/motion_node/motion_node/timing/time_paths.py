# SPDX-License-Identifier: Apache-2.0
"""Paths to trajectories: times within the velocity and acceleration limits.

A phase begins and ends at rest, so each phase is timed on its own, all of them at once. A
controller's cubic Hermite interpolation between the points keeps the limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..phases import HOME, PICK, PLACE, Phase, PhasePath
from ..robots.joints import JointValues
from .fastest import TimeGrid, Way, fastest, fastest_from
from .limits import JointLimits
from .trajectory import Interval, Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TimingSettings:
    """How fast.

    Attributes:
        velocity_scale, acceleration_scale: shares of the joints' limits that may be used.
        close_seconds, open_seconds: standing still at least, while the fingers close on a block or
            let go of it [s].
        finger_speed: most of each finger joint [m/s].
        finger_room: between each finger and a block when the hand arrives at it or leaves it; what
            fingers open farther they open and close on the way [m].
        point_seconds: longest time between points while the arm stands still [s].
        grid: how finely the arm's ways are timed.
    """

    velocity_scale: float = 0.9
    acceleration_scale: float = 0.7
    close_seconds: float = 0.15
    open_seconds: float = 0.15
    finger_speed: float = 0.1
    finger_room: float = 0.005
    point_seconds: float = 0.02
    grid: TimeGrid = field(default_factory=TimeGrid)


class _Points:
    """Collects points of the arm and the fingers."""

    def __init__(self, settings: TimingSettings) -> None:
        self.settings = settings
        self.now = 0.0
        self.times: list[Array] = []
        self.positions: list[JointValues] = []
        self.velocities: list[JointValues] = []
        self.intervals: list[Interval] = []

    def travel(self, phase: Phase, way: Way, fingers: Array, wide: Array, end: Array) -> None:
        """The arm follows a path; the end point is left to what follows.

        Args:
            fingers, wide, end: where the fingers are at its beginning, on the way and at its end.
        """
        times, last = way.times[:-1, None], way.duration
        # They stop and start at points: in between a cubic would run beyond.
        opened = int(np.searchsorted(way.times, self.ramp(fingers, wide)))
        opening = float(way.times[min(opened, len(times))])
        closes = int(np.searchsorted(way.times, last - self.ramp(wide, end), side="right")) - 1
        closing = last - float(way.times[max(closes, 0)])
        wider, widening = _smooth(times / opening)
        nearer, nearing = _smooth((times - last + closing) / closing)
        positions = fingers + (wide - fingers) * wider + (end - wide) * nearer
        rate = (wide - fingers) * widening / opening + (end - wide) * nearing / closing
        self._add(way.times[:-1], way.positions[:-1], way.velocities[:-1], positions, rate)
        self._close(phase, last, gripping=False)

    def grip(self, phase: Phase, q: Array, fingers: Array, target: Array, seconds: float) -> None:
        """The arm stands still while the fingers go to a target at their speed, smoothly."""
        ramp = self.ramp(fingers, target)
        count = max(2, int(np.ceil(ramp / self.settings.point_seconds)))
        u = np.arange(count + 1)[:, None] / count
        share, rate = _smooth(u)
        arm = np.tile(q, (count + 1, 1))
        moving = fingers + (target - fingers) * share
        self._add(u[:, 0] * ramp, arm, np.zeros_like(arm), moving, (target - fingers) * rate / ramp)
        self._close(phase, max(seconds, ramp / 0.95), gripping=True)

    def ramp(self, fingers: Array, target: Array) -> float:
        """How long fingers take from one position to another [s]."""
        return max(1.5 * float(np.abs(target - fingers).max()) / self.settings.finger_speed, 0.1)

    def _add(self, times: Array, arm: Array, speed: Array, fingers: Array, rate: Array) -> None:
        self.times.append(self.now + times)
        self.positions.append(JointValues(arm, fingers))
        self.velocities.append(JointValues(speed, rate))

    def _close(self, phase: Phase, seconds: float, gripping: bool) -> None:
        self.intervals.append(Interval(self.now, self.now + seconds, phase, gripping))
        self.now += seconds

    def finish(self, q: Array, fingers: Array) -> Trajectory:
        """The trajectory, ending at rest there."""
        self._add(np.zeros(1), q[None], np.zeros((1, len(q))), fingers[None], np.zeros((1, 2)))
        return Trajectory(
            np.concatenate(self.times),
            _joined(self.positions),
            _joined(self.velocities),
            tuple(self.intervals),
        )


def _smooth(share: Array) -> tuple[Array, Array]:
    """From 0 to 1, at rest at both ends, and its derivative."""
    u = np.clip(share, 0.0, 1.0)
    return (3 - 2 * u) * u**2, 6 * u * (1 - u)


def _joined(parts: Sequence[JointValues]) -> JointValues:
    return JointValues(
        np.concatenate([part.arm for part in parts]),
        np.concatenate([part.fingers for part in parts]),
    )


def time_paths(
    paths: Sequence[PhasePath],
    limits: JointLimits,
    settings: TimingSettings,
    fingers: Array,
    open_first: float | None = None,
    moving: Array | None = None,
) -> Trajectory:
    """The trajectory through solved phases, with the fingers' closing and opening at the switches.

    The arm stands still for what happens at a block only: fingers open fully as the hand leaves,
    and come near the next block as it arrives there. They press fully while a block is carried,
    and half as far at its switches.

    Args:
        paths: all of as many steps.
        fingers: positions of the two finger joints at the start, shape (2,) [m].
        open_first: finger position to go to before the arm moves [m]; None: they stay.
        moving: with what velocity the arm sets out, shape (n,) [rad/s]; None: from rest.

    Raises:
        ValueError: if the first path cannot be gone with that velocity at its beginning.
    """
    scaled = JointLimits(
        settings.velocity_scale * limits.velocity,
        settings.acceleration_scale * limits.acceleration,
    )
    points = _Points(settings)
    now = np.array(fingers, dtype=float)
    first = paths[0]
    if open_first is not None and np.abs(now - open_first).max() > 1e-4:
        target = np.full(2, open_first)
        points.grip(first.phase, first.q[0], now, target, settings.open_seconds)
        now = target
    q = np.stack([path.q for path in paths])
    if moving is None:
        ways = fastest(q, scaled, settings.grid)
    else:
        ways = [fastest_from(q[0], moving, scaled, settings.grid)]
        ways += fastest(q[1:], scaled, settings.grid) if len(q) > 1 else []
    for index, (path, way) in enumerate(zip(paths, ways)):
        phase = path.phase
        wide = end = now if index == 0 and open_first is None else np.full(2, phase.tool.finger)
        if phase.kind == PICK:
            end = np.minimum(wide, _around(phase, settings))
        elif phase.kind == PLACE and index > 0:
            end = np.full(2, _lightly(phase, phase.tool.finger))
        if points.ramp(now, wide) + points.ramp(wide, end) > 0.9 * way.duration:
            end = wide
        points.travel(phase, way, now, wide, end)
        now = end
        if phase.kind == HOME:
            continue
        if phase.kind == PICK:
            target, seconds = np.full(2, _lightly(phase, phase.grip)), settings.close_seconds
        else:
            target, seconds = np.full(2, phase.grip), settings.open_seconds
            around = np.minimum(target, _around(phase, settings))
            if (
                index + 1 < len(ways)
                and points.ramp(around, target) < 0.9 * ways[index + 1].duration
            ):
                target = around
        points.grip(phase, path.q[-1], now, target, seconds)
        now = target
    return points.finish(paths[-1].q[-1], now)


def _lightly(phase: Phase, pressing: float) -> float:
    """Where each finger is sent half as far into a block as when it is carried [m]."""
    assert phase.grasp is not None
    return (phase.grasp.width / 2 + pressing) / 2


def _around(phase: Phase, settings: TimingSettings) -> float:
    """Where each finger stands beside the block of a phase without touching it [m]."""
    assert phase.grasp is not None
    return phase.grasp.width / 2 + settings.finger_room
