# SPDX-License-Identifier: Apache-2.0
"""achieve_goal: the closed loop against a perception and a motion node that misbehave."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from planner_neighbours import (
    PERIOD,
    FakeMotion,
    fail,
    ignore,
    knock,
    obey,
    run_until_stopped,
    scene_message,
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
    assert min(result.perceive_seconds, result.plan_seconds, result.execute_seconds) > 0.0


def test_the_plan_carries_the_scene_it_starts_from(make_bench: Any) -> None:
    bench = make_bench()
    result = bench.achieve(GOAL)
    (plan,) = bench.motion.plans
    assert plan.initial == result.initial
    assert [move.object_name for move in plan.moves] == ["blue_box", "red_box", "blue_box"]
    assert plan.header.stamp.sec > 0
    assert plan.header.frame_id == "world"


def test_feedback_tells_every_stage_in_order(make_bench: Any) -> None:
    bench = make_bench()
    bench.client.start(GOAL)
    seen = bench.feedback_until(lambda item: item.stage == Stage.CONFIRMING)
    stages = list(dict.fromkeys(item.stage for item in seen))
    expected = [Stage.PERCEIVING, Stage.PLANNING, Stage.OPTIMISING, Stage.EXECUTING]
    assert stages == [*expected, Stage.CONFIRMING]
    moving = [item for item in seen if item.stage == Stage.EXECUTING]
    assert moving[-1].motion.moves_done == 3
    assert len(moving[-1].states) == len(moving[-1].plan.moves) == 3
    bench.client.result(5.0)


def test_a_goal_that_holds_moves_nothing(make_bench: Any) -> None:
    bench = make_bench()
    result = bench.achieve("blue on red")
    assert (result.status, result.moves_planned, result.replans) == (Status.ALREADY_TRUE, 0, 0)
    assert bench.motion.plans == []


def test_a_goal_image_is_achieved(make_bench: Any) -> None:
    bench = make_bench()
    bench.perception.serve_images()
    bench.perception.shown = scene_message(REACHED, Time())
    bench.client.start(
        goal_image=image_from_array(np.zeros((4, 4, 3), np.uint8), "rgb8", Header()),
        goal_segmentation=image_from_array(np.zeros((4, 4), np.uint16), "16UC1", Header()),
    )
    assert bench.client.result(10.0).status == Status.SUCCESS
    assert bench.world.stacks == REACHED


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
def test_a_bad_goal_moves_nothing(make_bench: Any, goal: str, status: int) -> None:
    bench = make_bench()
    result = bench.achieve(goal)
    assert (result.status, result.module) == (status, "planner")
    assert result.message
    assert bench.motion.plans == []


def test_the_bound_on_the_search_ends_the_loop(make_bench: Any) -> None:
    bench = make_bench(max_expansions=1)
    assert bench.achieve("red on green, blue on red").status == Status.SEARCH_LIMIT


def test_what_two_stacks_cannot_reach_is_reported(make_bench: Any) -> None:
    bench = make_bench()
    bench.world.stacks = (("red_box", "blue_box", "green_box"), ())
    bench.ros.wait_until(lambda: "stack2 does" in bench.client.plan("red on stack2").message)
    assert bench.achieve("red on blue, blue on stack1").status == Status.UNREACHABLE


def test_without_a_scene_graph_perception_is_named(make_bench: Any) -> None:
    bench = make_bench(perceive_timeout=1.0, graph_max_age=0.2)
    bench.perception.silent = True
    result = bench.achieve(GOAL)
    assert result.status in (Status.NO_SCENE_GRAPH, Status.NOT_CONFIDENT)
    assert result.module == "perception"


def test_a_scene_that_stays_hidden_is_reported_in_perceptions_words(make_bench: Any) -> None:
    bench = make_bench(perceive_timeout=1.0)
    bench.perception.fault = {"status": SceneGraph.OCCLUDED, "message": "a hand hides stack0"}
    bench.ros.wait_until(lambda: "a hand" in bench.client.plan("red on blue").message)
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.NOT_CONFIDENT, "perception")
    assert "a hand hides stack0" in result.message


def test_a_scene_that_is_hidden_for_a_while_is_waited_for(make_bench: Any) -> None:
    bench = make_bench(perceive_timeout=10.0)
    bench.perception.fault = {"status": SceneGraph.OCCLUDED}
    bench.ros.wait_until(lambda: "OCCLUDED" in bench.client.plan("red on blue").message)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: "scene graph" in item.message)
    bench.perception.fault = {}
    assert bench.client.result(10.0).status == Status.SUCCESS


def test_the_motion_is_confirmed_by_a_later_image_only(make_bench: Any) -> None:
    def obey_blindly(motion: FakeMotion, plan: SymbolicPlan) -> None:
        bench.perception.silent = True
        obey(motion, plan)

    bench = make_bench(obey_blindly, perceive_timeout=1.0)
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.NOT_CONFIDENT, "perception")
    assert "before the last motion" in result.message
    assert result.moves_executed == 3


def test_a_knocked_block_is_planned_for_anew(make_bench: Any) -> None:
    bench = make_bench(knock((("blue_box",), ("green_box",), ("red_box",))))
    result = bench.achieve(GOAL)
    assert (result.status, result.replans) == (Status.SUCCESS, 1)
    assert (result.moves_planned, result.moves_executed) == (3, 5)
    assert bench.world.stacks == REACHED
    assert len({plan.plan_id for plan in bench.motion.plans}) == 2


@pytest.mark.parametrize(
    "reason", [MotionStatus.GRASP_LOST, MotionStatus.TRACKING_LOST, MotionStatus.TIMEOUT]
)
def test_a_lost_grasp_is_looked_at_and_planned_for_anew(make_bench: Any, reason: int) -> None:
    bench = make_bench(fail(reason, "the block slipped", after=1))
    result = bench.achieve(GOAL)
    assert (result.status, result.replans) == (Status.SUCCESS, 1)
    assert result.moves_executed == 3


def test_replans_are_bounded(make_bench: Any) -> None:
    bench = make_bench(
        *[fail(MotionStatus.GRASP_LOST, "the fingers closed on nothing")] * 3, max_replans=2
    )
    result = bench.achieve(GOAL)
    assert (result.status, result.replans) == (Status.TOO_MANY_REPLANS, 2)
    assert "red_box blue_box" in result.message
    assert "the fingers closed on nothing" in result.message
    assert len(bench.motion.plans) == 3


def test_an_infeasible_motion_is_tried_once_more_from_new_poses(make_bench: Any) -> None:
    sentence = "keyframes: hand to stack1 is 2 mm too close"
    bench = make_bench(*[fail(MotionStatus.INFEASIBLE, sentence)] * 2)
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.MOTION_FAILED, "motion")
    assert result.message == sentence
    assert result.motion.reason == MotionStatus.INFEASIBLE
    assert len(bench.motion.plans) == 2


def test_a_second_look_can_make_a_motion_feasible(make_bench: Any) -> None:
    bench = make_bench(fail(MotionStatus.INFEASIBLE, "too close"))
    assert bench.achieve(GOAL).status == Status.SUCCESS


@pytest.mark.parametrize(
    ("reason", "status"),
    [
        (MotionStatus.INVALID_PLAN, Status.MOTION_FAILED),
        (MotionStatus.NO_JOINT_STATES, Status.MOTION_FAILED),
        (MotionStatus.INTERNAL_ERROR, Status.MOTION_FAILED),
        (MotionStatus.BUSY, Status.BUSY),
    ],
)
def test_a_motion_that_fails_for_good_ends_the_loop(
    make_bench: Any, reason: int, status: int
) -> None:
    bench = make_bench(fail(reason, "no joint states arrive"))
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (status, "motion")
    assert result.message == "no joint states arrive"
    assert len(bench.motion.plans) == 1


@pytest.mark.parametrize("behaviour", [ignore, take_up_and_die])
def test_a_silent_motion_node_is_named_and_told_to_stop(make_bench: Any, behaviour: Any) -> None:
    bench = make_bench(behaviour, motion_accept_timeout=1.0, motion_silence_timeout=1.0)
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.MOTION_SILENT, "motion")
    assert "is motion_node running?" in result.message
    bench.ros.wait_until(lambda: bench.motion.stops)
    assert bench.motion.stops[0].plan_id == bench.motion.plans[0].plan_id
    bench.set(motion_accept_timeout=10.0, motion_silence_timeout=10.0)
    assert bench.achieve(GOAL).status == Status.SUCCESS


def test_a_restarted_motion_node_has_lost_the_plan(make_bench: Any) -> None:
    def restart(motion: FakeMotion, plan: SymbolicPlan) -> None:
        motion.report(plan.plan_id, MotionStatus.EXECUTING)
        while not motion.stop_requested.wait(PERIOD) and motion.context.ok():
            motion.report("", MotionStatus.IDLE)

    bench = make_bench(restart)
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.MOTION_SILENT, "motion")
    assert "restarted" in result.message
    assert bench.achieve(GOAL).status == Status.SUCCESS


def test_without_a_motion_node_the_plan_is_given_up_soon(
    make_bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("planner_node.loop.motion_link.DISCOVERY_SECONDS", 1.0)
    bench = make_bench()
    bench.ros.remove(bench.motion)
    result = bench.achieve(GOAL, timeout=10.0)
    assert result.status == Status.MOTION_SILENT
    assert "nobody subscribes to symbolic_plan" in result.message


def test_the_scene_is_looked_at_after_the_request(make_bench: Any) -> None:
    bench = make_bench(perceive_timeout=1.0)
    bench.wait_for_scene()
    bench.perception.silent = True
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.NOT_CONFIDENT, "perception")
    assert "before the last motion or the request" in result.message


def test_an_idle_report_before_the_plan_is_taken_up_means_nothing(make_bench: Any) -> None:
    def start_late(motion: FakeMotion, plan: SymbolicPlan) -> None:
        motion.report("", MotionStatus.IDLE)
        obey(motion, plan)

    assert make_bench(start_late).achieve(GOAL).status == Status.SUCCESS


def test_a_motion_that_somebody_else_stops_ends_the_loop(make_bench: Any) -> None:
    bench = make_bench(run_until_stopped)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.EXECUTING)
    bench.motion.stop_requested.set()
    result = bench.client.result(5.0)
    assert result.status == Status.CANCELLED
    assert "somebody else" in result.message


def test_a_block_of_the_goal_that_disappears_is_named(make_bench: Any) -> None:
    bench = make_bench(knock((("red_box",), ("green_box",), ())), perceive_timeout=1.0)
    result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.UNKNOWN_OBJECT, "perception")
    assert "blue_box cannot be seen any more" in result.message


def test_a_block_that_disappears_for_a_moment_is_waited_for(make_bench: Any) -> None:
    bench = make_bench(knock((("red_box",), ("green_box",), ())))
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == Stage.CONFIRMING)
    bench.world.stacks = REACHED
    assert bench.client.result(10.0).status == Status.SUCCESS


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
        patch.setattr("planner_node.loop.ClosedLoop._on_report", defect)
        result = bench.achieve(GOAL)
    assert (result.status, result.module) == (Status.INTERNAL_ERROR, "planner")
    assert "ZeroDivisionError" in result.message
    assert result.moves_planned == 3
    bench.ros.wait_until(lambda: bench.motion.stops)
    bench.ros.wait_until(lambda: bench.client.plan("red on blue").status == 0)
