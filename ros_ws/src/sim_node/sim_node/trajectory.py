# SPDX-License-Identifier: Apache-2.0
"""Joint trajectories: checking them before anything moves, and interpolating them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline


class TrajectoryError(ValueError):
    """A trajectory that will not be followed; the sentence says why."""


@dataclass(frozen=True)
class JointLimits:
    """Limits in the order of ``names``; arrays have shape (n,) [rad or m, rad/s or m/s]."""

    names: tuple[str, ...]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    velocity: NDArray[np.float64]


#: How far a waypoint may exceed a limit, to allow for rounding, relative to the limit's size.
_TOLERANCE = 1e-3


class Trajectory:
    """A checked trajectory: piecewise cubic between waypoints with velocities, clamped at its ends.

    Args:
        names: joint names, in any order; must be exactly those of ``limits``.
        times: shape (t,), seconds from the start, growing.
        positions: shape (t, n) in the order of ``names``.
        velocities: same shape, or None: then finite differences, zero at both ends.
        start: present positions in the order of ``limits.names``, shape (n,).
        start_tolerance: how far the first waypoint may be from ``start`` [rad or m], shape (n,).

    Raises:
        TrajectoryError: if anything about it is malformed or beyond the limits.
    """

    def __init__(
        self,
        names: Sequence[str],
        times: NDArray[np.float64],
        positions: NDArray[np.float64],
        velocities: NDArray[np.float64] | None,
        limits: JointLimits,
        start: NDArray[np.float64],
        start_tolerance: NDArray[np.float64],
    ) -> None:
        _check_names(names, limits.names)
        order = [list(names).index(name) for name in limits.names]
        count, joints = len(times), len(limits.names)
        if count == 0:
            raise TrajectoryError("the trajectory has no points")
        for what, values in (("positions", positions), ("velocities", velocities)):
            if values is not None and values.shape != (count, joints):
                raise TrajectoryError(f"not every point has {joints} {what}")
            if values is not None and not np.isfinite(values).all():
                raise TrajectoryError(f"{what} contain NaN or infinity")
        if not np.isfinite(times).all() or times[0] < 0.0 or (np.diff(times) <= 0.0).any():
            raise TrajectoryError("time_from_start does not grow from point to point")
        positions = positions[:, order]
        _check_positions(positions, limits)
        far = "the start is far from the present state: "
        check_jump(positions[0], start, start_tolerance, limits.names, far)
        if times[0] > 0.0:
            times = np.concatenate([[0.0], times])
            positions = np.vstack([start, positions])
            if velocities is not None:
                velocities = np.vstack([np.zeros(joints), velocities])
        if velocities is None:
            velocities = np.zeros_like(positions)
            if len(times) > 2:
                velocities[1:-1] = (positions[2:] - positions[:-2]) / (times[2:] - times[:-2])[
                    :, None
                ]
        else:
            velocities = velocities[:, order]
        self.duration = float(times[-1])
        self._first, self._last = positions[0], positions[-1]
        self._spline: CubicHermiteSpline | None = None
        if len(times) > 1:
            with np.errstate(over="ignore", invalid="ignore"):
                self._spline = CubicHermiteSpline(times, positions, velocities)
                _check_velocities(self._spline, times, limits)

    def sample(self, time: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities at ``time`` seconds from the start, shapes (n,)."""
        if self._spline is None or time >= self.duration:
            return self._last, np.zeros_like(self._last)
        if time <= 0.0:
            return self._first, np.zeros_like(self._first)
        return self._spline(time), self._spline(time, 1)

    def samples(
        self, times: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The same for many times at once, shape (t,): bit by bit what :meth:`sample` gives.

        Returns:
            Positions and velocities, shapes (t, n).
        """
        ends = np.where((times <= 0.0)[:, None], self._first, self._last)
        if self._spline is None:
            return np.broadcast_to(self._last, ends.shape), np.zeros_like(ends)
        inside = ((times > 0.0) & (times < self.duration))[:, None]
        times = np.clip(times, 0.0, self.duration)
        positions, velocities = self._spline(times), self._spline(times, 1)
        return np.where(inside, positions, ends), np.where(inside, velocities, 0.0)


def check_jump(
    target: NDArray[np.float64],
    state: NDArray[np.float64],
    tolerance: NDArray[np.float64],
    names: Sequence[str],
    begin: str,
) -> None:
    """Whether joints can go over to a trajectory where they are; arrays have shape (n,) [rad, m].

    Args:
        target: where the trajectory has them now.
        begin: of the sentence, where they cannot.

    Raises:
        TrajectoryError: if one of them would jump.
    """
    away = np.abs(target - state)
    if (away > tolerance).any():
        joint = int(np.argmax(away / tolerance))
        raise TrajectoryError(
            f"{begin}{names[joint]} would jump by {away[joint]:.3f} (allowed: "
            f"{tolerance[joint]:.3f})"
        )


def belated(late: float) -> str:
    """The begin of a sentence about a trajectory that was to start so long ago [s]; or nothing."""
    return f"it was to start {late:.3g} s ago, and " if late > 0.0 else ""


def _check_names(names: Sequence[str], expected: tuple[str, ...]) -> None:
    if unknown := sorted(set(names) - set(expected)):
        raise TrajectoryError(f"unknown joints: {', '.join(unknown)}")
    if missing := [name for name in expected if name not in names]:
        raise TrajectoryError(f"missing joints: {', '.join(missing)}")
    if len(names) != len(expected):
        raise TrajectoryError("a joint is named twice")


def _check_positions(positions: NDArray[np.float64], limits: JointLimits) -> None:
    slack = _TOLERANCE * (limits.upper - limits.lower)
    outside = (positions < limits.lower - slack) | (positions > limits.upper + slack)
    if outside.any():
        point, joint = np.argwhere(outside)[0]
        raise TrajectoryError(
            f"point {point} moves {limits.names[joint]} to {positions[point, joint]:.3f}, outside "
            f"{limits.lower[joint]:.3f} to {limits.upper[joint]:.3f}"
        )


def _check_velocities(
    spline: CubicHermiteSpline, times: NDArray[np.float64], limits: JointLimits
) -> None:
    # A cubic's velocity is a parabola: three samples an interval bound it closely.
    samples = np.concatenate([times, 0.5 * (times[1:] + times[:-1])])
    speed = np.abs(spline(samples, 1)).max(axis=0)
    # Numbers so large that they overflow end as NaN, which is not slow enough either.
    too_fast = ~(speed <= limits.velocity * (1.0 + _TOLERANCE))
    if too_fast.any():
        joint = int(np.argmax(speed / limits.velocity))
        raise TrajectoryError(
            f"{limits.names[joint]} would move at {speed[joint]:.3f}, faster than its limit of "
            f"{limits.velocity[joint]:.3f}"
        )
