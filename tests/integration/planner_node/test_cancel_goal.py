# SPDX-License-Identifier: Apache-2.0
"""Cancelling achieve_goal in every phase: a typed result, and nothing is left moving."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from planner_neighbours import (
    FakeMotion,
    ignore,
    obey,
    run_until_stopped,
    take_up_and_die,
)
from std_msgs.msg import Header
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SceneGraph, SymbolicPlan
from tamp_runtime.messages.images import image_from_array

Status = AchieveGoal.Result
Stage = AchieveGoal.Feedback

GOAL = "red on green, blue on red"
REACHED = ((), ("green_box", "red_box", "blue_box"), ())


def test_cancel_while_perceiving(make_bench: Any) -> None:
    bench = make_bench()
    bench.perception.fault = {"status": SceneGraph.OCCLUDED}
    bench.ros.wait_until(lambda: "OCCLUDED" in bench.client.plan("red on blue").message)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: "scene graph" in item.message)
    bench.client.cancel()
    result = bench.client.result(2.0)
    assert result.status == Status.CANCELLED
    assert (bench.motion.plans, bench.motion.stops) == ([], [])


def test_cancel_while_a_goal_image_is_interpreted(make_bench: Any) -> None:
    bench = make_bench()
    bench.perception.serve_images()
    image = image_from_array(np.zeros((4, 4, 3), np.uint8), "rgb8", Header())
    bench.client.start(goal_image=image)
    bench.feedback_until(lambda item: item.stage == Stage.PERCEIVING)
    bench.client.cancel()
    assert bench.client.result(2.0).status == Status.CANCELLED
    bench.perception.released.set()


def test_cancel_while_planning(make_bench: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    bench = make_bench()
    names = [f"{color}_box" for color in ("red", "blue", "green", "cyan", "pink", "brown")]
    bench.world.stacks = ((*names, "orange_box", "purple_box"), (), ())
    bench.ros.wait_until(lambda: "brown" in bench.client.plan("red on white").message)
    # No state fulfils this, and all blocks are mentioned: the search has 1.8 million states.
    circle = zip((*names, "orange_box"), (*names[1:], "orange_box", "red_box"))
    monkeypatch.setattr("planner_node.search.plan.check_contradictions", lambda *_: None)
    bench.client.start(", ".join(f"{a} on {b}" for a, b in circle))
    bench.feedback_until(lambda item: item.stage == Stage.PLANNING)
    bench.client.cancel()
    result = bench.client.result(3.0)
    assert result.status == Status.CANCELLED
    assert "search was cancelled" in result.message
    assert bench.motion.plans == []


def test_cancel_while_the_arm_moves_waits_until_it_rests(make_bench: Any) -> None:
    bench = make_bench(run_until_stopped)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.EXECUTING)
    bench.client.cancel()
    bench.feedback_until(lambda item: item.stage == Stage.CANCELLING)
    result = bench.client.result(5.0)
    assert (result.status, result.module) == (Status.CANCELLED, "")
    assert "1 of 3 moves" in result.message
    assert "put red_box down first" in result.message
    assert result.motion.state == MotionStatus.CANCELLED
    (stop,) = bench.motion.stops
    assert stop.plan_id == bench.motion.plans[0].plan_id
    assert list(stop.moves) == []
    assert bench.achieve("green on stack2").status == Status.SUCCESS


def test_cancel_before_the_motion_node_answers(make_bench: Any) -> None:
    bench = make_bench(ignore, motion_accept_timeout=1.0)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.OPTIMISING)
    bench.client.cancel()
    result = bench.client.result(5.0)
    assert result.status == Status.CANCELLED
    assert "before anything moved" in result.message


def test_cancel_of_a_motion_that_fell_silent_says_so(make_bench: Any) -> None:
    bench = make_bench(take_up_and_die, motion_silence_timeout=2.0)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.EXECUTING)
    bench.client.cancel()
    assert bench.client.result(5.0).status == Status.MOTION_SILENT


def test_cancel_while_confirming(make_bench: Any) -> None:
    def obey_blindly(motion: FakeMotion, plan: SymbolicPlan) -> None:
        bench.perception.silent = True
        obey(motion, plan)

    bench = make_bench(obey_blindly)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.CONFIRMING)
    bench.client.cancel()
    result = bench.client.result(2.0)
    assert (result.status, result.moves_executed) == (Status.CANCELLED, 3)
    assert bench.motion.stops == []
