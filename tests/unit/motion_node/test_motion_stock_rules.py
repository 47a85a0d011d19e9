# SPDX-License-Identifier: Apache-2.0
"""The simulator's controllers take and refuse what ros2_control's do, by an independent oracle."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as some
from stock_oracle import StockOracle
from tamp_runtime.messages.stamps import duration_from_seconds, seconds, stamp_from_nanoseconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sim_node.conversions import trajectory_arrays
from sim_node.stock_rules import check_stock_rules
from sim_node.trajectory import TrajectoryError

JOINTS = ("left", "right")
NOW = 100.0

names = some.lists(some.sampled_from([*JOINTS, "elbow"]), max_size=3, unique=True)
times = some.lists(some.sampled_from([0.0, 0.5, 1.0, 2.0]), max_size=4)
stamps = some.sampled_from([0.0, 97.0, 98.5, 99.5, 101.0])
ends = some.sampled_from([0.0, 1e-9, 0.1])


def message(who: list[str], when: list[float], stamp: float, end: float) -> Any:
    points = [
        JointTrajectoryPoint(
            positions=[0.01] * len(who),
            velocities=[end if time == when[-1] else 0.0] * len(who),
            time_from_start=duration_from_seconds(time),
        )
        for time in when
    ]
    result = JointTrajectory(joint_names=who, points=points)
    result.header.stamp = stamp_from_nanoseconds(round(stamp * 1e9))
    return result


@given(names | some.permutations(JOINTS), times | some.just([0.0, 1.0]), stamps, ends)
def test_both_take_the_same(who: list[str], when: list[float], stamp: float, end: float) -> None:
    heard = message(list(who), when, stamp, end)
    taken = StockOracle(JOINTS, [0.0, 0.0]).hear(heard, NOW)
    own_times, _, velocities = trajectory_arrays(heard)
    late = NOW - seconds(heard.header.stamp) if stamp else 0.0
    try:
        check_stock_rules(heard.joint_names, JOINTS, own_times, velocities, late)
    except TrajectoryError:
        assert not taken
    else:
        assert taken


def test_it_starts_where_the_joints_are_and_is_exact_at_points() -> None:
    oracle = StockOracle(JOINTS, [0.3, 0.3])
    assert oracle.hear(message(["right", "left"], [0.0, 1.0], 101.0, 0.0), NOW)
    np.testing.assert_allclose(oracle.sample(NOW), [0.3, 0.3])
    np.testing.assert_allclose(oracle.sample(101.0), [0.01, 0.01])
