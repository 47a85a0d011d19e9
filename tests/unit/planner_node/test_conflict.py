# SPDX-License-Identifier: Apache-2.0
"""Two nodes that do the work of one: nothing is set moving, nothing is claimed."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from loop_bench import LoopBench, fail, run_until_stopped
from tamp_runtime.motion_report import MotionReason, MotionReport

from planner_node.loop import Plan, Progress, Stage, Status

TWO = "there are two of motion_node in this domain; stop one of the two graphs"


def conflict_at(stage: Stage, bench: LoopBench) -> None:
    def appear(progress: Progress) -> bool:
        if progress.stage == stage:
            bench.conflict = TWO
        return False

    bench.cancel_at = appear


def test_fault_6_with_two_of_a_kind_nothing_is_looked_at() -> None:
    bench = LoopBench()
    bench.conflict = TWO
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.CONFLICT, "")
    assert outcome.message.startswith(TWO)
    assert (outcome.initial, bench.plans) == (None, [])


@pytest.mark.parametrize("stage", [Stage.PERCEIVING, Stage.PLANNING])
def test_fault_6_a_second_one_before_the_motion_keeps_the_arm_still(stage: Stage) -> None:
    bench = LoopBench()
    conflict_at(stage, bench)
    outcome = bench.achieve()
    assert outcome.status == Status.CONFLICT
    assert bench.plans == []


def test_fault_6_a_second_one_while_the_arm_moves_stops_it() -> None:
    bench = LoopBench(run_until_stopped)
    conflict_at(Stage.EXECUTING, bench)
    outcome = bench.achieve()
    assert outcome.status == Status.CONFLICT
    assert bench.stops == bench.plan_ids
    assert TWO in outcome.message
    assert "put red_box down first" in outcome.message
    assert bench.stages()[-1] == Stage.CANCELLING


def test_fault_6_with_a_second_one_no_goal_is_called_reached() -> None:
    bench = LoopBench()
    conflict_at(Stage.CONFIRMING, bench)
    assert bench.achieve().status == Status.CONFLICT


def test_fault_6_a_second_one_that_comes_with_the_last_look_is_noticed() -> None:
    bench = LoopBench()

    def appear() -> None:
        bench.live_on()
        if bench.told and bench.told[-1].stage == Stage.PERCEIVING:
            bench.conflict = TWO if bench.scenes.latest() else ""

    bench.clock.on_wait = appear
    assert bench.achieve("blue on red").status == Status.CONFLICT


def test_fault_6_a_conflict_that_the_motion_node_notices_is_passed_on() -> None:
    bench = LoopBench(fail(MotionReason.CONFLICT, TWO))
    outcome = bench.achieve()
    assert outcome.status == Status.CONFLICT
    assert outcome.message.startswith(TWO)


def test_fault_6_a_motion_node_of_another_graph_is_not_planned_against() -> None:
    """Its reports make ours look lost; the loop looks again, and notices then."""

    def intrude(bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
        yield from [MotionReport()] * 3
        bench.conflict = TWO

    bench = LoopBench(intrude)
    outcome = bench.achieve()
    assert outcome.status == Status.CONFLICT
    assert len(bench.plan_ids) == 1
