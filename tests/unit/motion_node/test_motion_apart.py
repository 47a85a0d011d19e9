# SPDX-License-Identifier: Apache-2.0
"""Arm and gripper with a stock controller each: in step, or the arm does not carry on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from executive_bench import Bench
from simulated_arm import BESIDE, HALF_BLOCK, HOME_Q, OPEN, PLAN, SWITCHES, two_moves
from stock_oracle import seconds
from tamp_runtime.motion_report import SOMETHING, ArmPlace, MotionReason, MotionState
from two_controller_arm import ARM, TwoControllerArm

from motion_node.execution.settings import ExecutionSettings, StepSettings
from motion_node.phases import PICK, PLACE

#: Fingers that are farther apart than this have let go of a block [m].
LET_GO = HALF_BLOCK + 0.003


@pytest.fixture
def bench() -> Bench:
    bench = Bench(TwoControllerArm())
    bench.settings = ExecutionSettings(in_step=StepSettings())
    return bench


def arm_of(bench: Bench) -> TwoControllerArm:
    assert isinstance(bench.arm, TwoControllerArm)
    return bench.arm


def dropped(bench: Bench) -> bool:
    """Whether fingers that held a block ever opened elsewhere than where it is put down."""
    holding = False
    for _, joints in arm_of(bench).history:
        opening = float(joints.fingers.mean())
        if opening <= HALF_BLOCK + 1e-4:
            holding = True
        elif holding and opening > LET_GO:
            if np.abs(SWITCHES - joints.arm).max(axis=1).min() > 0.05:
                return True
            holding = False
    return False


def test_both_get_the_same_stamp_and_each_its_own_joints(bench: Bench) -> None:
    assert bench.carry_out().state is MotionState.SUCCEEDED
    arm = arm_of(bench)
    (of_arm,), (of_gripper,) = arm.arm_topic.heard, arm.gripper_topic.heard
    assert of_arm.header.stamp == of_gripper.header.stamp
    assert seconds(of_arm.header.stamp) == pytest.approx(arm.begins[0])
    assert tuple(of_arm.joint_names) == ARM.arm_joints
    assert tuple(of_gripper.joint_names) == ARM.gripper.finger_joints
    assert [point.time_from_start for point in of_arm.points] == [
        point.time_from_start for point in of_gripper.points
    ]


def test_two_controllers_do_together_what_one_would_do(bench: Bench) -> None:
    bench.carry_out()
    arm = arm_of(bench)
    ((trajectory, _),), (begins,) = arm.sent, arm.begins
    assert begins is not None
    for stamp, joints in arm.history:
        # What is noted is where the joints had come to one period before.
        where, _ = trajectory.sample(stamp - arm.PERIOD - begins)
        np.testing.assert_allclose(joints.arm, where.arm, atol=1e-6)
        fingers = np.maximum(where.fingers, HALF_BLOCK)
        np.testing.assert_allclose(joints.fingers, fingers, atol=1e-6)
    assert not dropped(bench)


@pytest.mark.parametrize("late", [0.1, 0.3])
@pytest.mark.parametrize("name", ["arm", "gripper"])
def test_a_message_that_comes_a_little_late_is_caught_up_with(
    bench: Bench, name: str, late: float
) -> None:
    arm_of(bench).topics[name].late = late
    assert bench.carry_out().state is MotionState.SUCCEEDED


@pytest.mark.parametrize("fault", ["lost", "late 1", "late 6", "stopped"])
def test_an_arm_whose_trajectory_does_not_come_keeps_its_gripper_from_going_on(
    bench: Bench, fault: str
) -> None:
    topic = arm_of(bench).arm_topic
    topic.lost, topic.stopped = fault == "lost", fault == "stopped"
    topic.late = float(fault.split()[1]) if "late" in fault else 0.0
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    assert "the arm's controller" in end.message
    assert "joint_trajectory" in end.message
    openings = [joints.fingers.mean() for _, joints in arm_of(bench).history]
    assert min(openings) > BESIDE - 1e-3, "the fingers closed on nothing"


@pytest.mark.parametrize("fault", ["lost", "late 6", "stopped"])
def test_an_arm_whose_gripper_does_nothing_goes_home_and_says_so(bench: Bench, fault: str) -> None:
    topic = arm_of(bench).gripper_topic
    topic.lost, topic.stopped = fault == "lost", fault == "stopped"
    topic.late = float(fault.split()[1]) if "late" in fault else 0.0
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.GRASP_LOST)
    assert "the gripper's controller" in end.message
    assert "gripper_trajectory" in end.message
    assert end.arm is ArmPlace.HOME
    carried = [joints.arm for _, joints in arm_of(bench).history]
    there = np.abs(np.array(carried) - SWITCHES[1]).max(axis=1).min()
    assert there > 0.3, "it went on to where the block was to be put"


@pytest.mark.parametrize("before", [0.8, 0.6, 0.5, 0.4])
@pytest.mark.parametrize("move", [0, 1])
def test_an_arm_that_stops_with_a_block_in_hand_does_not_drop_it(
    bench: Bench, move: int, before: float
) -> None:
    arm, carries = arm_of(bench), two_moves().intervals[4 * move + 2]
    assert carries.phase.tool.held and not carries.gripping

    def soon() -> bool:
        return bool(arm.begins) and bench.follower.time > carries.end - before

    arm.when(soon, lambda: arm.stop_controller("arm"))
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    assert "the arm's controller" in end.message
    assert not dropped(bench)
    assert end.held == ("green_box", "blue_box")[move]


def test_a_gripper_that_stops_with_a_block_in_hand_keeps_it_and_says_so(bench: Bench) -> None:
    arm = arm_of(bench)
    bench.when(PLACE, 0, lambda: arm.stop_controller("gripper"))
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.GRASP_LOST)
    assert "the gripper's controller" in end.message
    assert (end.arm, end.held, end.moves_done) == (ArmPlace.HOME, "green_box", 0)
    assert "take it out by hand" in end.message


@pytest.mark.parametrize("phase", [PICK, PLACE])
def test_a_stop_acts_on_both_at_once(bench: Bench, phase: str) -> None:
    bench.when(phase, 0, bench.stop.set)
    end = bench.carry_out()
    assert (end.state, end.arm, end.held) == (MotionState.CANCELLED, ArmPlace.HOME, "")
    arm = arm_of(bench)
    assert len(arm.arm_topic.heard) == len(arm.gripper_topic.heard) == 3  # out, brake, home
    assert [begins is None for begins in arm.begins] == [False, True, False]
    for topic in arm.topics.values():
        assert topic.controller.refusals == []
        assert seconds(topic.heard[1].header.stamp) == 0.0
    assert not dropped(bench)


@pytest.mark.parametrize("name", ["arm", "gripper"])
def test_without_a_listener_nothing_is_sent(bench: Bench, name: str) -> None:
    sentence = f"nobody listens to it; is the {name}'s controller running?"
    bench.follower._missing = lambda: sentence
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    assert sentence in end.message
    assert not arm_of(bench).sent
    assert end.arm is ArmPlace.HOME


def test_a_listener_that_comes_late_is_waited_for(bench: Bench) -> None:
    answers = iter(["not yet"] * 40)
    bench.follower._missing = lambda: next(answers, "")
    assert bench.carry_out().state is MotionState.SUCCEEDED


def test_a_simulation_that_is_fast_gets_its_trajectories_in_time(bench: Bench) -> None:
    arm = arm_of(bench)
    arm.slowness = 0.05  # twenty seconds of its clock a second
    arm.pass_time(1.0)
    bench.settings = replace(bench.settings, in_step=StepSettings(lead=0.2))
    arm.arm_topic.late = arm.gripper_topic.late = 3.0  # 0.15 s of this machine
    assert bench.carry_out().state is MotionState.SUCCEEDED
    np.testing.assert_allclose(arm.joints.arm, HOME_Q, atol=1e-3)
    np.testing.assert_allclose(arm.joints.fingers, OPEN, atol=1e-3)


def half_open_and_idle(bench: Bench) -> TwoControllerArm:
    """Fingers that somebody else left half open, and nothing between them."""
    arm = arm_of(bench)
    arm.block = 0.0
    arm.gripper_topic.controller.state = [0.02, 0.02]
    arm.gripper_topic.controller.stand()
    arm.pass_time(1.0)
    return arm


def test_a_gripper_that_hears_late_is_not_taken_for_a_hand_that_holds(bench: Bench) -> None:
    arm = half_open_and_idle(bench)
    arm.gripper_topic.late = 5.0
    end = bench.carry_out(replace(PLAN, moves=()))
    assert (end.state, end.held) == (MotionState.CANCELLED, ""), end.message


def test_a_gripper_that_hears_again_is_felt_again(bench: Bench) -> None:
    arm = half_open_and_idle(bench)
    arm.gripper_topic.lost = True
    assert bench.carry_out(replace(PLAN, moves=())).held == SOMETHING
    arm.gripper_topic.lost = False
    end = bench.carry_out(replace(PLAN, moves=()))
    assert (end.state, end.held) == (MotionState.CANCELLED, ""), end.message
