# SPDX-License-Identifier: Apache-2.0
"""The motion node's topics and parameters, with a fake arm and a fake planner as its neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from motion_neighbours import FINGERS, HOME, Bench, LateListener, plan_message
from rclpy.parameter import Parameter
from tamp_interfaces.msg import MotionStatus

from motion_node.robots import PANDA


@pytest.fixture
def bench(ros_context: Any) -> Bench:
    return Bench(ros_context)


def test_a_plan_becomes_a_trajectory_and_statuses(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert end.state == MotionStatus.SUCCEEDED, end.message
    assert (end.moves_done, end.moves_total, end.progress) == (1, 1, 1.0)
    (trajectory,) = bench.arm.trajectories
    assert tuple(trajectory.joint_names) == PANDA.joint_names
    assert trajectory.header.stamp.sec == 0  # which asks the controller to start at once
    np.testing.assert_allclose(trajectory.points[0].positions, HOME, atol=1e-6)
    assert trajectory.points[-1].time_from_start.sec == int(end.duration)
    assert bench.arm.at_home
    statuses = bench.planner.of("a")
    assert statuses[0].state == MotionStatus.OPTIMISING
    phases = [(status.phase, status.object_name) for status in statuses if status.phase]
    assert list(dict.fromkeys(phases)) == [
        ("pick", "green_box"),
        ("place", "green_box"),
        ("home", ""),
    ]
    assert all(status.header.stamp.sec > 0 for status in statuses)


def test_a_second_plan_is_refused_and_a_plan_without_moves_stops_the_first(bench: Bench) -> None:
    bench.arm.hold_at = 0.5
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    bench.wait(lambda: bench.arm.held, "an arm that is held")
    bench.planner.ask(plan_message("b", (0, 1)))
    assert bench.end("b").reason == MotionStatus.BUSY
    bench.planner.stop("a")
    bench.wait(lambda: len(bench.arm.trajectories) > 1, "the brake")
    bench.arm.hold_at = None
    end = bench.end("a")
    assert (end.state, end.moves_done) == (MotionStatus.CANCELLED, 0), end.message
    assert bench.arm.at_home
    brake, home = bench.arm.trajectories[1:]
    assert not any(brake.points[-1].velocities)
    assert home.points[-1].positions.tolist() == pytest.approx(HOME.tolist())


def test_what_cannot_be_read_is_refused_with_its_name(bench: Bench) -> None:
    bench.start()
    plan = plan_message("a", (0, 1))
    plan.initial.relations[0].predicate = "touches"
    bench.planner.ask(plan)
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INVALID_PLAN)
    assert "touches" in end.message
    assert not bench.arm.trajectories


def test_a_plan_waits_for_a_description_that_can_be_used(ros_context: Any) -> None:
    bench = Bench(ros_context, describe=False)
    bench.start(description_timeout=600.0)
    bench.planner.ask(plan_message("a", (0, 1)))
    bench.wait(lambda: bench.planner.of("a"), "taken up")
    bench.arm.describe("<robot/>")
    bench.arm.describe()
    assert bench.end("a").state == MotionStatus.SUCCEEDED


def test_an_idle_node_says_so(bench: Bench) -> None:
    bench.start()
    bench.wait_for_idle()


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("velocity_scale", 1.5, "velocity_scale"),
        ("robot", "nobody", "known: .*panda"),
        ("solver", "guess", "known: .*sqp"),
        ("acceleration_limits", [5.0, 5.0], "has 2 numbers; panda has 7 joints"),
        ("acceleration_limits", [1e3] * 7, "above its maximum"),
    ],
)
def test_parameters_that_cannot_be_are_refused(
    bench: Bench, name: str, value: object, sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        bench.make(**{name: value})


def test_limits_of_the_arm_and_shares_of_them_change_trajectories(bench: Bench) -> None:
    half = [limit / 2 for limit in PANDA.acceleration]
    node = bench.start(acceleration_limits=half)
    durations = []
    for scale in (1.0, 0.5):
        bad, good = (Parameter("acceleration_scale", value=value) for value in (-1.0, scale))
        results = node.set_parameters([bad]) + node.set_parameters([good])
        assert [result.successful for result in results] == [False, True]
        bench.planner.ask(plan_message(f"{scale}", (0, 1)))
        durations.append(bench.end(f"{scale}").duration)
    assert durations[1] > 1.2 * durations[0]


def test_fault_5_statuses_go_on_after_a_plan_and_late_listeners_hear_them(bench: Bench) -> None:
    bench.start()
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert (end.arm, end.held) == (MotionStatus.ARM_HOME, "")
    late = bench.ros.add(LateListener(context=bench.ros.context))
    bench.wait(lambda: any(s.plan_id == "a" for s in late.statuses), "what was said before")

    def idle() -> list[MotionStatus]:
        return [status for status in list(late.statuses) if status.state == MotionStatus.IDLE]

    bench.wait(lambda: idle() and idle()[-1].arm == MotionStatus.ARM_HOME, "IDLE after the plan")
    beat = idle()[-1]
    assert beat.plan_id == ""
    assert beat.hand.z > 0.3  # where the hand of the panda is at home
    bench.planner.ask(plan_message("a", (0, 2)))  # as a planner does that hears of an idle node
    count = len(bench.planner.of("a"))
    bench.wait(lambda: len(bench.planner.of("a")) > count, "the end once more")
    assert bench.planner.of("a")[-1].state == MotionStatus.SUCCEEDED
    assert len(bench.arm.trajectories) == 1


def test_fault_2_a_block_is_put_down_when_its_trajectory_ends_early(bench: Bench) -> None:
    bench.start(max_lag=2.0)
    bench.arm.cut_at = 1.65  # with the block in the hand
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.TRACKING_LOST)
    assert end.message.endswith("green_box was put down on stack2 and the arm is home"), end.message
    assert (end.arm, end.held, end.moves_done) == (MotionStatus.ARM_HOME, "", 1)
    assert bench.arm.at_home
    bench.planner.ask(plan_message("b", (0, 2)))
    assert bench.end("b").state == MotionStatus.SUCCEEDED


def test_fault_2_a_plan_without_moves_brings_an_arm_home_that_was_left_somewhere(
    bench: Bench,
) -> None:
    bench.start()
    bench.arm.put(HOME[:FINGERS] + np.array([0.4, 0.3, 0.0, -0.2, 0.0, 0.1, 0.0]))

    def resting() -> bool:
        return any(s.arm == MotionStatus.ARM_RESTING for s in list(bench.planner.statuses))

    bench.wait(resting, "a status that says so")
    bench.planner.stop("whatever")
    end = bench.end("whatever")
    assert (end.state, end.arm) == (MotionStatus.CANCELLED, MotionStatus.ARM_HOME), end.message
    assert bench.arm.at_home


def test_fault_6_plans_are_refused_while_there_are_two_motion_nodes(bench: Bench) -> None:
    bench.start()
    second = bench.ros.add(bench.make())
    bench.wait(lambda: second._presence.conflict(), "what two of one find")
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.CONFLICT)
    assert "motion_node" in end.message
    assert not bench.arm.trajectories


def test_fault_13_joint_states_that_are_no_numbers_are_named(bench: Bench) -> None:
    bench.arm.unusable = True
    bench.start(joint_state_timeout=2.0)
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.NO_JOINT_STATES)
    assert "without finite positions of panda_joint3" in end.message
    assert end.arm == MotionStatus.ARM_UNKNOWN
