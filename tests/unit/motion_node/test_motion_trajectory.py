# SPDX-License-Identifier: Apache-2.0
"""Trajectories: times within the limits, what happens when, braking."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from simulated_arm import two_moves

from motion_node.phases import HOME, PICK
from motion_node.timing.trajectory import Trajectory


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    return two_moves()


def test_intervals_follow_one_another(trajectory: Trajectory) -> None:
    intervals = trajectory.intervals
    assert intervals[0].start == 0.0
    for before, after in pairwise(intervals):
        assert after.start == pytest.approx(before.end)
    assert intervals[-1].end == pytest.approx(trajectory.duration)
    assert (np.diff(trajectory.times) > 1e-3).all()
    assert np.diff(trajectory.times[:-1]).max() < 0.5


def test_moves_are_done_when_their_block_is_let_go(trajectory: Trajectory) -> None:
    done = [trajectory.moves_done(t) for t in np.linspace(0, trajectory.duration, 200)]
    assert done[0] == 0
    assert done[-1] == 2
    assert done == sorted(done)
    place = next(i for i in trajectory.intervals if i.gripping and i.phase.kind != PICK)
    assert trajectory.moves_done(place.end - 0.01) == 0
    assert trajectory.moves_done(place.end + 0.01) == 1


@pytest.mark.parametrize("share", [0.05, 0.3, 0.55, 0.8])
def test_braking_stays_on_the_path_and_starts_with_the_speed_of_the_moment(
    trajectory: Trajectory, share: float
) -> None:
    start = share * trajectory.duration
    brake = trajectory.brake(start - 0.03, 0.03, 0.4)
    assert brake.duration == pytest.approx(0.4)
    position, velocity = trajectory.sample(start)
    np.testing.assert_allclose(brake.positions.arm[0], position.arm)
    np.testing.assert_allclose(brake.positions.fingers[0], position.fingers)
    np.testing.assert_allclose(brake.velocities.arm[0], velocity.arm, atol=1e-9)
    assert not brake.velocities.arm[-1].any()
    assert not brake.velocities.fingers.any()
    path = trajectory.sample(np.linspace(start, start + 0.4, 400))[0].arm
    for q in brake.positions.arm:
        assert np.abs(path - q).max(axis=1).min() < 0.01
    assert np.ptp(brake.positions.fingers, axis=0).max() == 0.0
    step = np.diff(brake.times)[:, None]
    np.testing.assert_allclose(
        np.diff(brake.positions.arm, axis=0) / step,
        (brake.velocities.arm[1:] + brake.velocities.arm[:-1]) / 2,
        atol=0.05,
    )


def test_a_way_is_gone_back_and_forth_on_the_same_path_from_rest_to_rest(
    trajectory: Trajectory,
) -> None:
    end = trajectory.intervals[0].end
    for start, goal in ((end, end - 0.4), (end - 0.4, end)):
        way = trajectory.back(start, goal)
        assert way.duration == pytest.approx(0.8)
        ends = trajectory.sample(np.array([start, goal]))[0].arm
        np.testing.assert_allclose(way.positions.arm[[0, -1]], ends)
        np.testing.assert_allclose(way.velocities.arm[[0, -1]], 0.0, atol=1e-9)
        np.testing.assert_allclose(
            np.gradient(way.positions.arm, way.times, axis=0)[1:-1],
            way.velocities.arm[1:-1],
            atol=0.03,
        )
        path = trajectory.sample(np.linspace(end - 0.4, end, 400))[0].arm
        for q in way.positions.arm:
            assert np.abs(path - q).max(axis=1).min() < 0.005


def test_braking_does_not_run_past_a_switch(trajectory: Trajectory) -> None:
    travel = trajectory.intervals[0]
    brake = trajectory.brake(travel.end - 0.05, 0.0, 0.6)
    arm, _ = brake.positions[-1].furthest(trajectory.sample(travel.end)[0])
    assert arm < 1e-9


@pytest.mark.parametrize("index", [1, 3])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.8, 0.99])
def test_braking_while_the_fingers_move_opens_them_as_they_closed_and_keeps_the_arm(
    trajectory: Trajectory, index: int, share: float
) -> None:
    grip = trajectory.intervals[index]
    assert grip.gripping
    now = grip.start + share * (grip.end - grip.start)
    brake = trajectory.brake(now, 0.03, 0.4)
    assert np.ptp(brake.positions.arm, axis=0).max() == 0.0
    ends = trajectory.sample(np.array([grip.start, grip.end]))[0].fingers
    np.testing.assert_allclose(brake.positions.fingers[-1], ends.max())
    begin = trajectory.sample(min(now + 0.03, grip.end))[0].fingers
    np.testing.assert_allclose(brake.positions.fingers[0], begin)
    opening = np.diff(brake.positions.fingers, axis=0) / np.diff(brake.times)[:, None]
    assert opening.min() >= 0.0
    _, allowed = trajectory.sample(np.linspace(grip.start, grip.end, 500))
    assert opening.max() <= 1.01 * np.abs(allowed.fingers).max()
    mean = (brake.velocities.fingers[1:] + brake.velocities.fingers[:-1]) / 2
    np.testing.assert_allclose(opening, mean, atol=0.01)


def test_the_last_interval_is_the_way_home(trajectory: Trajectory) -> None:
    assert trajectory.interval_at(1e9).phase.kind == HOME
    assert trajectory.interval_at(-1.0) is trajectory.intervals[0]
