# SPDX-License-Identifier: Apache-2.0
"""The fastest way along paths within velocity and acceleration limits, without jumps of these.

Along a path q(s) the joints have the velocities q' ṡ and the accelerations q' s̈ + q'' ṡ². With
x = ṡ², and s̈ constant from one grid point to the next, limits are linear in x here and x there: the
reachability analysis of Pham and Pham (TOPP-RA, 2018). From the end backwards, the greatest x from
which the rest can be gone is found; from the beginning forwards, x grows as fast as it may below
that. Of each step's linear program all that does not depend on the steps after it is eliminated
beforehand, for all steps of all paths at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, CubicSpline

Array = NDArray[np.float64]

#: No path takes less time than this [s].
SHORTEST: Final = 0.05
#: Coefficients this small do not bound anything; keeps divisions finite.
_TINY: Final = 1e-9
#: An arm that moves no faster stands still [rad/s].
_STANDING: Final = 1e-4
#: Shares of the accelerations with which a way from a moving arm is tried.
_SHARES: Final = (0.98, 0.9, 0.8)
#: A limit is kept to this share of it, where an arm moves as fast as it may already.
_ROUNDING: Final = 1e-3
#: No x is as great.
_FAR: Final = 1e12


@dataclass(frozen=True)
class JointLimits:
    """Limits of the arm's joints, each of shape (n,) [rad/s, rad/s²]."""

    velocity: Array
    acceleration: Array


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
    spline = CubicSpline(np.linspace(0.0, 1.0, steps + 1), q, axis=1, bc_type="clamped")
    points = np.linspace(0.0, 1.0, steps * grid.parts + 1)
    positions, slopes, bends = (spline(points, order) for order in range(3))
    speeds = np.sqrt(_fastest_squares(slopes, bends, limits, points[1]))
    durations = 2.0 * points[1] / (speeds[:, 1:] + speeds[:, :-1])
    times = np.concatenate([np.zeros((len(q), 1)), np.cumsum(durations, axis=1)], axis=1)
    velocities = slopes * speeds[:, :, None]
    return _smoothed(times, positions, velocities, limits, grid)


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
            speeds = np.sqrt(_fastest_squares(slopes, bends, less, points[1], rate**2))
            durations = 2.0 * points[1] / np.maximum(speeds[:, 1:] + speeds[:, :-1], _TINY)
            times = np.concatenate([np.zeros((1, 1)), np.cumsum(durations, axis=1)], axis=1)
            rates = slopes * speeds[:, :, None]
            return _smoothed(times, positions, rates, limits, grid, velocity)[0]
        except ValueError as error:
            failure = error
    assert failure is not None
    raise failure


def _smoothed(
    times: Array,
    positions: Array,
    velocities: Array,
    limits: JointLimits,
    grid: TimeGrid,
    velocity: Array | None = None,
) -> list[Way]:
    """Ways whose accelerations do not jump: each position is the mean of those around its time.

    Velocities and accelerations are then means, too, and keep what limits they kept. It leaves the
    path by the acceleration times a 24th of the squared time at most: some tenths of a millimetre.

    Args:
        times, positions, velocities: of the ways, shapes (paths, points, ...).
        velocity: before their beginnings, shape (n,) [rad/s]; None: rest.

    Raises:
        ValueError: if a way would have to begin more slowly than with a given velocity.
    """
    rest = np.zeros_like(velocities[:, :1])
    before = rest if velocity is None else rest + velocity
    window, ends = grid.smooth_seconds, times[:, -1]
    # All ways one after another, each with a rest before and behind it.
    begins = np.concatenate([[0.0], np.cumsum(ends + 3.0 * window)[:-1]]) + window
    joined = CubicHermiteSpline(
        (begins[:, None] + _rested(times, times[:, :1] - window, ends[:, None] + window)).ravel(),
        np.concatenate(_rested(positions, positions[:, :1] - window * before, positions[:, -1:])),
        np.concatenate(_rested(velocities, before, rest)),
    )
    passed = joined.antiderivative()
    counts = np.maximum(2, np.round((ends + window) / grid.seconds).astype(int)) + 1
    own = [np.linspace(0.0, end + window, count) for end, count in zip(ends, counts)]
    late = np.concatenate([begin + moments for begin, moments in zip(begins, own)])
    early = late - window
    means = (passed(late) - passed(early)) / window
    rates = (joined(late) - joined(early)) / window
    stops = np.cumsum(counts)
    means[stops - counts] = positions[:, 0] - window / 2 * before[:, 0]
    means[stops - 1] = positions[:, -1]
    rates[stops - counts], rates[stops - 1] = before[:, 0], 0.0
    factors = _slower(means, rates, np.diff(np.concatenate(own)), stops, limits)
    if velocity is not None:
        if factors.max() > 1.0 + _ROUNDING:
            raise ValueError("the arm is too fast to leave its way here")
        factors = np.ones_like(factors)
    return [
        Way(factor * moments, places, speeds / factor)
        for factor, moments, places, speeds in zip(
            factors, own, np.split(means, stops[:-1]), np.split(rates, stops[:-1])
        )
    ]


def _rested(values: Array, first: Array, last: Array) -> Array:
    """Values at the points of ways with one before the first and one behind the last."""
    return np.concatenate([first, values, last], axis=1)


def _fastest_squares(
    slopes: Array, bends: Array, limits: JointLimits, step: float, first: float | None = None
) -> Array:
    """x = ṡ² at the grid points, shape (paths, points).

    Args:
        slopes, bends: q' and q'' at the grid points, shape (paths, points, n).
        step: from one grid point to the next.
        first: x at the beginning of all paths, where it is given.

    Raises:
        ValueError: if x at the beginning is too great.
    """
    paths, points, _ = slopes.shape
    with np.errstate(divide="ignore"):
        by_velocity = (limits.velocity / np.abs(slopes)).min(axis=2) ** 2
    most = np.minimum(by_velocity, 1.0 / SHORTEST**2)
    # Of x here and y there, s̈ = (y - x) / (2 step): at both ends of an interval, each joint's
    # acceleration is there * y + here * x.
    rise = slopes / (2.0 * step)
    there = np.concatenate([rise[:, :-1], rise[:, 1:] + bends[:, 1:]], axis=2)
    here = np.concatenate([bends[:, :-1] - rise[:, :-1], -rise[:, 1:]], axis=2)
    greatest = np.tile(limits.acceleration, 2)
    # Where y does not matter, as for joints that stand still, only x is bounded ...
    alone = np.abs(there) <= _TINY * (np.abs(here) + 1.0)
    bound = np.where(alone, greatest / (np.abs(here) + _TINY), np.inf).min(axis=2)
    # ... and elsewhere y is within slope * x ± reach.
    slope = np.where(alone, 0.0, -here) / np.where(alone, 1.0, there)
    reach = np.where(alone, _FAR, greatest / np.abs(np.where(alone, 1.0, there)))
    most[:, :-1] = np.minimum.reduce([most[:, :-1], bound, _greatest(slope, reach)])
    can = most.copy()
    rising = np.where(slope > 0.0, slope, _TINY)
    for index in range(points - 2, -1, -1):
        allowed = ((can[:, index + 1, None] + reach[:, index]) / rising[:, index]).min(axis=1)
        can[:, index] = np.minimum(most[:, index], allowed)
    squares = np.empty((paths, points))
    squares[:, 0] = can[:, 0] if first is None else first
    if (squares[:, 0] > can[:, 0] * (1.0 + _ROUNDING)).any():
        raise ValueError("the arm is too fast to come to rest on its way")
    for index in range(points - 1):
        highest = (slope[:, index] * squares[:, index, None] + reach[:, index]).min(axis=1)
        squares[:, index + 1] = np.clip(highest, 0.0, can[:, index + 1])
    return squares


def _greatest(slope: Array, reach: Array) -> Array:
    """The greatest x for which some y >= 0 is within slope * x ± reach for all joints.

    Every lower bound is below every upper one: (slope_r - slope_s) x <= reach_r + reach_s.
    """
    falling = np.where(slope < 0.0, -slope, _TINY)
    bound = (reach / falling).min(axis=2)
    for joint in range(1, slope.shape[2]):
        apart = np.maximum(np.abs(slope[:, :, :joint] - slope[:, :, joint, None]), _TINY)
        both = (reach[:, :, :joint] + reach[:, :, joint, None]) / apart
        bound = np.minimum(bound, both.min(axis=2))
    return bound


def _slower(
    positions: Array, velocities: Array, durations: Array, stops: Array, limits: JointLimits
) -> Array:
    """By how much ways must be slower for the cubics between their points to keep the limits.

    It is 1 or a little more, as the limits were looked at at grid points only.

    Args:
        positions, velocities: of all ways one after another, shape (points, n).
        durations: from each point to the next [s].
        stops: behind the last point of each way, shape (ways,).

    Returns:
        Shape (ways,).
    """
    inside = np.ones(len(durations), dtype=bool)
    inside[stops[:-1] - 1] = False
    span = durations[inside, None]
    mean = np.diff(positions, axis=0)[inside] / span
    begin, end = velocities[:-1][inside], velocities[1:][inside]
    linear, square = 6.0 * mean - 4.0 * begin - 2.0 * end, 3.0 * (begin + end - 2.0 * mean)
    change = np.maximum(np.abs(linear), np.abs(linear + 2.0 * square))
    fastest, steepest = np.maximum(np.abs(begin), np.abs(end)), change / span
    # The velocity's extremes are at the ends, or where the acceleration passes through zero.
    near = (fastest + change > limits.velocity) & (square != 0.0)
    share = -linear[near] / (2.0 * square[near])
    within = np.where((share > 0.0) & (share < 1.0), begin[near] + 0.5 * share * linear[near], 0.0)
    fastest[near] = np.maximum(np.abs(within), fastest[near])
    starts = np.concatenate([[0], stops[:-1] - np.arange(1, len(stops))])
    acceleration, velocity = (
        np.maximum.reduceat((values / most).max(axis=1), starts)
        for values, most in ((steepest, limits.acceleration), (fastest, limits.velocity))
    )
    return np.maximum.reduce([np.sqrt(acceleration), velocity, np.ones(len(stops))])
