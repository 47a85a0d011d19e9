# SPDX-License-Identifier: Apache-2.0
"""The fastest timing of paths: within the limits everywhere, and as fast as they allow.

The oracles: an independent sampler, and the same problem as one linear program after the other,
solved by scipy's.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.optimize import linprog

from motion_node.timing.fastest import TimeGrid, fastest
from motion_node.timing.limits import JointLimits
from motion_node.timing.reachability import SHORTEST, fastest_squares, squares_by_numpy
from motion_node.timing.smoothing import smoothed, smoothed_by_numpy

Array = NDArray[np.float64]


def some_paths(seed: int, joints: int, count: int, steps: int = 14) -> Array:
    """Smooth random ways from one configuration to another that begin and end slowly."""
    rng = np.random.default_rng(seed)
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    ways = rng.normal(0.0, 1.0, (count, 1, joints)) * share**2 * (3.0 - 2.0 * share)
    for waves in (1, 2):
        sizes = rng.normal(0.0, 0.5 / waves, (count, 1, joints))
        ways = ways + sizes * np.sin(np.pi * share) ** 2 * np.cos(np.pi * waves * share)
    return ways


def some_limits(seed: int, joints: int) -> JointLimits:
    rng = np.random.default_rng([seed, 1])
    return JointLimits(rng.uniform(1.0, 3.0, joints), rng.uniform(4.0, 15.0, joints))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7), st.integers(2, 8))
def test_the_limits_hold_everywhere_between_two_rests(seed: int, joints: int, parts: int) -> None:
    q, limits = some_paths(seed, joints, 3), some_limits(seed, joints)
    for path, way in zip(q, fastest(q, limits, TimeGrid(parts))):
        times, positions, velocities = way.times, way.positions, way.velocities
        assert times[0] == 0.0 and (np.diff(times) > 0.0).all()
        np.testing.assert_allclose(positions[[0, -1]], path[[0, -1]], atol=1e-9)
        spline = CubicSpline(np.linspace(0.0, 1.0, len(path)), path, bc_type="clamped")
        along = spline(np.linspace(0.0, 1.0, 3000))
        for position in positions[::10]:
            assert np.abs(along - position).max(axis=1).min() < 2e-3
        assert not velocities[[0, -1]].round(9).any()
        cubic = CubicHermiteSpline(times, positions, velocities)
        dense = np.linspace(0.0, times[-1], 4000)
        assert (np.abs(cubic(dense, 1)) <= limits.velocity * (1 + 1e-6)).all()
        assert (np.abs(cubic(dense, 2)) <= limits.acceleration * (1 + 1e-6)).all()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7))
def test_accelerations_do_not_jump(seed: int, joints: int) -> None:
    q, limits, grid = some_paths(seed, joints, 2), some_limits(seed, joints), TimeGrid()
    jerk = 2.0 * limits.acceleration / grid.smooth_seconds
    for way in fastest(q, limits, grid):
        acceleration = CubicHermiteSpline(way.times, way.positions, way.velocities).derivative(2)
        times = np.arange(0.0, way.duration, 0.001)
        changes = np.abs(acceleration(times + grid.seconds) - acceleration(times))
        assert (changes[times < way.duration - grid.seconds] <= 1.5 * jerk * grid.seconds).all()
        # At its ends it is at rest.
        assert (np.abs(acceleration([0.0, way.duration])) <= 2.0 * jerk * grid.seconds).all()


@pytest.mark.parametrize("seed", range(6))
def test_it_is_as_fast_as_one_linear_program_after_the_other(seed: int) -> None:
    """TOPP-RA as it is published; ours keeps the limits between grid points, too, and jerk."""
    q, limits, grid = some_paths(seed, 4, 1), some_limits(seed, 4), TimeGrid()
    duration = fastest(q, limits, grid)[0].duration
    least = _by_linear_programs(q[0], limits, grid.parts)
    assert least * (1 - 1e-6) <= duration <= 1.05 * least + grid.smooth_seconds


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7))
def test_twice_the_way_is_not_faster_and_a_finer_grid_is_not_slower(seed: int, joints: int) -> None:
    q, limits = some_paths(seed, joints, 2), some_limits(seed, joints)
    coarse, fine = TimeGrid(8), TimeGrid(16)
    ways = [fastest(q, limits, coarse), fastest(2.0 * q, limits, coarse), fastest(q, limits, fine)]
    for once, twice, finer in zip(*ways):
        assert twice.duration >= once.duration * (1 - 1e-9)
        assert finer.duration <= once.duration * 1.05


def test_one_joint_goes_at_full_acceleration_and_at_full_speed() -> None:
    limits = JointLimits(np.array([2.0]), np.array([5.0]))
    way = 3.0
    share = np.linspace(0.0, 1.0, 15)
    q = way * (share**2 * (3.0 - 2.0 * share))[None, :, None]
    least = way / 2.0 + 2.0 / 5.0  # a trapezoid
    assert (
        least
        <= fastest(q, limits, TimeGrid(16))[0].duration
        <= 1.03 * (least + TimeGrid().smooth_seconds)
    )


def test_a_path_that_goes_nowhere_takes_a_moment() -> None:
    (way,) = fastest(np.ones((1, 15, 7)), some_limits(0, 7), TimeGrid())
    assert way.duration == pytest.approx(SHORTEST + TimeGrid().smooth_seconds)
    assert not way.velocities.any()


def _by_linear_programs(q: Array, limits: JointLimits, parts: int) -> float:
    steps = (len(q) - 1) * parts
    spline = CubicSpline(np.linspace(0.0, 1.0, len(q)), q, bc_type="clamped")
    grid, step = np.linspace(0.0, 1.0, steps + 1), 1.0 / steps
    slope, bend = spline(grid, 1), spline(grid, 2)
    with np.errstate(divide="ignore"):
        most = np.minimum((limits.velocity / np.abs(slope)).min(axis=1) ** 2, SHORTEST**-2.0)

    def rows(index: int) -> tuple[Array, Array]:
        """Of (x, s̈): both ends' accelerations, and x at the next point."""
        ends = [
            np.stack([bend[index], slope[index]], axis=1),
            np.stack([bend[index + 1], slope[index + 1] + 2 * step * bend[index + 1]], axis=1),
        ]
        matrix = np.concatenate([*ends, *(-end for end in ends)])
        return matrix, np.tile(limits.acceleration, 4)

    def extreme(index: int, highest: float, objective: Array, x: tuple[float, float]) -> Array:
        matrix, bounds = rows(index)
        matrix = np.concatenate([matrix, [[1.0, 2 * step], [-1.0, -2 * step]]])
        bounds = np.concatenate([bounds, [highest, 0.0]])
        found = linprog(objective, matrix, bounds, bounds=[x, (None, None)])
        assert found.success
        return np.asarray(found.x)

    can = most.copy()
    for index in range(steps - 1, -1, -1):
        can[index] = extreme(index, can[index + 1], np.array([-1.0, 0.0]), (0.0, most[index]))[0]
    squares = [can[0]]
    for index in range(steps):
        x = squares[-1]
        best = extreme(index, can[index + 1], np.array([0.0, -1.0]), (x * (1 - 1e-9), x))
        squares.append(max(0.0, x + 2 * step * best[1]))
    speeds = np.sqrt(squares)
    return float((2 * step / (speeds[1:] + speeds[:-1])).sum())


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7), st.booleans())
def test_c_and_numpy_time_alike(seed: int, joints: int, still: bool) -> None:
    q, limits = some_paths(seed, joints, 3), some_limits(seed, joints)
    if still:
        q[..., 0] = q[:1, :1, 0]
    spline = CubicSpline(np.linspace(0.0, 1.0, q.shape[1]), q, axis=1, bc_type="clamped")
    points = np.linspace(0.0, 1.0, 101)
    positions, slopes, bends = (spline(points, order) for order in range(3))
    both = (fastest_squares, squares_by_numpy)
    found, other = (own(slopes, bends, limits, 0.01) for own in both)
    np.testing.assert_allclose(found, other, rtol=1e-9)
    slow = found.min(axis=0)[0] / 2
    later, other = (own(slopes, bends, limits, 0.01, slow) for own in both)
    np.testing.assert_allclose(later, other, rtol=1e-9)
    for own in both:
        with pytest.raises(ValueError, match="too fast to come to rest"):
            own(slopes, bends, limits, 0.01, 1.1 * found.max())
    speeds = np.sqrt(found)
    times = np.cumsum(0.02 / (speeds[:, 1:] + speeds[:, :-1]), axis=1)
    times = np.concatenate([np.zeros((3, 1)), times], axis=1)
    velocities = slopes * speeds[:, :, None]
    cases = [(0, 3, np.array([3, 90, 250])), (30, 1, np.array([120]))]  # one moves already
    for begin, count, counts in cases:
        ways = [values[:count, begin:] for values in (times, positions, velocities)]
        ways[0] = ways[0] - ways[0][:, :1]
        given_ = (*ways, velocities[0, begin], 0.015, counts, limits)
        mine, its = (own(*given_) for own in (smoothed, smoothed_by_numpy))
        for name, values in vars(mine).items():
            np.testing.assert_allclose(values, vars(its)[name], rtol=1e-6, atol=1e-7, err_msg=name)
