# SPDX-License-Identifier: Apache-2.0
"""When the closed loop plans anew, and when it gives up."""

from __future__ import annotations

import pytest
from loop_bench import REACHED, LoopBench, fail, knock
from tamp_runtime.motion_report import MotionReason

from planner_node.loop import Progress, Stage, Status


def test_a_knocked_block_is_planned_for_anew() -> None:
    bench = LoopBench(knock((("blue_box",), ("green_box",), ("red_box",))))
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert (outcome.moves_planned, outcome.moves_executed) == (3, 5)
    assert bench.stacks == REACHED
    assert len({plan.plan_id for plan in bench.plans}) == 2
    assert bench.told[-1].replans == 1


@pytest.mark.parametrize(
    "reason",
    [
        MotionReason.GRASP_LOST,
        MotionReason.TRACKING_LOST,
        MotionReason.TIMEOUT,
        MotionReason.NO_JOINT_STATES,
    ],
)
def test_a_lost_grasp_is_looked_at_and_planned_for_anew(reason: MotionReason) -> None:
    bench = LoopBench(fail(reason, "the block slipped", after=1))
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans, outcome.moves_executed) == (Status.SUCCESS, 1, 3)
    assert Progress(Stage.CONFIRMING, "the block slipped", bench.plans[0]) in [
        Progress(item.stage, item.message, item.plan) for item in bench.told
    ]


def test_replans_are_bounded() -> None:
    lost = fail(MotionReason.GRASP_LOST, "the fingers closed on nothing")
    bench = LoopBench(lost, lost, lost, max_replans=2)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.TOO_MANY_REPLANS, 2)
    assert "red_box blue_box" in outcome.message
    assert "the fingers closed on nothing" in outcome.message
    assert len(bench.plans) == 3


def test_an_infeasible_motion_is_tried_once_more_from_new_poses() -> None:
    sentence = "keyframes: hand to stack1 is 2 mm too close"
    infeasible = fail(MotionReason.INFEASIBLE, sentence)
    bench = LoopBench(infeasible, infeasible)
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.MOTION_FAILED, "motion")
    assert outcome.message.startswith(sentence)
    assert outcome.motion.reason == MotionReason.INFEASIBLE
    assert len(bench.plans) == 2


def test_infeasible_twice_with_something_else_between_is_no_reason_to_give_up() -> None:
    infeasible = fail(MotionReason.INFEASIBLE, "too close")
    bench = LoopBench(infeasible, fail(MotionReason.GRASP_LOST, "slipped"), infeasible)
    assert bench.achieve().status == Status.SUCCESS


@pytest.mark.parametrize(
    ("reason", "status"),
    [
        (MotionReason.INVALID_PLAN, Status.MOTION_FAILED),
        (MotionReason.INTERNAL_ERROR, Status.MOTION_FAILED),
        (MotionReason.BUSY, Status.BUSY),
    ],
)
def test_a_motion_that_fails_for_good_ends_the_loop(reason: MotionReason, status: Status) -> None:
    bench = LoopBench(fail(reason, "it cannot be done"))
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (status, "motion")
    assert outcome.message.startswith("it cannot be done. ")
    assert len(bench.plans) == 1
