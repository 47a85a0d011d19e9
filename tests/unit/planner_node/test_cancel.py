# SPDX-License-Identifier: Apache-2.0
"""Cancelling in every stage: an outcome that says so, and nothing is left moving."""

from __future__ import annotations

from loop_bench import (
    Behaviour,
    LoopBench,
    ignore,
    obey_blindly,
    run_until_stopped,
    take_up_and_die,
)
from tamp_runtime.motion_report import MotionState

from planner_node.loop import Stage, Status
from scene_graph import GraphStatus


def cancelled_at(stage: Stage, *behaviours: Behaviour) -> LoopBench:
    bench = LoopBench(*behaviours)
    bench.cancel_at = lambda progress: progress.stage == stage
    return bench


def test_while_perceiving() -> None:
    bench = cancelled_at(Stage.PERCEIVING)
    bench.fault = {"status": GraphStatus.OCCLUDED}
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.CANCELLED, "")
    assert (bench.plans, bench.stops) == ([], [])


def test_while_planning() -> None:
    bench = cancelled_at(Stage.PLANNING)
    outcome = bench.achieve()
    assert outcome.status == Status.CANCELLED
    assert "search was cancelled" in outcome.message
    assert bench.plans == []


def test_while_the_arm_moves_it_is_waited_for_until_it_rests() -> None:
    bench = cancelled_at(Stage.EXECUTING, run_until_stopped)
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.CANCELLED, "")
    assert outcome.message.startswith(
        "cancelled; 1 of 3 moves were carried out: put red_box down first. "
    )
    assert outcome.motion.state == MotionState.CANCELLED
    assert outcome.moves_executed == 1
    assert bench.stages()[-1] == Stage.CANCELLING
    assert bench.stops == bench.plan_ids
    bench.cancelled, bench.cancel_at = False, lambda _: False
    bench.stops.clear()
    assert bench.achieve("green on stack2").status == Status.SUCCESS


def test_before_the_motion_node_answers() -> None:
    bench = cancelled_at(Stage.OPTIMISING)
    bench.deaf = True
    outcome = bench.achieve()
    assert outcome.status == Status.CANCELLED
    assert "before anything moved" in outcome.message
    assert set(bench.stops) == set(bench.plan_ids)


def test_a_motion_node_that_says_nothing_at_all_may_have_moved() -> None:
    bench = cancelled_at(Stage.OPTIMISING, ignore)
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.MOTION_SILENT, "motion")
    assert "nobody knows whether" in outcome.message
    assert set(bench.stops) == set(bench.plan_ids)


def test_a_motion_that_fell_silent_is_told() -> None:
    bench = cancelled_at(Stage.EXECUTING, take_up_and_die)
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.MOTION_SILENT, "motion")


def test_while_confirming() -> None:
    bench = cancelled_at(Stage.CONFIRMING, obey_blindly)
    outcome = bench.achieve()
    assert (outcome.status, outcome.moves_executed) == (Status.CANCELLED, 3)
    assert bench.stops == []


def test_a_node_that_shuts_down_does_not_wait_for_the_arm() -> None:
    bench = cancelled_at(Stage.EXECUTING, take_up_and_die)
    bench.shut_down = True
    outcome = bench.achieve()
    assert outcome.status == Status.CANCELLED
    assert bench.stops == bench.plan_ids
