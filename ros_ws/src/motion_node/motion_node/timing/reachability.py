# SPDX-License-Identifier: Apache-2.0
"""How fast paths can be gone within velocity and acceleration limits (TOPP-RA).

Along a path q(s) the joints have the velocities q' ṡ and the accelerations q' s̈ + q'' ṡ². With
x = ṡ², and s̈ constant from one grid point to the next, limits are linear in x here and x there: the
reachability analysis of Pham and Pham (TOPP-RA, 2018). From the end backwards, the greatest x from
which the rest can be gone is found; from the beginning forwards, x grows as fast as it may below
that. Of each step's linear program all that does not depend on the steps after it is eliminated
beforehand. In C (``reachability.c``) where that can be compiled, and else in numpy.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from .limits import JointLimits

Array = NDArray[np.float64]

#: No path takes less time than this [s].
SHORTEST: Final = 0.05
#: Coefficients this small do not bound anything; keeps divisions finite.
_TINY: Final = 1e-9
#: A limit is kept to this share of it, where an arm moves as fast as it may already.
ROUNDING: Final = 1e-3
#: No x is as great.
_FAR: Final = 1e12
_TOO_FAST: Final = "the arm is too fast to come to rest on its way"
_FILE: Final = Path(__file__).with_suffix(".c")


def fastest_squares(
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
    library = written(_FILE)
    if library is None:
        return squares_by_numpy(slopes, bends, limits, step, first)
    squares = np.empty(slopes.shape[:2])
    given = (slopes, bends, limits.velocity, limits.acceleration)
    arrays = [np.ascontiguousarray(array, dtype=float) for array in given]
    failed = library.squares(
        *map(ctypes.c_int, slopes.shape),
        *map(address, arrays),
        *map(ctypes.c_double, (step, -1.0 if first is None else first)),
        *map(ctypes.c_double, (SHORTEST**-2, _TINY, _FAR, ROUNDING)),
        address(squares),
    )
    if failed < 0:
        raise MemoryError("no memory to time paths")
    if failed:
        raise ValueError(_TOO_FAST)
    return squares


def squares_by_numpy(
    slopes: Array, bends: Array, limits: JointLimits, step: float, first: float | None = None
) -> Array:
    """As :func:`fastest_squares`, for all paths at once."""
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
    if (squares[:, 0] > can[:, 0] * (1.0 + ROUNDING)).any():
        raise ValueError(_TOO_FAST)
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
