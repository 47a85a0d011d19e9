# SPDX-License-Identifier: Apache-2.0
"""ros2_control's joint_trajectory_controller at its defaults, read from its C++ source (Jazzy).

``validate_trajectory_msg``, ``Trajectory::update`` and ``Trajectory::sample``, for messages with
positions and velocities; shares no code with the simulator's controllers.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

FLOAT_EPSILON = 1.1920929e-07


def seconds(value: Any) -> float:
    return float(value.sec + 1e-9 * value.nanosec)


class StockOracle:
    """One controller; whoever has it says what time it is, and where the joints are.

    Attributes:
        state: positions of its joints, and velocities, as the hardware reports them.
        refusals: why messages were refused.
    """

    def __init__(self, joints: tuple[str, ...], state: list[float]) -> None:
        self.joints, self.state, self.speed = joints, list(state), [0.0] * len(state)
        self.refusals: list[str] = []
        self._message: Any = None
        self._held = list(state)
        self._start = self._before_time = 0.0
        self._before: tuple[list[float], list[float]] = ([], [])

    def hear(self, message: Any, now: float) -> bool:
        """A message on its topic; whether it is taken."""
        if refusal := self._refusal(message, now):
            self.refusals.append(refusal)
            return False
        stamp = seconds(message.header.stamp)
        self._message, self._start = message, stamp if stamp != 0.0 else now
        self._before_time, self._before = now, (list(self.state), list(self.speed))
        return True

    def stand(self) -> None:
        """It is stopped from outside, and holds where it is."""
        self._message, self._held = None, list(self.state)

    def sample(self, now: float) -> list[float]:
        """The command for its joints."""
        if self._message is None:
            return self._held
        message = self._message
        order = [list(message.joint_names).index(name) for name in self.joints]
        knots = [
            (
                self._start + seconds(point.time_from_start),
                [point.positions[index] for index in order],
                [point.velocities[index] for index in order],
            )
            for point in message.points
        ]
        if now < knots[0][0]:
            return _between((self._before_time, *self._before), knots[0], now)
        for first, second in pairwise(knots):
            if first[0] <= now < second[0]:
                return _between(first, second, now)
        return knots[-1][1]

    def _refusal(self, message: Any, now: float) -> str:
        names, points = list(message.joint_names), list(message.points)
        if len(names) != len(self.joints):
            return "joints don't match"
        if not points:
            return "empty"
        if any(name not in self.joints for name in names):
            return "unknown joint"
        if any(abs(value) > FLOAT_EPSILON for value in points[-1].velocities):
            return "moves at its end"
        stamp, end = seconds(message.header.stamp), seconds(points[-1].time_from_start)
        if stamp != 0.0 and stamp + end < now:
            return "ends in the past"
        times = [seconds(point.time_from_start) for point in points]
        if any(later <= earlier for earlier, later in pairwise(times)):
            return "not increasing"
        for point in points:
            if len(point.positions) != len(names):
                return "positions"
            if point.velocities and len(point.velocities) != len(names):
                return "velocities"
        return ""


def _between(first: Any, second: Any, now: float) -> list[float]:
    """The cubic that has both points' positions and velocities, by its coefficients."""
    (t0, p0, v0), (t1, p1, v1) = first, second
    span, t = t1 - t0, now - t0
    result = []
    for a, b, u, w in zip(p0, p1, v0, v1):
        square = (-3 * a + 3 * b - 2 * u * span - w * span) / span**2
        cube = (2 * a - 2 * b + u * span + w * span) / span**3
        result.append(a + u * t + square * t**2 + cube * t**3)
    return result
