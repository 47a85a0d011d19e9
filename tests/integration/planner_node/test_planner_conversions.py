# SPDX-License-Identifier: Apache-2.0
"""Values and messages say the same."""

from __future__ import annotations

from typing import Any

import pytest
from builtin_interfaces.msg import Time
from planner_neighbours import scene_message
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SceneGraph
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.motion_report import MotionReport, MotionState

from planner_node import errors
from planner_node.conversions import (
    FeedbackWriter,
    outcome_to_message,
    plan_to_message,
    predicted_to_messages,
    scene_to_message,
    sighting_from_message,
    stop_to_message,
)
from planner_node.goals import Goal
from planner_node.loop import Outcome, Plan, Progress, Stage, Status, plan_for, scene_in
from planner_node.search import make_plan
from scene_graph import GraphStatus, Relation, Stacks

START: Stacks = (("red_box", "blue_box"), ("green_box",), ())
STAMP = Time(sec=3, nanosec=5)


def plan() -> Plan:
    scene = scene_in(sighting_from_message(scene_message(START, STAMP)))
    goal = Goal((Relation("red_box", "above", "green_box"), Relation("blue_box", "up", "stack2")))
    return plan_for(scene, goal, make_plan(scene.stacks, goal), stamp=7)


def constants(message: Any) -> dict[str, int]:
    """The numbers that an interface file declares."""
    return {
        name: getattr(message, name)
        for name in dir(type(message))
        if name.isupper() and isinstance(getattr(message, name), int)
    }


def test_the_numbers_are_those_of_the_messages() -> None:
    result, feedback = constants(AchieveGoal.Result), constants(AchieveGoal.Feedback)
    response = constants(PlanToGoal.Response)
    assert len(response) == 18
    assert {item.name: item.value for item in Status} == result
    assert {item.name: item.value for item in Stage} == feedback
    assert response.items() <= result.items()


def test_every_error_has_a_status() -> None:
    kinds = [
        kind
        for kind in vars(errors).values()
        if isinstance(kind, type) and issubclass(kind, errors.PlannerError)
    ]
    assert len(kinds) > 15
    assert {kind.status for kind in kinds} <= set(Status.__members__)


def test_a_scene_goes_back_as_it_came() -> None:
    message = scene_message(START, STAMP)
    scene = scene_in(sighting_from_message(message))
    assert scene.stacks == START
    assert scene_to_message(scene) == message


def test_a_sighting_keeps_what_perception_says() -> None:
    message = scene_message(START, STAMP, status=SceneGraph.OCCLUDED, message="a hand")
    sighting = sighting_from_message(message)
    assert (sighting.status, sighting.message) == (GraphStatus.OCCLUDED, "a hand")
    assert (sighting.stamp, sighting.frame_id) == (3_000_000_005, "world")


@pytest.mark.parametrize(
    "fields", [{"status": 200}, {"predicate": "touches"}], ids=["status", "predicate"]
)
def test_a_message_that_cannot_be_read_is_a_defect(fields: dict[str, Any]) -> None:
    message = scene_message(START, STAMP)
    message.status = fields.get("status", 0)
    message.relations[0].predicate = fields.get("predicate", "up")
    with pytest.raises(errors.NotConfidentError, match="contradicts itself"):
        scene_in(sighting_from_message(message))


def test_a_plan_says_what_to_move_from_where() -> None:
    message = plan_to_message(plan())
    assert (message.header.frame_id, message.header.stamp) == ("world", Time(nanosec=7))
    assert message.initial == scene_message(START, STAMP)
    assert [(item.source, item.target, item.object_name) for item in message.moves] == [
        (0, 2, "blue_box"),
        (0, 1, "red_box"),
    ]
    assert [(item.subject, item.predicate, item.object) for item in message.goal] == [
        ("blue_box", "up", "stack2"),
        ("red_box", "above", "green_box"),
    ]


def test_predicted_scenes_have_relations_and_no_poses() -> None:
    first, last = predicted_to_messages(plan())
    expected = scene_message(((), ("green_box", "red_box"), ("blue_box",)), STAMP)
    assert (last.relations, last.bases) == (expected.relations, expected.bases)
    assert [item.name for item in first.objects] == ["blue_box", "green_box", "red_box"]
    assert {(item.label, item.confidence) for item in last.objects} == {(0, 0.0)}
    assert last.header.frame_id == "world"
    assert last.confidence == pytest.approx(0.9)


def test_a_stop_is_the_plan_without_moves() -> None:
    message = stop_to_message("an-id", stamp=9)
    assert (message.plan_id, list(message.moves)) == ("an-id", [])
    assert message.header.stamp == Time(nanosec=9)


def test_fault_12_feedback_carries_a_plan_once_and_then_its_name() -> None:
    writer, value = FeedbackWriter(), plan()
    assert writer.message(Progress(message="reading the goal")).plan.plan_id == ""
    running = MotionReport(value.plan_id, MotionState.EXECUTING, moves_done=1, stamp=4)
    message = writer.message(Progress(Stage.EXECUTING, "moving", value, running, replans=2))
    assert (message.stage, message.message, message.replans) == (3, "moving", 2)
    assert message.plan == plan_to_message(value)
    assert len(message.states) == 2
    assert (message.motion.state, message.motion.moves_done) == (MotionStatus.EXECUTING, 1)
    later = writer.message(Progress(Stage.EXECUTING, "moving", value, running))
    assert (later.plan.plan_id, list(later.plan.moves)) == (value.plan_id, [])
    assert list(later.states) == []
    another = plan()
    assert writer.message(Progress(plan=another)).plan.plan_id == another.plan_id


def test_an_outcome_is_a_result() -> None:
    scene = plan().scene
    message = outcome_to_message(
        Outcome(
            Status.MOTION_FAILED,
            "too close",
            "motion",
            moves_planned=3,
            moves_executed=2,
            replans=1,
            initial=scene,
            motion=MotionReport(state=MotionState.FAILED, message="too close"),
            execute_seconds=2.5,
        )
    )
    assert (message.status, message.message, message.module) == (20, "too close", "motion")
    assert (message.moves_planned, message.moves_executed, message.replans) == (3, 2, 1)
    assert message.initial == scene_to_message(scene)
    assert message.final == SceneGraph()
    assert message.motion.state == MotionStatus.FAILED
    assert message.execute_seconds == 2.5
