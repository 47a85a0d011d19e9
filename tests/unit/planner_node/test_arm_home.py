# SPDX-License-Identifier: Apache-2.0
"""Before each look nothing moves, and the arm is home with an empty hand."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import pytest
from loop_bench import REACHED, LoopBench, fail, obey, run_until_stopped, stay
from tamp_runtime.motion_report import SOMETHING, ArmPlace, MotionReason, MotionReport, MotionState

from planner_node.loop import Plan, Progress, Stage, Status
from scene_graph import GraphStatus

ELSEWHERE = (0.41, -0.1, 0.35)


def leave_the_arm(held: str) -> LoopBench:
    """An arm that rests before the camera, which sees nothing until it is home."""
    bench = LoopBench()
    bench.arm, bench.held, bench.hand = ArmPlace.RESTING, held, ELSEWHERE

    def hide() -> None:
        hidden = bench.arm != ArmPlace.HOME
        message = "something that is not a block on a place hides 30% of stack0"
        bench.fault = {"status": GraphStatus.OCCLUDED, "message": message} if hidden else {}
        bench.live_on()

    bench.clock.on_wait = hide
    return bench


@pytest.mark.parametrize("held", ["", "red_box", SOMETHING])
def test_fault_2_an_arm_before_the_camera_is_brought_home_before_the_first_look(held: str) -> None:
    bench = leave_the_arm(held)
    outcome = bench.achieve()
    assert outcome.status == Status.SUCCESS
    assert [stop[:5] for stop in bench.stops] == ["home-"]
    assert any("bringing the arm home" in message for message in bench.messages())


def test_fault_2_an_arm_at_home_that_holds_something_empties_its_hand() -> None:
    bench = LoopBench()
    bench.held = "red_box"
    assert bench.achieve().status == Status.SUCCESS
    assert len(bench.stops) == 1
    assert bench.held == ""


def test_fault_2_an_arm_that_a_failed_motion_left_is_brought_home_before_the_next_look() -> None:
    def get_stuck(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        bench.arm, bench.held = ArmPlace.RESTING, plan.blocks[0]
        yield from fail(MotionReason.TRACKING_LOST, "the arm fell behind")(bench, plan)

    bench = LoopBench(get_stuck)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert [stop[:5] for stop in bench.stops] == ["home-"]
    assert outcome.causes[0] == "the arm fell behind"
    assert bench.stacks == REACHED


def test_fault_2_an_arm_that_does_not_come_home_is_stuck_and_told_with_what_it_holds() -> None:
    bench = leave_the_arm("red_box")
    bench.homes = [stay(MotionReason.INFEASIBLE, "there is no way home")]
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.ARM_STUCK, "motion")
    for part in ("there is no way home", "holds red_box", "(0.41, -0.10, 0.35) m", "by hand"):
        assert part in outcome.message
    assert (outcome.motion.arm, outcome.motion.held) == (ArmPlace.RESTING, "red_box")
    assert outcome.motion.hand == ELSEWHERE
    assert bench.plans == []


def test_fault_2_a_way_home_that_something_passing_spoils_is_tried_again() -> None:
    bench = leave_the_arm("")
    bench.homes = [stay(MotionReason.NO_JOINT_STATES, "no joint_states for 3 s")] * 2
    outcome = bench.achieve()
    assert outcome.status == Status.SUCCESS
    assert "no joint_states for 3 s" in outcome.causes[0]


def test_fault_2_what_never_passes_ends_in_arm_stuck() -> None:
    bench = leave_the_arm("")
    bench.homes = [stay(MotionReason.TRACKING_LOST, "it does not follow")] * 10
    outcome = bench.achieve()
    assert outcome.status == Status.ARM_STUCK
    assert "it does not follow" in outcome.message


def test_fault_2_a_motion_node_that_does_not_tell_of_the_arm_is_asked_for_nothing() -> None:
    bench = LoopBench()
    bench.tells_arm = False
    assert bench.achieve().status == Status.SUCCESS
    assert bench.stops == []


def test_fault_2_a_hidden_scene_is_blamed_on_the_arm_where_it_is_the_arm() -> None:
    bench = leave_the_arm("")

    def wander() -> Iterator[MotionReport]:
        while True:
            yield MotionReport(arm=ArmPlace.MOVING, hand=ELSEWHERE)

    bench.go_on_with("", wander())
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.NOT_CONFIDENT, "perception")
    assert "hides 30% of stack0" in outcome.message
    assert "the robot's own arm is in the view" in outcome.message
    assert outcome.motion.arm == ArmPlace.MOVING


def test_going_home_can_be_cancelled() -> None:
    def for_ever(_bench: LoopBench) -> Iterator[MotionReport]:
        while True:
            yield MotionReport(state=MotionState.EXECUTING, phase="home")

    bench = leave_the_arm("")
    bench.homes = [for_ever]
    bench.cancel_at = lambda progress: "bringing the arm home" in progress.message
    before = bench.clock.seconds
    outcome = bench.achieve()
    assert outcome.status == Status.CANCELLED
    assert bench.clock.seconds - before < 10.0


def test_fault_1_a_plan_of_an_earlier_life_is_stopped_waited_for_and_told() -> None:
    bench = LoopBench()

    def go_on() -> Iterator[MotionReport]:
        while "foreign" not in bench.stops:
            yield MotionReport(state=MotionState.EXECUTING)
        for _ in range(100):
            yield MotionReport(state=MotionState.EXECUTING, phase="home")
        bench.stacks = (("red_box",), ("green_box",), ("blue_box",))
        yield MotionReport(state=MotionState.CANCELLED, message="at home")

    bench.go_on_with("foreign", go_on())
    bench.live_on()
    outcome = bench.achieve()
    assert outcome.status == Status.SUCCESS
    assert outcome.initial and outcome.initial.stacks == (
        ("red_box",),
        ("green_box",),
        ("blue_box",),
    )
    assert any("foreign, which this planner does not follow" in text for text in bench.messages())


def test_fault_1_a_plan_that_does_not_stop_is_not_waited_for_for_ever() -> None:
    bench = LoopBench()

    def for_ever() -> Iterator[MotionReport]:
        while True:
            yield MotionReport(state=MotionState.EXECUTING)

    bench.go_on_with("foreign", for_ever())
    bench.live_on()
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.BUSY, "motion")
    assert "foreign" in outcome.message
    assert "does not end though it was asked to stop" in outcome.message
    assert bench.plans == []


def test_fault_1_taking_over_can_be_cancelled() -> None:
    bench = LoopBench()
    bench.go_on_with("foreign", iter([MotionReport(state=MotionState.EXECUTING)] * 10_000))
    bench.live_on()
    bench.cancel_at = lambda progress: "foreign" in progress.message
    before = bench.clock.seconds
    assert bench.achieve().status == Status.CANCELLED
    assert bench.clock.seconds - before < 10.0


def test_fault_1_a_plan_that_somebody_slipped_in_is_stopped_and_planned_for_anew() -> None:
    def refuse(bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
        yield MotionReport(plan_id="foreign", state=MotionState.EXECUTING)
        yield MotionReport(
            state=MotionState.FAILED, reason=MotionReason.BUSY, message="'foreign' is carried out"
        )
        while "foreign" not in bench.stops:
            yield MotionReport(plan_id="foreign", state=MotionState.EXECUTING)
        yield MotionReport(plan_id="foreign", state=MotionState.CANCELLED)

    bench = LoopBench(refuse)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert outcome.causes == ("'foreign' is carried out",)


@pytest.mark.parametrize("place", [ArmPlace.MOVING, ArmPlace.UNKNOWN])
def test_fault_3_an_arm_that_still_moves_after_a_failure_is_waited_for(place: ArmPlace) -> None:
    """Joint states stood still: FAILED was reported, but the arm follows its trajectory."""
    looked: list[float] = []

    def fail_early(bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
        bench.arm = place
        rest = bench.clock.seconds + 9.0

        def settle() -> None:
            bench.live_on()
            if bench.clock.seconds >= rest and bench.arm == place:
                looked.append(bench.clock.seconds)
                bench.arm = ArmPlace.HOME
                bench.stacks = REACHED

        bench.clock.on_wait = settle
        reason = MotionReason.NO_JOINT_STATES
        yield MotionReport(state=MotionState.FAILED, reason=reason, message="no joint_states")

    bench = LoopBench(fail_early)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 0)
    assert looked
    assert outcome.causes[0] == "no joint_states"
    assert len(bench.plans) == 1


def test_fault_3_joint_states_that_never_come_back_are_named() -> None:
    def lose_the_arm(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        bench.arm = ArmPlace.UNKNOWN
        yield from fail(MotionReason.NO_JOINT_STATES, "no joint_states for 3 s")(bench, plan)

    outcome = LoopBench(lose_the_arm).achieve()
    assert (outcome.status, outcome.module) == (Status.MOTION_FAILED, "motion")
    assert "no joint_states for 3 s" in outcome.message
    assert "where the arm is is not known, it may still move" in outcome.message
    assert outcome.motion.arm == ArmPlace.UNKNOWN


def test_a_stop_after_which_the_arm_is_not_home_is_no_plain_cancellation() -> None:
    def stuck(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        for report in run_until_stopped(bench, plan):
            if report.state == MotionState.EXECUTING:
                yield report
        bench.arm, bench.held = ArmPlace.RESTING, "red_box"
        yield MotionReport(state=MotionState.FAILED, message="the way home is blocked")

    bench = LoopBench(stuck)
    bench.cancel_at = lambda progress: progress.stage == Stage.EXECUTING
    outcome = bench.achieve()
    assert outcome.status == Status.ARM_STUCK
    assert "the way home is blocked" in outcome.message
    assert "it holds red_box" in outcome.message


def test_a_long_wait_is_told_of_about_once_a_second() -> None:
    bench = LoopBench(obey)
    bench.fault = {"status": GraphStatus.OCCLUDED}
    times: list[float] = []

    def note(_: Progress) -> bool:
        times.append(bench.clock.seconds)
        return False

    bench.cancel_at = note
    bench.achieve()
    gaps = [after - before for before, after in pairwise(times)]
    assert max(gaps) <= 1.1
    assert len(times) < 30


def test_fault_13_an_arm_of_which_nothing_can_be_known_is_refused_within_a_minute() -> None:
    """Its joint states shake from the beginning: each wait for news is in vain, and made once."""

    def shake(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        bench.clock.seconds += 15.0
        bench.look()
        yield from fail(MotionReason.NO_JOINT_STATES, "the joints shake")(bench, plan)

    bench = LoopBench(shake)
    bench.live_on()
    assert bench.motion.knows_arm
    bench.arm = ArmPlace.UNKNOWN
    begin = bench.clock.seconds
    outcome = bench.achieve()
    assert outcome.status == Status.MOTION_FAILED
    assert "the joints shake" in outcome.message
    assert bench.clock.seconds - begin < 45.0
