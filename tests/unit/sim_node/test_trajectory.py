# SPDX-License-Identifier: Apache-2.0
"""A malformed trajectory is refused with its reason; a good one is interpolated."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from sim_node.trajectory import JointLimits, Trajectory, TrajectoryError

LIMITS = JointLimits(("a", "b"), np.array([-1.0, -1.0]), np.array([1.0, 1.0]), np.array([2.0, 2.0]))


def make(**changes: Any) -> Trajectory:
    arguments: dict[str, Any] = {
        "names": ["a", "b"],
        "times": np.array([0.0, 1.0, 2.0]),
        "positions": np.array([[0.0, 0.0], [0.5, 0.1], [0.8, 0.2]]),
        "velocities": np.array([[0.0, 0.0], [0.4, 0.1], [0.0, 0.0]]),
        "limits": LIMITS,
        "start": np.zeros(2),
        "start_tolerance": np.full(2, 0.05),
    }
    return Trajectory(**(arguments | changes))


def test_it_passes_through_its_points_with_their_velocities() -> None:
    trajectory = make()
    position, velocity = trajectory.sample(1.0)
    assert position == pytest.approx([0.5, 0.1])
    assert velocity == pytest.approx([0.4, 0.1])


def test_the_order_of_the_joints_does_not_matter() -> None:
    swapped = make(
        names=["b", "a"],
        positions=np.array([[0.0, 0.0], [0.1, 0.5], [0.2, 0.8]]),
        velocities=np.array([[0.0, 0.0], [0.1, 0.4], [0.0, 0.0]]),
    )
    assert swapped.sample(0.7)[0] == pytest.approx(make().sample(0.7)[0])


def test_it_rests_after_its_end() -> None:
    position, velocity = make().sample(5.0)
    assert position == pytest.approx([0.8, 0.2])
    assert velocity == pytest.approx([0.0, 0.0])


@given(
    some.lists(some.floats(-1.0, 4.0) | some.sampled_from([0.0, 1.0, 2.0]), min_size=1),
    some.sampled_from([1, 2, 3]),
)
def test_many_samples_at_once_are_those_one_by_one(times: list[float], points: int) -> None:
    whole = make()
    part = make(
        times=np.array([0.0, 1.0, 2.0])[:points],
        positions=np.array([[0.0, 0.0], [0.5, 0.1], [0.8, 0.2]])[:points],
        velocities=None,
    )
    for trajectory in (whole, part):
        positions, velocities = trajectory.samples(np.array(times))
        for index, time in enumerate(times):
            position, velocity = trajectory.sample(time)
            assert (positions[index] == position).all()
            assert (velocities[index] == velocity).all()


def test_without_velocities_it_starts_and_ends_at_rest() -> None:
    trajectory = make(velocities=None)
    assert trajectory.sample(1e-9)[1] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert trajectory.sample(1.0)[0] == pytest.approx([0.5, 0.1])


def test_a_first_point_in_the_future_is_reached_from_the_present_state() -> None:
    trajectory = make(times=np.array([0.5, 1.0, 2.0]), start=np.array([0.03, 0.0]))
    assert trajectory.sample(0.0)[0] == pytest.approx([0.03, 0.0])


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"names": ["a", "c"]}, "unknown joints: c"),
        ({"names": ["a"], "positions": np.zeros((3, 1))}, "missing joints: b"),
        ({"names": ["a", "b", "b"], "positions": np.zeros((3, 3))}, "twice"),
        ({"times": np.array([0.0, 1.0, 1.0])}, "does not grow"),
        ({"times": np.array([0.0, 2.0, 1.0])}, "does not grow"),
        ({"times": np.array([0.0, np.nan, 1.0])}, "does not grow"),
        ({"times": np.array([-1.0, 1.0, 2.0])}, "does not grow"),
        ({"positions": np.array([[0.0, 0.0], [np.nan, 0.1], [0.8, 0.2]])}, "NaN"),
        ({"velocities": np.array([[0.0, 0.0], [np.inf, 0.1], [0.0, 0.0]])}, "NaN"),
        ({"positions": np.array([[0.0, 0.0], [0.5, 0.1], [1.2, 0.2]])}, "point 2 moves a"),
        ({"start": np.array([0.0, 0.3])}, "b would jump"),
        ({"times": np.array([0.0, 0.1, 0.2])}, "faster than its limit"),
        ({"velocities": np.full((3, 2), 1e308)}, "faster than its limit"),
        ({"velocities": np.array([[0.0, 0.0], [1e308, 0.1], [-1e308, 0.0]])}, "faster than"),
        ({"times": np.array([0.0, 1e-9, 2e-9])}, "faster than its limit"),
        ({"names": []}, "missing joints: a, b"),
        ({"times": np.zeros(0), "positions": np.zeros((0, 2))}, "no points"),
    ],
)
def test_a_malformed_one_is_refused_with_its_reason(changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(TrajectoryError, match=reason):
        make(**changes)
