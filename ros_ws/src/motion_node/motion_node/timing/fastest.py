# SPDX-License-Identifier: Apache-2.0
"""The fastest way along paths within velocity and acceleration limits.

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
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]

#: No path takes less time than this [s].
SHORTEST: Final = 0.05
#: Coefficients this small do not bound anything; keeps divisions finite.
_TINY: Final = 1e-9
#: No x is as great.
_FAR: Final = 1e12


@dataclass(frozen=True)
class JointLimits:
    """Limits of the arm's joints, each of shape (n,) [rad/s, rad/s²]."""

    velocity: Array
    acceleration: Array


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


def fastest(q: Array, limits: JointLimits, parts: int) -> list[Way]:
    """The fastest timing of the clamped cubic splines through configurations.

    Args:
        q: shape (paths, steps + 1, n) [rad].
        parts: grid intervals a step.
    """
    steps = q.shape[1] - 1
    spline = CubicSpline(np.linspace(0.0, 1.0, steps + 1), q, axis=1, bc_type="clamped")
    grid = np.linspace(0.0, 1.0, steps * parts + 1)
    positions, slopes, bends = (spline(grid, order) for order in range(3))
    squares = _fastest_squares(slopes, bends, limits, 1.0 / (len(grid) - 1))
    speeds = np.sqrt(squares)
    durations = 2.0 / (len(grid) - 1) / (speeds[:, 1:] + speeds[:, :-1])
    velocities = slopes * speeds[:, :, None]
    slower = _slower(positions, velocities, durations, limits)
    times = np.zeros(squares.shape)
    np.cumsum(slower * durations, axis=1, out=times[:, 1:])
    return [Way(*way) for way in zip(times, positions, velocities / slower[:, :, None])]


def _fastest_squares(slopes: Array, bends: Array, limits: JointLimits, step: float) -> Array:
    """x = ṡ² at the grid points, shape (paths, points).

    Args:
        slopes, bends: q' and q'' at the grid points, shape (paths, points, n).
        step: from one grid point to the next.
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
    squares[:, 0] = can[:, 0]
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
    for joint in range(slope.shape[2]):
        steeper = slope[:, :, joint, None] - slope
        steeper = np.where(steeper > _TINY, steeper, _TINY)
        bound = np.minimum(bound, ((reach[:, :, joint, None] + reach) / steeper).min(axis=2))
    return bound


def _slower(positions: Array, velocities: Array, durations: Array, limits: JointLimits) -> Array:
    """By how much paths must be slower for the cubics between points to keep the limits.

    Returns:
        Shape (paths, 1), 1 or a little more: between grid points the limits were not looked at.
    """
    span = durations[:, :, None]
    mean = np.diff(positions, axis=1) / span
    begin, end = velocities[:, :-1], velocities[:, 1:]
    first = np.abs(6.0 * mean - 4.0 * begin - 2.0 * end) / span
    last = np.abs(6.0 * mean - 2.0 * begin - 4.0 * end) / span
    acceleration = (np.maximum(first, last) / limits.acceleration).max(axis=(1, 2))
    # The velocity's extremes are at the ends, or where the acceleration passes through zero.
    linear, square = 6.0 * mean - 4.0 * begin - 2.0 * end, 3.0 * (begin + end - 2.0 * mean)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = -linear / (2.0 * square)
        within = np.where((share > 0.0) & (share < 1.0), begin + 0.5 * share * linear, 0.0)
    velocity = (np.maximum(np.abs(within), np.abs(end)) / limits.velocity).max(axis=(1, 2))
    return np.maximum(np.maximum(np.sqrt(acceleration), velocity), 1.0)[:, None]
