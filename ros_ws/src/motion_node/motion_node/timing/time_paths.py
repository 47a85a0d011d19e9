# SPDX-License-Identifier: Apache-2.0
"""Paths to trajectories: times within the velocity and acceleration limits.

A phase begins and ends at rest, so each phase is timed on its own, all of them at once. A
controller's cubic Hermite interpolation between the points keeps the limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..phases import HOME, Phase, PhasePath
from ..robots.joints import JointValues
from .fastest import JointLimits, fastest
from .trajectory import Interval, Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TimingSettings:
    """How fast.

    Attributes:
        velocity_scale, acceleration_scale: shares of the joints' limits that may be used.
        close_seconds, open_seconds: standing still while the fingers close or open [s].
        finger_speed: of each finger joint [m/s].
        parts: points of the trajectory for each step of a path.
        point_seconds: longest time between points while the fingers move [s].
    """

    velocity_scale: float = 0.9
    acceleration_scale: float = 0.7
    close_seconds: float = 0.5
    open_seconds: float = 0.4
    finger_speed: float = 0.1
    parts: int = 6
    point_seconds: float = 0.02


class _Points:
    """Collects points of the arm and the fingers."""

    def __init__(self, settings: TimingSettings) -> None:
        self.settings = settings
        self.now = 0.0
        self.times: list[Array] = []
        self.positions: list[JointValues] = []
        self.velocities: list[JointValues] = []
        self.intervals: list[Interval] = []

    def travel(self, phase: Phase, times: Array, arm: Array, speed: Array, fingers: Array) -> None:
        """The arm follows a path, the fingers stay; the end point is left to what follows."""
        self._add(times[:-1], arm[:-1], speed[:-1], fingers)
        self._close(phase, float(times[-1]), gripping=False)

    def grip(self, phase: Phase, q: Array, fingers: Array, target: Array, seconds: float) -> None:
        """The arm stands still while the fingers go to a target at their speed, smoothly."""
        distance = float(np.abs(target - fingers).max())
        ramp = min(max(1.5 * distance / self.settings.finger_speed, 0.1), seconds * 0.95)
        count = max(2, int(np.ceil(ramp / self.settings.point_seconds)))
        u = np.arange(count + 1)[:, None] / count
        moving = fingers + (target - fingers) * (3 - 2 * u) * u**2
        rate = (target - fingers) * 6 * u * (1 - u) / ramp
        arm = np.tile(q, (count + 1, 1))
        self._add(u[:, 0] * ramp, arm, np.zeros_like(arm), moving, rate)
        self._close(phase, seconds, gripping=True)

    def _add(
        self, times: Array, arm: Array, speed: Array, fingers: Array, rate: Array | None = None
    ) -> None:
        shape = (len(times), 2)
        self.times.append(self.now + times)
        self.positions.append(JointValues(arm, np.broadcast_to(fingers, shape)))
        self.velocities.append(JointValues(speed, np.zeros(shape) if rate is None else rate))

    def _close(self, phase: Phase, seconds: float, gripping: bool) -> None:
        self.intervals.append(Interval(self.now, self.now + seconds, phase, gripping))
        self.now += seconds

    def finish(self, q: Array, fingers: Array) -> Trajectory:
        """The trajectory, ending at rest there."""
        self._add(np.zeros(1), q[None], np.zeros((1, len(q))), fingers)
        return Trajectory(
            np.concatenate(self.times),
            _joined(self.positions),
            _joined(self.velocities),
            tuple(self.intervals),
        )


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
) -> Trajectory:
    """The trajectory through solved phases, with the fingers' closing and opening at the switches.

    Args:
        paths: all of as many steps.
        fingers: positions of the two finger joints at the start, shape (2,) [m].
        open_first: finger position to go to before the arm moves [m]; None: they stay.
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
    timed = fastest(np.stack([path.q for path in paths]), scaled, settings.parts)
    for path, times, arm, speed in zip(paths, timed.times, timed.positions, timed.velocities):
        points.travel(path.phase, times, arm, speed, now)
        if path.phase.kind != HOME:
            target = np.full(2, path.phase.grip)
            closing = float(target[0]) < float(now[0])
            seconds = settings.close_seconds if closing else settings.open_seconds
            points.grip(path.phase, path.q[-1], now, target, seconds)
            now = target
    return points.finish(paths[-1].q[-1], now)
