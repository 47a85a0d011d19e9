# SPDX-License-Identifier: Apache-2.0
"""The motion node in process, with a fake arm and a fake planner as its neighbours."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from motion_neighbours import HOME, Bench, plan_message, scene_message
from rclpy.parameter import Parameter
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.motion_report import MotionReason, MotionState

from motion_node.node import MotionNode
from motion_node.optimiser import MotionOptimiser


@pytest.fixture
def bench(ros_context: Any) -> Bench:
    return Bench(ros_context)


def test_states_and_reasons_are_those_of_the_message() -> None:
    for value in (*MotionState, *MotionReason):
        assert getattr(MotionStatus, value.name) == value


def test_a_plan_is_carried_out_and_reported(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    end = bench.end("a")
    assert end.state == MotionStatus.SUCCEEDED, end.message
    assert (end.reason, end.moves_done, end.moves_total) == (MotionStatus.NONE, 2, 2)
    assert end.progress == 1.0
    assert 0.0 < end.optimisation_seconds < 20.0
    assert end.duration > 5.0
    assert len(bench.arm.trajectories) == 1
    trajectory = bench.arm.trajectories[0]
    assert len(trajectory.joint_names) == 9
    assert trajectory.header.stamp.sec == 0
    np.testing.assert_allclose(trajectory.points[0].positions, HOME, atol=1e-6)
    np.testing.assert_allclose(bench.arm.positions, HOME, atol=0.02)
    statuses = bench.planner.of("a")
    assert statuses[0].state == MotionStatus.OPTIMISING
    phases = [(s.phase, s.object_name) for s in statuses if s.state == MotionStatus.EXECUTING]
    assert list(dict.fromkeys(phase for phase in phases if phase[0])) == [
        ("pick", "green_box"),
        ("place", "green_box"),
        ("pick", "blue_box"),
        ("place", "blue_box"),
        ("home", ""),
    ]
    assert all(status.header.stamp.sec > 0 for status in statuses)


def test_statuses_come_once_a_second_while_busy(ros_context: Any) -> None:
    bench = Bench(ros_context, stuck=True)
    bench.start(start_timeout=20.0)
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    # Nothing happens any more, and the planner hears of it again and again.
    before = len(bench.planner.of("a"))
    bench.wait(lambda: len(bench.planner.of("a")) >= before + 3, "three more statuses")
    assert bench.planner.of("a")[before + 2].state == MotionStatus.EXECUTING


def test_one_plan_after_the_other(bench: Bench) -> None:
    bench.start()
    for index, move in enumerate([(0, 2), (1, 2)]):
        bench.planner.ask(plan_message(f"plan{index}", move))
        assert bench.end(f"plan{index}").state == MotionStatus.SUCCEEDED


def test_a_second_plan_is_refused_while_one_is_carried_out(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.planner.ask(plan_message("b", (0, 1)))
    end = bench.end("b")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.BUSY)
    assert "'a'" in end.message
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))  # the same again is no other plan
    assert bench.end("a").state == MotionStatus.SUCCEEDED
    assert len(bench.arm.trajectories) == 1


@pytest.mark.parametrize(
    ("move", "sentence"),
    [
        ((0, 5), "names stack5"),
        ((2, 0), "takes from stack2, which is empty"),
        ((1, 1), "ends where it starts"),
    ],
)
def test_moves_that_do_not_fit_are_refused(
    bench: Bench, move: tuple[int, int], sentence: str
) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", move))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INVALID_PLAN)
    assert sentence in end.message
    assert not bench.arm.trajectories


def test_scenes_that_make_no_sense_are_refused(bench: Bench) -> None:
    bench.start()
    missing = plan_message("missing", (0, 1))
    missing.initial.objects = missing.initial.objects[1:]
    twice = plan_message("twice", (0, 1))
    twice.initial.objects = [*twice.initial.objects, twice.initial.objects[0]]
    nameless = plan_message("nameless", (0, 1))
    nameless.initial.relations[0].predicate = "beside"
    other = plan_message("other", (0, 1))
    other.moves[0].object_name = "red_box"
    empty = SymbolicPlan(plan_id="empty", moves=other.moves)
    nan = plan_message("nan", (0, 1))
    nan.initial.objects[1].pose.position.x = float("nan")
    for plan, sentence in (
        (missing, "red_box is missing"),
        (twice, "not unique"),
        (nameless, "beside"),
        (other, "green_box is on top"),
        (empty, "no bases"),
        (nan, "no usable pose"),
    ):
        bench.planner.ask(plan)
        end = bench.end(plan.plan_id)
        assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INVALID_PLAN)
        assert sentence in end.message
    assert not bench.arm.trajectories
    bench.planner.ask(plan_message("good", (0, 1)))
    assert bench.end("good").state == MotionStatus.SUCCEEDED


def test_an_infeasible_plan_names_bound_block_and_constraint(bench: Bench) -> None:
    bench.start()
    plan = plan_message("a", (0, 1), (1, 2))
    plan.initial.bases[2].position.x = 1.2
    bench.planner.ask(plan)
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INFEASIBLE)
    assert (end.bound, end.object_name, end.move) == (MotionStatus.POSE, "green_box", 1)
    assert "stack2" in end.constraint
    assert end.phase == "place"
    assert not bench.arm.trajectories


def test_without_joint_states_nothing_starts(ros_context: Any) -> None:
    bench = Bench(ros_context, silent=True)
    bench.start(joint_state_timeout=0.5)
    bench.planner.ask(plan_message("a", (0, 1)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.NO_JOINT_STATES)
    assert "joint_states" in end.message


def test_without_a_description_nothing_starts_and_a_later_one_is_enough(ros_context: Any) -> None:
    bench = Bench(ros_context, describe=False)
    bench.start(description_timeout=0.5)
    bench.arm.describe("<robot/>")
    bench.planner.ask(plan_message("a", (0, 1)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.NO_JOINT_STATES)
    assert "robot_description" in end.message
    bench.arm.describe()
    tries = iter(range(100))

    def carried_out() -> bool:
        plan_id = f"try{next(tries)}"
        bench.planner.ask(plan_message(plan_id, (0, 1)))
        return bench.end(plan_id).state == MotionStatus.SUCCEEDED

    bench.wait(carried_out, "a plan that is carried out")


def test_joint_states_that_stop_end_the_execution(bench: Bench) -> None:
    bench.start(joint_state_timeout=0.5)
    bench.planner.ask(plan_message("a", (0, 1)))
    bench.wait_for_phase("a", "place", 0)
    bench.arm.silent = True
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.NO_JOINT_STATES)


def test_a_clock_that_stands_still_ends_the_execution(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 1)))
    bench.wait_for_phase("a", "pick", 0)
    bench.arm.frozen_clock = True
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.TIMEOUT)
    assert "clock" in end.message


def test_an_arm_that_refuses_is_reported(ros_context: Any) -> None:
    bench = Bench(ros_context, deaf=True)
    bench.start(start_timeout=1.0)
    bench.planner.ask(plan_message("a", (0, 1)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.TRACKING_LOST)
    assert "does not start" in end.message


def test_an_arm_that_gets_stuck_is_reported(bench: Bench) -> None:
    bench.start(max_lag=1.0)
    bench.planner.ask(plan_message("a", (0, 1)))
    bench.wait_for_phase("a", "place", 0)
    bench.arm.stuck = True
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.TRACKING_LOST)
    assert end.moves_done == 0


def test_an_arm_that_obeys_again_goes_home_with_its_empty_hand(bench: Bench) -> None:
    bench.start(max_lag=1.0)
    bench.planner.ask(plan_message("a", (0, 1)))
    bench.wait(lambda: np.abs(bench.arm.positions - HOME).max() > 0.2, "a moving arm")
    bench.arm.stuck = True
    bench.wait(lambda: len(bench.arm.trajectories) > 1, "the command to hold")
    bench.arm.stuck = False
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.TRACKING_LOST)
    assert "the arm is home" in end.message
    np.testing.assert_allclose(bench.arm.positions, HOME, atol=0.02)


def test_joint_states_of_long_ago_do_not_count(bench: Bench) -> None:
    bench.start(joint_state_timeout=0.5)
    bench.planner.ask(plan_message("a", (0, 1)))
    bench.end("a")
    bench.arm.silent = True
    time.sleep(0.7)
    bench.planner.ask(plan_message("b", (0, 1)))
    assert bench.end("b").reason == MotionStatus.NO_JOINT_STATES


def test_fingers_that_close_on_nothing_send_the_arm_home(bench: Bench) -> None:
    bench.start()
    bench.arm.block = 0.0
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.GRASP_LOST), end.message
    assert "green_box" in end.message
    assert end.moves_done == 0
    np.testing.assert_allclose(bench.arm.positions, HOME, atol=0.02)


def test_a_block_lost_on_the_second_move_counts_the_first(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2), (1, 2)))
    bench.wait_for_phase("a", "place", 1)
    bench.arm.block = 0.0
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.GRASP_LOST), end.message
    assert end.moves_done == 1
    np.testing.assert_allclose(bench.arm.positions, HOME, atol=0.02)


def test_a_defect_is_reported_and_the_node_lives_on(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.start()

    def broken(*_arguments: Any) -> None:
        raise RuntimeError("a defect made for the test")

    with monkeypatch.context() as patch:
        patch.setattr(MotionOptimiser, "solve", broken)
        bench.planner.ask(plan_message("a", (0, 1)))
        end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INTERNAL_ERROR)
    assert "made for the test" in end.message
    bench.planner.ask(plan_message("b", (0, 1)))
    assert bench.end("b").state == MotionStatus.SUCCEEDED


def test_parameters_out_of_range_are_refused(bench: Bench) -> None:
    with pytest.raises(ValueError, match="velocity_scale"):
        MotionNode(
            context=bench.ros.context,
            parameter_overrides=[Parameter("velocity_scale", value=1.5)],
        )
    node = bench.start()
    bad, good = Parameter("velocity_scale", value=-1.0), Parameter("velocity_scale", value=0.5)
    results = node.set_parameters([bad]) + node.set_parameters([good])
    assert [result.successful for result in results] == [False, True]


def test_slower_parameters_make_slower_trajectories(bench: Bench) -> None:
    node = bench.start()
    bench.planner.ask(plan_message("fast", (0, 1)))
    fast = bench.end("fast").duration
    node.set_parameters([Parameter("acceleration_scale", value=0.2)])
    bench.planner.ask(plan_message("slow", (0, 1)))
    assert bench.end("slow").duration > 1.3 * fast


def test_an_idle_node_says_so_until_its_first_plan(bench: Bench) -> None:
    bench.start()
    bench.wait_for_idle()


def test_more_stacks_than_the_usual(bench: Bench) -> None:
    bench.start()
    plan = plan_message("a", (0, 3))
    fourth = scene_message().bases[2]
    fourth.index, fourth.position.y = 3, 0.3
    plan.initial.bases = [*plan.initial.bases, fourth]
    bench.planner.ask(plan)
    assert bench.end("a").state == MotionStatus.SUCCEEDED
