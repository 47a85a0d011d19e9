# SPDX-License-Identifier: Apache-2.0
"""Requests to stop, in every phase of a plan, and restarts with an old plan still latched."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from motion_neighbours import HOME, Bench, plan_message
from tamp_interfaces.msg import MotionStatus


@pytest.fixture
def bench(ros_context: Any) -> Bench:
    return Bench(ros_context, speed=4.0)


def gripped(bench: Bench) -> bool:
    """Whether the fingers are around a block."""
    return bool(bench.arm.positions[7] < 0.03)


def assert_cancelled_at_home(bench: Bench, moves_done: int) -> None:
    end = bench.end("a")
    assert end.state == MotionStatus.CANCELLED, end.message
    assert end.moves_done == moves_done
    assert "stopped on request" in end.message
    np.testing.assert_allclose(bench.arm.positions, HOME, atol=0.02)


def test_before_the_motion_is_optimised(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", *[(0, 1), (1, 0)] * 6))
    bench.wait(lambda: bench.planner.of("a"), "taken up")
    bench.planner.stop("a")
    end = bench.end("a")
    assert end.state == MotionStatus.CANCELLED
    assert not bench.arm.trajectories


def test_with_an_empty_hand_on_its_way(bench: Bench) -> None:
    bench.arm.speed = 1.0  # time to hear of the stop before the block is held
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.planner.stop("a")
    assert_cancelled_at_home(bench, 0)
    brake, home = bench.arm.trajectories[1:]
    assert brake.points[-1].time_from_start.sec == 0
    assert not any(brake.points[-1].velocities)
    assert home.points[-1].positions.tolist() == pytest.approx(HOME.tolist())


def test_with_a_block_in_hand_it_is_put_down_first(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait_for_phase("a", "place", 0)
    assert gripped(bench)
    sent = len(bench.arm.trajectories)
    bench.planner.stop("a")
    bench.wait(lambda: len(bench.arm.trajectories) > sent, "the brake")
    assert not gripped(bench)
    assert_cancelled_at_home(bench, 1)


def test_while_the_fingers_close_the_block_is_left_standing(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait(lambda: bench.arm.positions[7] < 0.038, "closing fingers")
    bench.planner.stop("a")
    end = bench.end("a")
    # A slow machine may hear of it when the block has left the stack; then it is put down first.
    assert end.state == MotionStatus.CANCELLED
    assert end.moves_done in (0, 1)
    np.testing.assert_allclose(bench.arm.positions, HOME, atol=0.02)


def test_between_two_moves(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait_for_phase("a", "pick", 1)
    bench.planner.stop("a")
    assert_cancelled_at_home(bench, 1)


def test_on_the_way_home(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait_for_phase("a", "home", 1)
    bench.planner.stop("a")
    assert_cancelled_at_home(bench, 2)


def test_twice_is_once(bench: Bench) -> None:
    bench.arm.speed = 1.0  # time to hear of the stop before the block is held
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.planner.stop("a")
    bench.planner.stop("a")
    assert_cancelled_at_home(bench, 0)


def test_the_next_plan_is_carried_out(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.planner.stop("a")
    bench.end("a")
    bench.planner.ask(plan_message("b", (0, 2)))
    assert bench.end("b").state == MotionStatus.SUCCEEDED


def test_another_plan_is_not_concerned(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.planner.stop("b")
    assert bench.end("b").state == MotionStatus.CANCELLED
    assert bench.end("a").state == MotionStatus.SUCCEEDED


def test_what_has_ended_repeats_its_end(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.end("a")
    count = len(bench.planner.of("a"))
    bench.planner.stop("a")
    bench.wait(lambda: len(bench.planner.of("a")) > count, "an answer")
    assert bench.planner.of("a")[-1].state == MotionStatus.SUCCEEDED


def test_without_a_name_whatever_runs_is_stopped(bench: Bench) -> None:
    bench.arm.speed = 1.0  # time to hear of the stop before the block is held
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.planner.stop("")
    assert_cancelled_at_home(bench, 0)


def test_a_latched_plan_of_before_the_start_is_ignored(bench: Bench) -> None:
    bench.planner.ask(plan_message("old", (0, 2)))
    bench.start()
    bench.wait_for_idle()
    bench.planner.ask(plan_message("new", (0, 1)))
    assert bench.end("new").state == MotionStatus.SUCCEEDED
    assert not bench.planner.of("old")
    assert len(bench.arm.trajectories) == 1


def test_a_plan_waits_until_the_arm_rests(bench: Bench) -> None:
    """The trajectory of an earlier life of the node may still be under way."""
    first = bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "place", 0)
    ended = bench.arm.trajectories[0].points[-1].time_from_start.sec / bench.arm.speed
    bench.ros.remove(first)
    bench.start()
    bench.planner.ask(plan_message("b", (0, 2)))
    end = bench.end("b")
    assert end.state == MotionStatus.SUCCEEDED, end.message
    second = bench.arm.trajectories[1]
    np.testing.assert_allclose(second.points[0].positions, HOME, atol=0.02)
    assert ended > 0
