# SPDX-License-Identifier: Apache-2.0
"""achieve_goal as an action: goal, feedback, result and cancellation over the wire.

What the closed loop does with neighbours that misbehave is told by its unit tests.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from planner_neighbours import PERIOD, run_until_stopped, scene_message
from std_msgs.msg import Header
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus
from tamp_runtime.messages.images import image_from_array

Status = AchieveGoal.Result
Stage = AchieveGoal.Feedback

GOAL = "red on green, blue on red"
REACHED = ((), ("green_box", "red_box", "blue_box"), ())
IMAGE = image_from_array(np.zeros((4, 4, 3), np.uint8), "rgb8", Header())
SEGMENTATION = image_from_array(np.zeros((4, 4), np.uint16), "16UC1", Header())


def test_the_camera_confirms_the_goal(make_bench: Any) -> None:
    bench = make_bench()
    initial = bench.world.stacks
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.SUCCESS, "")
    assert "the camera confirms" in result.message
    assert bench.world.stacks == REACHED
    assert (result.moves_planned, result.moves_executed, result.replans) == (3, 3, 0)
    assert result.initial.relations == scene_message(initial, Time()).relations
    assert result.final.relations == scene_message(REACHED, Time()).relations
    assert result.motion.state == MotionStatus.SUCCEEDED
    assert result.motion_seconds == pytest.approx(0.01)
    (plan,) = bench.motion.plans
    assert plan.initial == result.initial
    assert [move.object_name for move in plan.moves] == ["blue_box", "red_box", "blue_box"]
    assert plan.header.stamp.sec > 0
    assert plan.header.frame_id == "world"


def test_feedback_comes_with_the_plan_and_its_scenes(make_bench: Any) -> None:
    bench = make_bench(run_until_stopped)
    bench.client.start(GOAL)
    seen = bench.feedback_until(lambda item: item.stage == Stage.EXECUTING)
    stages = list(dict.fromkeys(item.stage for item in seen))
    assert stages == [Stage.PERCEIVING, Stage.PLANNING, Stage.OPTIMISING, Stage.EXECUTING]
    assert seen[0].plan.plan_id == ""
    full = [item for item in seen if item.plan.moves]
    assert [item.plan for item in full] == [bench.motion.plans[0]]
    assert len(full[0].states) == 3
    assert seen[-1].plan.plan_id == bench.motion.plans[0].plan_id
    assert seen[-1].message
    assert seen[-1].motion.state == MotionStatus.EXECUTING
    bench.motion.stop_requested.set()
    assert bench.client.result(60.0).status == Status.CANCELLED


def test_cancelling_waits_until_the_arm_rests(make_bench: Any) -> None:
    bench = make_bench(run_until_stopped)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.EXECUTING)
    bench.client.cancel()
    result = bench.client.result(60.0)
    assert (result.status, result.module) == (Status.CANCELLED, "")
    assert "1 of 3 moves" in result.message
    assert "put red_box down first" in result.message
    assert result.motion.state == MotionStatus.CANCELLED
    (stop,) = bench.motion.stops
    assert (stop.plan_id, list(stop.moves)) == (bench.motion.plans[0].plan_id, [])
    assert stop.header.stamp.sec > 0
    assert bench.achieve("green on stack2").status == Status.SUCCESS


def test_cancelling_while_a_goal_image_is_interpreted(make_bench: Any) -> None:
    bench = make_bench()
    bench.perception.serve_images()
    bench.client.start(goal_image=IMAGE)
    bench.ros.wait_until(lambda: bench.perception.requests)
    bench.client.cancel()
    assert bench.client.result(60.0).status == Status.CANCELLED
    bench.perception.released.set()


def test_a_goal_image_is_achieved(make_bench: Any) -> None:
    bench = make_bench()
    bench.perception.serve_images()
    bench.perception.shown = scene_message(REACHED, Time())
    bench.client.start(goal_image=IMAGE, goal_segmentation=SEGMENTATION)
    assert bench.client.result(60.0).status == Status.SUCCESS
    assert bench.world.stacks == REACHED


def test_a_failure_names_the_module(make_bench: Any) -> None:
    bench = make_bench()
    result = bench.achieve("red left of blue, blue left of red")
    assert (result.status, result.module) == (Status.CONTRADICTORY_GOAL, "planner")
    assert "left of itself" in result.message
    assert bench.motion.plans == []


def test_without_a_motion_node_nobody_hears_the_plan(
    make_bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("planner_node.loop.execution.DISCOVERY_SECONDS", PERIOD)
    bench = make_bench(with_motion=False)
    result = bench.achieve(GOAL)
    assert result.status == Status.MOTION_SILENT
    assert "nobody subscribes to symbolic_plan" in result.message


def test_a_second_goal_gets_busy_and_a_sentence(make_bench: Any) -> None:
    bench = make_bench(run_until_stopped)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.EXECUTING)
    answer = bench.client.plan("red on blue")
    assert answer.status == answer.BUSY
    assert GOAL in answer.message
    first = bench.client._result
    second = bench.achieve("red on blue")
    assert second.status == Status.BUSY
    assert GOAL in second.message
    assert not first.done()
    bench.motion.stop_requested.set()
    bench.ros.wait_until(first.done)


def test_a_defect_while_the_arm_moves_stops_it(
    make_bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def defect(*_: Any) -> None:
        raise ZeroDivisionError("of all things")

    bench = make_bench(run_until_stopped)
    with monkeypatch.context() as patch:
        patch.setattr("planner_node.loop.plan_run.PlanRun._on_report", defect)
        result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.INTERNAL_ERROR, "planner")
    assert "ZeroDivisionError" in result.message
    assert result.moves_planned == 3
    bench.ros.wait_until(lambda: bench.motion.stops)
    bench.ros.wait_until(lambda: bench.client.plan("red on blue").status == 0)
