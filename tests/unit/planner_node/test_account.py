# SPDX-License-Identifier: Apache-2.0
"""Answers tell the state that they leave: why, what was done, seen and held, where the arm is."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from loop_bench import GOAL, REACHED, START, LoopBench, fail, knock, obey_blindly
from tamp_runtime.motion_report import ArmPlace, MotionReason, MotionReport, MotionState

from planner_node.loop import Plan, Stage, Status
from planner_node.loop.account import describe_arm, describe_step
from scene_graph import GraphStatus, format_stacks

ALL_DONE = "the motion node reports every move carried out, but the camera sees"


def nothing_happens(_bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
    """The fingers never close: every move is reported, and no block moves."""
    yield MotionReport(state=MotionState.EXECUTING)
    yield MotionReport(state=MotionState.SUCCEEDED, moves_done=len(plan.moves))


def test_fault_4_a_result_that_was_not_predicted_is_remarked_on_and_survives_to_the_answer() -> (
    None
):
    outcome = LoopBench(*[nothing_happens] * 9).achieve()
    assert (outcome.status, outcome.replans) == (Status.TOO_MANY_REPLANS, 5)
    sentence = f"{ALL_DONE} {format_stacks(START)} where {format_stacks(REACHED)} was predicted"
    assert outcome.causes == (sentence,) * 6
    assert f"First cause: {sentence}" in outcome.message
    assert format_stacks(START) in outcome.message
    assert "the arm rests at home, its hand is empty" in outcome.message


def test_fault_4_a_difference_is_told_even_where_the_goal_is_reached() -> None:
    elsewhere = (("yellow_box",), ("green_box", "red_box", "blue_box"), ())
    bench = LoopBench(knock(elsewhere))
    outcome = bench.achieve()
    assert outcome.status == Status.SUCCESS
    assert len(outcome.causes) == 1
    assert outcome.causes[0].startswith(f"{ALL_DONE} {format_stacks(elsewhere)}")


def test_what_is_seen_aside_as_a_whole_asks_for_the_calibration() -> None:
    left, middle, right = REACHED
    assert left == right == ()
    bench = LoopBench(knock((middle, (), ())))
    assert "is the camera calibrated" in bench.achieve().causes[0]


def test_a_plan_that_goes_as_predicted_has_no_causes() -> None:
    assert LoopBench().achieve().causes == ()


def test_fault_4_causes_come_in_order_the_first_one_first() -> None:
    bench = LoopBench(
        fail(MotionReason.GRASP_LOST, "the fingers closed on nothing"),
        fail(MotionReason.TIMEOUT, "it took too long", after=1),
        fail(MotionReason.TRACKING_LOST, "the arm fell behind"),
        max_replans=2,
    )
    outcome = bench.achieve()
    assert outcome.status == Status.TOO_MANY_REPLANS
    assert outcome.causes == (
        "the fingers closed on nothing",
        "it took too long",
        "the arm fell behind",
    )
    assert "First cause: the fingers closed on nothing" in outcome.message
    assert "last cause: the arm fell behind" in outcome.message
    assert "1 move was carried out" in outcome.message


def lean_after_a_plan(bench: LoopBench) -> None:
    """Once a plan was published no picture can be planned on."""

    def lean() -> None:
        if bench.plans:
            bench.fault = {"status": GraphStatus.UNSTABLE, "message": "red_box leans"}
        bench.live_on()

    bench.clock.on_wait = lean


@pytest.mark.parametrize(
    ("reason", "status"),
    [
        (MotionReason.GRASP_LOST, Status.NOT_CONFIDENT),
        (MotionReason.INTERNAL_ERROR, Status.MOTION_FAILED),
    ],
)
def test_fault_4_the_reason_of_a_motion_is_not_dropped_when_the_look_after_it_fails(
    reason: MotionReason, status: Status
) -> None:
    def fail_and_hide(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        yield from fail(reason, "the true reason")(bench, plan)

    bench = LoopBench(fail_and_hide)
    lean_after_a_plan(bench)
    outcome = bench.achieve()
    assert outcome.status == status
    assert "the true reason" in outcome.message
    assert "red_box leans" in outcome.message
    assert outcome.causes[:2] == ("the true reason", "red_box leans")


def test_what_is_new_in_a_picture_that_is_refused_is_told() -> None:
    bench = LoopBench(knock((("red_box",), ("blue_box",), ("green_box", "pink_box"))))
    lean_after_a_plan(bench)
    outcome = bench.achieve()
    assert outcome.status == Status.NOT_CONFIDENT
    assert "red_box leans; pink_box seems to be new" in outcome.message


def test_a_motion_that_fails_for_good_with_the_goal_reached_is_a_success_with_a_cause() -> None:
    def fail_at_the_end(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        moves = len(plan.moves)
        yield from fail(MotionReason.INTERNAL_ERROR, "a defect on the way home", moves)(bench, plan)

    outcome = LoopBench(fail_at_the_end).achieve()
    assert outcome.status == Status.SUCCESS
    assert outcome.causes == ("a defect on the way home",)


def test_an_answer_says_where_the_arm_is_at_the_time_of_the_answer() -> None:
    def move_on(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        yield from fail(MotionReason.INVALID_PLAN, "no such stack")(bench, plan)
        while True:
            yield MotionReport(plan_id="-", arm=ArmPlace.MOVING, hand=(0.1, 0.2, 0.3))

    outcome = LoopBench(move_on).achieve()
    assert outcome.status == Status.MOTION_FAILED
    assert (outcome.motion.reason, outcome.motion.arm) == (
        MotionReason.INVALID_PLAN,
        ArmPlace.MOVING,
    )
    assert "the arm still moves with its hand at (0.10, 0.20, 0.30) m" in outcome.message


def test_what_a_silent_motion_node_said_of_the_arm_is_not_believed_for_ever() -> None:
    def die(bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
        yield MotionReport(state=MotionState.EXECUTING, arm=ArmPlace.HOME)
        bench.mute = True

    outcome = LoopBench(die).achieve()
    assert outcome.status == Status.MOTION_SILENT
    assert outcome.motion.arm == ArmPlace.UNKNOWN
    assert "where the arm is is not known, it may still move" in outcome.message


def test_a_goal_that_makes_no_sense_is_answered_without_an_account() -> None:
    outcome = LoopBench().achieve("red on purple")
    assert outcome.status == Status.UNKNOWN_OBJECT
    assert "the arm" not in outcome.message


def test_a_success_tells_of_the_arm_in_its_fields() -> None:
    outcome = LoopBench().achieve()
    assert (outcome.motion.state, outcome.motion.arm) == (MotionState.SUCCEEDED, ArmPlace.HOME)


def test_a_scene_that_is_never_seen_again_leaves_the_one_before_in_the_answer() -> None:
    outcome = LoopBench(obey_blindly).achieve(GOAL)
    assert outcome.final == outcome.initial
    assert f"Seen last: {format_stacks(START)}" in outcome.message
    assert "3 moves were carried out" in outcome.message


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"phase": "pick", "object_name": "red_box"}, "picking red_box, move 2 of 3"),
        ({"phase": "place", "object_name": "red_box"}, "placing red_box, move 2 of 3"),
        ({"phase": "home"}, "going home"),
        ({"message": "setting out"}, "setting out, move 2 of 3"),
        ({}, "moving, move 2 of 3"),
    ],
)
def test_fault_12_feedback_says_what_the_arm_does(fields: dict[str, str], sentence: str) -> None:
    report = MotionReport(state=MotionState.EXECUTING, move=1, moves_total=3, **fields)  # type: ignore[arg-type]
    assert describe_step(report) == sentence


def test_fault_12_every_feedback_while_the_arm_moves_has_a_message_and_repeats_are_rare() -> None:
    def creep(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        for step in range(200):
            yield MotionReport(
                state=MotionState.EXECUTING,
                phase="pick",
                object_name="blue_box",
                moves_total=3,
                progress=step / 200,
            )
        yield from knock(REACHED)(bench, plan)

    bench = LoopBench(creep)
    bench.achieve()
    moving = [item for item in bench.told if item.stage == Stage.EXECUTING]
    assert all(item.message for item in moving)
    assert "picking blue_box, move 1 of 3" in bench.messages()
    # 200 reports in 10 s: ten or so are passed on, and those on the moves.
    assert 10 <= len(moving) <= 16


@pytest.mark.parametrize(
    ("arm", "sentence"),
    [
        (ArmPlace.HOME, "the arm rests at home, it holds red_box"),
        (ArmPlace.RESTING, "the arm rests away from home with its hand at"),
        (ArmPlace.MOVING, "the arm still moves with its hand at"),
        (ArmPlace.UNKNOWN, "where the arm is is not known, it may still move"),
    ],
)
def test_rest_and_motion_are_told_apart(arm: ArmPlace, sentence: str) -> None:
    assert describe_arm(MotionReport(arm=arm, held="red_box")).startswith(sentence)
