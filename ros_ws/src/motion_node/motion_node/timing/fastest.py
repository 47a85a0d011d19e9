# SPDX-License-Identifier: Apache-2.0
"""The fastest way along paths within velocity and acceleration limits, without jumps of these."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from .limits import JointLimits
from .reachability import ROUNDING, fastest_squares
from .smoothing import smoothed

Array = NDArray[np.float64]

#: Keeps divisions finite.
_TINY: Final = 1e-9
#: An arm that moves no faster stands still [rad/s].
_STANDING: Final = 1e-4
#: Shares of the accelerations with which a way from a moving arm is tried.
_SHARES: Final = (0.98, 0.9, 0.8)


@dataclass(frozen=True)
class TimeGrid:
    """How finely ways are timed.

    Attributes:
        parts: grid intervals for each step of a path.
        seconds: between the points of a way [s].
        smooth_seconds: within which an acceleration goes from one limit to the other, so that jerk
            is at most twice the acceleration's limit by it [s].
    """

    parts: int = 10
    seconds: float = 0.005
    smooth_seconds: float = 0.015


@dataclass(frozen=True)
class Way:
    """A path in time, at rest at both ends; cubic in between (Hermite).

    Attributes:
        times: shape (points,), from 0 [s].
        positions, velocities: shape (points, n) [rad, rad/s].
    """

    times: Array
    positions: Array
    velocities: Array

    @property
    def duration(self) -> float:
        """From rest to rest [s]."""
        return float(self.times[-1])


def fastest(q: Array, limits: JointLimits, grid: TimeGrid) -> list[Way]:
    """The fastest timing of the clamped cubic splines through configurations.

    Args:
        q: shape (paths, steps + 1, n) [rad].
    """
    steps = q.shape[1] - 1
    step = 1.0 / (steps * grid.parts)
    first = q[:, :1]
    away, slopes, bends = (matrix @ (q - first) for matrix in _clamped_spline(steps, grid.parts))
    speeds = np.sqrt(fastest_squares(slopes, bends, limits, step))
    durations = 2.0 * step / (speeds[:, 1:] + speeds[:, :-1])
    times = np.concatenate([np.zeros((len(q), 1)), np.cumsum(durations, axis=1)], axis=1)
    velocities = slopes * speeds[:, :, None]
    return _ways(times, first + away, velocities, limits, grid)


@cache
def _clamped_spline(steps: int, parts: int) -> tuple[Array, Array, Array]:
    """What gives its positions and their first two derivatives at the grid points, of its knots.

    Each of shape (steps * parts + 1, steps + 1).
    """
    spline = CubicSpline(np.linspace(0.0, 1.0, steps + 1), np.eye(steps + 1), bc_type="clamped")
    points = np.linspace(0.0, 1.0, steps * parts + 1)
    return spline(points), spline(points, 1), spline(points, 2)


def fastest_from(q: Array, velocity: Array, limits: JointLimits, grid: TimeGrid) -> Way:
    """As :func:`fastest`, for one path at whose beginning the arm moves already.

    Args:
        q: shape (steps + 1, n) [rad].
        velocity: at the beginning, shape (n,) [rad/s].

    Raises:
        ValueError: if the limits do not allow to go on with this velocity.
    """
    steps, speed = len(q) - 1, float(np.linalg.norm(velocity))
    if speed < _STANDING:
        return fastest(q[None], limits, grid)[0]
    # What is smoothed comes half a window late.
    ahead = q.copy()
    ahead[0] += velocity * grid.smooth_seconds / 2
    rate = speed / max(float(np.linalg.norm(ahead[1] - ahead[0])) * steps, _TINY)
    ends = ((1, velocity / rate), (1, np.zeros_like(velocity)))
    spline = CubicSpline(np.linspace(0.0, 1.0, steps + 1), ahead, bc_type=ends)
    points = np.linspace(0.0, 1.0, steps * grid.parts + 1)
    positions, slopes, bends = (spline(points, order)[None] for order in range(3))
    failure: ValueError | None = None
    for share in _SHARES:
        less = JointLimits(limits.velocity, share * limits.acceleration)
        try:
            speeds = np.sqrt(fastest_squares(slopes, bends, less, points[1], rate**2))
            durations = 2.0 * points[1] / np.maximum(speeds[:, 1:] + speeds[:, :-1], _TINY)
            times = np.concatenate([np.zeros((1, 1)), np.cumsum(durations, axis=1)], axis=1)
            rates = slopes * speeds[:, :, None]
            return _ways(times, positions, rates, limits, grid, velocity)[0]
        except ValueError as error:
            failure = error
    assert failure is not None
    raise failure


def _ways(
    times: Array,
    positions: Array,
    velocities: Array,
    limits: JointLimits,
    grid: TimeGrid,
    velocity: Array | None = None,
) -> list[Way]:
    """Ways whose accelerations do not jump.

    Args:
        times, positions, velocities: of the ways, shapes (paths, points, ...).
        velocity: before their beginnings, shape (n,) [rad/s]; None: rest.

    Raises:
        ValueError: if a way would have to begin more slowly than with a given velocity.
    """
    window, ends = grid.smooth_seconds, times[:, -1]
    before = np.zeros(positions.shape[2]) if velocity is None else velocity
    counts = np.maximum(2, np.round((ends + window) / grid.seconds).astype(int)) + 1
    means = smoothed(times, positions, velocities, before, window, counts, limits)
    factors = means.slower
    if velocity is not None:
        if factors.max() > 1.0 + ROUNDING:
            raise ValueError("the arm is too fast to leave its way here")
        factors = np.ones_like(factors)
    stops = np.cumsum(counts)
    return [
        Way(
            factor * means.times[begin:end],
            means.positions[begin:end],
            means.velocities[begin:end] / factor,
        )
        for factor, begin, end in zip(factors, stops - counts, stops)
    ]
