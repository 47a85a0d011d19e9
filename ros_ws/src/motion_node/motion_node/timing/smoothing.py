# SPDX-License-Identifier: Apache-2.0
"""Ways without jumps of their accelerations.

In C (``smoothing.c``) where that can be compiled, and else in numpy and scipy.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from tamp_runtime.machine_code import address, written

from .limits import JointLimits

Array = NDArray[np.float64]
IntArray = NDArray[np.int_]

_FILE: Final = Path(__file__).with_suffix(".c")


@dataclass(frozen=True)
class Means:
    """Ways one after another, smoothed.

    Attributes:
        times: of each from 0, shape (points,) [s].
        positions, velocities: shape (points, n) [rad, rad/s].
        slower: by how much ways must be slower for the cubics between their points to keep the
            limits, shape (ways,): 1 or a little more, as these were looked at at grid points only.
    """

    times: Array
    positions: Array
    velocities: Array
    slower: Array


def smoothed(
    times: Array,
    positions: Array,
    velocities: Array,
    before: Array,
    window: float,
    counts: IntArray,
    limits: JointLimits,
) -> Means:
    """Each position is the mean of those within a window around its time.

    Velocities and accelerations are then means, too, and keep what limits they kept. It leaves the
    path by the acceleration times a 24th of the squared window at most: some tenths of a
    millimetre. The ways take longer by the window.

    Args:
        times: of the ways, shape (ways, points) [s].
        positions, velocities: there, shape (ways, points, n) [rad, rad/s].
        before: velocities at the beginnings, shape (n,) [rad/s].
        window: [s].
        counts: how many points the smoothed ways get, at least three, shape (ways,).
    """
    library = written(_FILE)
    if library is None:
        return smoothed_by_numpy(times, positions, velocities, before, window, counts, limits)
    ways, points, joints = positions.shape
    rows = int(counts.sum())
    found = Means(
        np.empty(rows), np.empty((rows, joints)), np.empty((rows, joints)), np.empty(ways)
    )
    own = [np.ascontiguousarray(a, dtype=float) for a in (times, positions, velocities, before)]
    numbers = np.ascontiguousarray(counts, dtype=np.intc)
    most = [np.ascontiguousarray(a, dtype=float) for a in (limits.velocity, limits.acceleration)]
    failed = library.smooth(
        *map(ctypes.c_int, (ways, points, joints)),
        *map(address, own),
        ctypes.c_double(window),
        *map(address, (numbers, *most)),
        *map(address, vars(found).values()),
    )
    if failed:
        raise MemoryError("no memory to smooth ways")
    return found


def smoothed_by_numpy(
    times: Array,
    positions: Array,
    velocities: Array,
    before: Array,
    window: float,
    counts: IntArray,
    limits: JointLimits,
) -> Means:
    """As :func:`smoothed`."""
    before = np.zeros_like(velocities[:, :1]) + before
    rest, ends = np.zeros_like(before), times[:, -1]
    # All ways one after another, each with a rest before and behind it.
    begins = np.concatenate([[0.0], np.cumsum(ends + 3.0 * window)[:-1]]) + window
    joined = CubicHermiteSpline(
        (begins[:, None] + _rested(times, times[:, :1] - window, ends[:, None] + window)).ravel(),
        np.concatenate(_rested(positions, positions[:, :1] - window * before, positions[:, -1:])),
        np.concatenate(_rested(velocities, before, rest)),
    )
    passed = joined.antiderivative()
    own = [np.linspace(0.0, end + window, count) for end, count in zip(ends, counts)]
    late = np.concatenate([begin + moments for begin, moments in zip(begins, own)])
    early = late - window
    means = (passed(late) - passed(early)) / window
    rates = (joined(late) - joined(early)) / window
    stops = np.cumsum(counts)
    means[stops - counts] = positions[:, 0] - window / 2 * before[:, 0]
    means[stops - 1] = positions[:, -1]
    rates[stops - counts], rates[stops - 1] = before[:, 0], 0.0
    moments = np.concatenate(own)
    return Means(moments, means, rates, _slower(means, rates, np.diff(moments), stops, limits))


def _rested(values: Array, first: Array, last: Array) -> Array:
    """Values at the points of ways with one before the first and one behind the last."""
    return np.concatenate([first, values, last], axis=1)


def _slower(
    positions: Array, velocities: Array, durations: Array, stops: IntArray, limits: JointLimits
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
