# SPDX-License-Identifier: Apache-2.0
"""The shortest time in which a path keeps within velocity and acceleration limits.

The path is a cubic spline through the steps, clamped at both ends, hence with continuous
accelerations inside. The acceleration is piecewise linear, so its extremes lie at the knots and the
limits hold exactly everywhere, not only at samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointLimits:
    """Limits of the arm's joints, each of shape (n,) [rad/s, rad/s²]."""

    velocity: Array
    acceleration: Array


def unit_spline(q: Array) -> CubicSpline:
    """Clamped cubic spline through configurations (steps + 1, n) over 0..1."""
    return CubicSpline(np.linspace(0.0, 1.0, len(q)), q, bc_type="clamped")


def shortest_duration(spline: CubicSpline, limits: JointLimits) -> float:
    """Shortest time [s] over which the spline keeps within the limits.

    The velocity's extremes lie at knots or where the acceleration crosses zero in between.
    """
    knots = spline.x
    at_knots = spline(knots, 2)
    begin, end = at_knots[:-1], at_knots[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(begin * end < 0, begin / (begin - end), 0.0)
    crossing = knots[:-1, None] + share * np.diff(knots)[:, None]
    speeds = np.abs(spline(np.concatenate([knots, crossing.ravel()]), 1)).max(axis=0)
    velocity = speeds / limits.velocity
    acceleration = np.abs(at_knots).max(axis=0) / limits.acceleration
    return float(max(velocity.max(), np.sqrt(acceleration.max()), 0.05))
