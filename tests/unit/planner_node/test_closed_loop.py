# SPDX-License-Identifier: Apache-2.0
"""The closed loop against a perception and a motion node that misbehave."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from loop_bench import (
    GOAL,
    REACHED,
    START,
    Behaviour,
    LoopBench,
    ignore,
    knock,
    obey,
    obey_blindly,
    take_up_and_die,
)
from tamp_runtime.motion_report import MotionReport, MotionState

from planner_node import make_plan, parse_goal, resolve_goal
from planner_node.loop import Outcome, Plan, Progress, Stage, Status
from planner_node.search import ALGORITHMS, Limits, Problem, State
from planner_node.search.a_star import a_star
from scene_graph import GraphStatus, Move, SceneGraph, Stacks, up_relations


def ended(outcome: Outcome) -> tuple[Status, str]:
    return outcome.status, outcome.module


def test_the_camera_confirms_the_goal() -> None:
    bench = LoopBench()
    outcome = bench.achieve()
    assert ended(outcome) == (Status.SUCCESS, "")
    assert outcome.message == (
        "the camera confirms 'red_box on green_box, blue_box on red_box': "
        "[- | green_box red_box blue_box | -]"
    )
    assert bench.stacks == REACHED
    assert (outcome.moves_planned, outcome.moves_executed, outcome.replans) == (3, 3, 0)
    assert outcome.initial and outcome.initial.stacks == START
    assert outcome.final and outcome.final.stacks == REACHED
    assert outcome.motion.state == MotionState.SUCCEEDED


def test_times_are_summed_up_by_what_they_went_to() -> None:
    bench = LoopBench()
    outcome = bench.achieve()
    # One look before and one after, and five reports of which one is waited for each.
    assert outcome.perceive_seconds == pytest.approx(2 * 0.05)
    assert outcome.motion_seconds == pytest.approx(0.01)
    assert outcome.execute_seconds == pytest.approx(5 * 0.05 - 0.01)


def test_the_plan_carries_the_scene_it_starts_from_and_those_it_leads_to() -> None:
    bench = LoopBench()
    outcome = bench.achieve()
    (plan,) = bench.plans
    assert plan.scene == outcome.initial
    assert plan.blocks == ("blue_box", "red_box", "blue_box")
    assert plan.stamp >= plan.scene.stamp > 0
    assert [graph.relations for graph in plan.predicted] == [
        up_relations(state)
        for state in (
            (("red_box",), ("green_box",), ("blue_box",)),
            ((), ("green_box", "red_box"), ("blue_box",)),
            REACHED,
        )
    ]
    seen = plan.scene.graph
    assert all(graph.names == seen.names for graph in plan.predicted)
    assert all(graph.places == seen.places for graph in plan.predicted)


def test_every_stage_is_told_in_order() -> None:
    bench = LoopBench()
    bench.achieve()
    assert bench.stages() == [
        Stage.PERCEIVING,
        Stage.PLANNING,
        Stage.OPTIMISING,
        Stage.EXECUTING,
        Stage.CONFIRMING,
    ]
    moving = [item for item in bench.told if item.stage == Stage.EXECUTING]
    assert [item.motion.moves_done for item in moving] == [1, 2, 3, 3]
    assert all(item.plan == bench.plans[0] for item in moving)
    assert bench.told[0].plan is None


def test_a_goal_that_holds_moves_nothing() -> None:
    bench = LoopBench()
    outcome = bench.achieve("blue on red")
    assert ended(outcome) == (Status.ALREADY_TRUE, "")
    assert (outcome.moves_planned, outcome.replans, bench.plans) == (0, 0, [])


@pytest.mark.parametrize(
    ("goal", "status"),
    [
        ("", Status.INVALID_GOAL),
        ("red on", Status.INVALID_GOAL),
        ("red on purple", Status.UNKNOWN_OBJECT),
        ("red on box", Status.AMBIGUOUS_OBJECT),
        ("red left of blue, blue left of red", Status.CONTRADICTORY_GOAL),
    ],
)
def test_a_bad_goal_moves_nothing(goal: str, status: Status) -> None:
    bench = LoopBench()
    outcome = bench.achieve(goal)
    assert ended(outcome) == (status, "planner")
    assert outcome.message
    assert bench.plans == []


def test_the_bound_on_the_search_ends_the_loop() -> None:
    assert LoopBench(max_expansions=1).achieve().status == Status.SEARCH_LIMIT


def test_the_search_algorithm_is_the_one_that_was_set(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Problem] = []

    def spy(problem: Problem, limits: Limits) -> list[State]:
        asked.append(problem)
        return a_star(problem, limits)

    monkeypatch.setitem(ALGORITHMS, "a_star", spy)
    assert LoopBench(search_algorithm="a_star").achieve().status == Status.SUCCESS
    assert [problem.initial for problem in asked] == [START]


def test_another_planners_plan_is_carried_out_in_place_of_the_first_search() -> None:
    bench = LoopBench()
    goal = resolve_goal(parse_goal(GOAL), ["red_box", "blue_box", "green_box"])
    longer = make_plan(bench.stacks, goal).moves
    first = longer[0]
    moves = [first, Move(first.target, first.source), *longer]
    outcome = bench.achieve(given="\n".join(map(str, moves)))
    assert (outcome.status, outcome.moves_planned) == (Status.SUCCESS, len(moves))
    assert [plan.moves for plan in bench.plans] == [tuple(moves)]


def test_another_planners_plan_that_misses_the_goal_moves_nothing() -> None:
    bench = LoopBench()
    outcome = bench.achieve(given="(0, 1)\n(9, 1)")
    assert ended(outcome) == (Status.INVALID_PLAN, "planner")
    assert "step 2 of the plan, '(9, 1)': there is no stack9" in outcome.message
    assert bench.plans == []


def test_what_two_stacks_cannot_reach_is_told() -> None:
    bench = LoopBench()
    bench.stacks = (("red_box", "blue_box", "green_box"), ())
    assert bench.achieve("red on blue, blue on stack1").status == Status.UNREACHABLE


def test_without_a_scene_graph_perception_is_named() -> None:
    bench = LoopBench()
    bench.silent = True
    assert ended(bench.achieve()) == (Status.NO_SCENE_GRAPH, "perception")


def test_a_scene_that_stays_hidden_is_told_in_perceptions_words() -> None:
    bench = LoopBench()
    bench.fault = {"status": GraphStatus.OCCLUDED, "message": "a hand hides stack0"}
    outcome = bench.achieve()
    assert ended(outcome) == (Status.NOT_CONFIDENT, "perception")
    assert outcome.message == ("a hand hides stack0. The arm rests at home, its hand is empty")


def test_the_motion_is_confirmed_by_a_later_image_only() -> None:
    outcome = LoopBench(obey_blindly).achieve()
    assert ended(outcome) == (Status.NO_SCENE_GRAPH, "perception")
    assert "nothing has arrived from perception for" in outcome.message
    assert outcome.moves_executed == 3


def test_the_scene_is_looked_at_after_the_request() -> None:
    bench = LoopBench()
    bench.look()
    bench.silent = True
    bench.settings.perceive_timeout = 1.0
    outcome = bench.achieve()
    assert ended(outcome) == (Status.NOT_CONFIDENT, "perception")
    assert "before the last motion or the request" in outcome.message


@pytest.mark.parametrize("behaviour", [ignore, take_up_and_die])
def test_a_motion_node_that_does_not_answer_is_named_and_told_to_stop(
    behaviour: Behaviour,
) -> None:
    bench = LoopBench(behaviour)
    outcome = bench.achieve()
    assert ended(outcome) == (Status.MOTION_SILENT, "motion")
    assert bench.stops == bench.plan_ids
    assert bench.achieve().status == Status.SUCCESS


def test_a_motion_that_somebody_else_stops_ends_the_loop() -> None:
    def stopped(_bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
        yield MotionReport(state=MotionState.CANCELLED, message="at home")

    outcome = LoopBench(stopped).achieve()
    assert outcome.status == Status.CANCELLED
    assert outcome.message.startswith("somebody else stopped the motion: at home. ")


WITHOUT_BLUE: Stacks = (("red_box",), ("green_box",), ())


def test_a_block_of_the_goal_that_disappears_is_named() -> None:
    outcome = LoopBench(knock(WITHOUT_BLUE)).achieve()
    assert ended(outcome) == (Status.UNKNOWN_OBJECT, "perception")
    assert "blue_box cannot be seen any more" in outcome.message


def test_a_block_that_disappears_for_a_moment_is_waited_for() -> None:
    bench = LoopBench(knock(WITHOUT_BLUE))

    def find_again() -> None:
        bench.live_on()
        if bench.told[-1].stage == Stage.CONFIRMING and bench.clock.seconds > 1002.0:
            bench.stacks = REACHED

    bench.clock.on_wait = find_again
    assert bench.achieve().status == Status.SUCCESS
    assert bench.clock.seconds > 1002.0


def test_a_defect_while_the_arm_moves_stops_it() -> None:
    bench = LoopBench()

    def defect(progress: Progress) -> bool:
        if progress.stage == Stage.EXECUTING:
            raise ZeroDivisionError("of all things")
        return False

    bench.cancel_at = defect
    loop = bench.loop()
    with pytest.raises(ZeroDivisionError):
        loop.run(lambda: bench.read(GOAL))
    assert bench.stops == bench.plan_ids
    assert loop.outcome.moves_planned == 3


def test_a_goal_that_cannot_be_read_is_told() -> None:
    bench = LoopBench()
    bench.fault = {"graph": SceneGraph((), frozenset()), "defect": "unknown predicate 'beside'"}
    outcome = bench.achieve()
    assert ended(outcome) == (Status.NOT_CONFIDENT, "perception")
    assert "contradicts itself: unknown predicate 'beside'" in outcome.message


def test_reports_before_the_plan_is_taken_up_mean_nothing() -> None:
    def start_late(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        for _ in range(20):
            yield MotionReport(plan_id="-", state=MotionState.IDLE)
        yield from obey(bench, plan)

    assert LoopBench(start_late).achieve().status == Status.SUCCESS
