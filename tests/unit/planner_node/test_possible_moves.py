# SPDX-License-Identifier: Apache-2.0
"""Moves that the motion node refuses are planned around, before anything moves."""

from __future__ import annotations

from collections.abc import Iterator

from loop_bench import REACHED, Behaviour, LoopBench, ignore, obey
from tamp_runtime.motion_report import Excludes, MotionReason, MotionReport, MotionState

from planner_node.loop import Plan, Status
from scene_graph import Move


def refusing(target: int, *blocks: str) -> Behaviour:
    """A motion node whose arm cannot put some blocks onto the table at a place."""

    def behaviour(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        for index, (move, state) in enumerate(zip(plan.moves, plan.states)):
            block = state[move.source][-1]
            if move.target == target and not state[target] and block in blocks:
                yield MotionReport(
                    state=MotionState.FAILED,
                    reason=MotionReason.INFEASIBLE,
                    message=f"the pose problem of move {index} has no solution",
                    bound="pose",
                    phase="place",
                    constraint="clearance of hand to wall",
                    violation=0.012,
                    excludes=Excludes.PUTTING,
                    move=index,
                )
                return
        yield from obey(bench, plan)

    return behaviour


def test_a_place_that_cannot_be_reached_is_not_used() -> None:
    bench = LoopBench(*[refusing(2, "blue_box")] * 2)
    outcome = bench.achieve("red on green")
    assert outcome.status == Status.SUCCESS
    assert outcome.replans == 0, "nothing moved, so nothing was made anew"
    first, second = bench.plans
    assert first.moves[0] == Move(0, 2)
    assert second.moves == (Move(1, 2), Move(0, 1), Move(0, 2))
    assert outcome.causes[0].startswith(
        "blue_box cannot be put on stack2: clearance of hand to wall, 12 mm missing"
    )
    assert bench.stacks == ((), ("blue_box",), ("green_box", "red_box"))


def explaining(suggestion: str) -> Behaviour:
    """A motion node that only says what would help."""

    def behaviour(_bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        assert plan.explain, "a plan that was refused is not to be carried out"
        yield MotionReport(state=MotionState.OPTIMISING, message="looking for what would help")
        yield MotionReport(
            state=MotionState.FAILED, reason=MotionReason.INFEASIBLE, suggestion=suggestion
        )

    return behaviour


def test_what_would_help_is_asked_of_the_first_plan_and_said() -> None:
    words = "move obstacle wall 12 mm to the left"
    bench = LoopBench(*[refusing(2, "red_box")] * 2, explaining(words))
    outcome = bench.achieve("red on stack2")
    assert outcome.status == Status.MOTION_FAILED
    assert f"12 mm missing (pose of the place); what would help: {words}" in outcome.message
    assert bench.plans[-1].explain
    assert bench.plans[-1].moves == bench.plans[0].moves
    assert outcome.moves_executed == 0


def test_without_a_suggestion_nothing_is_said_to_help() -> None:
    bench = LoopBench(*[refusing(2, "red_box")] * 2, explaining(""))
    outcome = bench.achieve("red on stack2")
    assert outcome.status == Status.MOTION_FAILED
    assert "help" not in outcome.message


def test_a_motion_node_that_does_not_answer_leaves_the_refusal_as_it_is() -> None:
    bench = LoopBench(*[refusing(2, "red_box")] * 2, ignore)
    outcome = bench.achieve("red on stack2")
    assert (outcome.status, outcome.module) == (Status.MOTION_FAILED, "motion")
    assert outcome.message.startswith("impossible: no sequence of moves that the arm can make")


def test_what_is_impossible_is_said_with_all_that_is_excluded() -> None:
    bench = LoopBench(*[refusing(2, "red_box")] * 2, explaining(""))
    outcome = bench.achieve("red on stack2")
    assert (outcome.status, outcome.module) == (Status.MOTION_FAILED, "motion")
    assert outcome.message.startswith("impossible: no sequence of moves that the arm can make")
    assert "red_box cannot be put on stack2: clearance of hand to wall" in outcome.message
    assert outcome.moves_executed == 0
    assert outcome.replans == 1, "the poses are seen anew once"


def test_poses_that_are_seen_anew_may_be_possible() -> None:
    bench = LoopBench(refusing(2, "red_box"))
    outcome = bench.achieve("red on stack2")
    assert outcome.status == Status.SUCCESS
    assert bench.stacks[2][0] == "red_box"


def test_a_refusal_without_a_verdict_is_treated_as_before() -> None:
    def refuse(_bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
        yield MotionReport(
            state=MotionState.FAILED, reason=MotionReason.INFEASIBLE, message="too close"
        )

    bench = LoopBench(refuse)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert bench.stacks == REACHED
