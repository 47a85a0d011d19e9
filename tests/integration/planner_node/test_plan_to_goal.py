# SPDX-License-Identifier: Apache-2.0
"""plan_to_goal as a service: requests and answers over the wire, and the node's parameters."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from planner_neighbours import run_until_stopped, scene_message
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from tamp_interfaces.msg import MotionStatus, Relation, SceneGraph
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.messages.images import image_from_array

from planner_node.cli.write_pddl import write_pddl
from planner_node.node import PlannerNode

Status = PlanToGoal.Response

IMAGE = image_from_array(np.zeros((4, 4, 3), np.uint8), "rgb8", Header())
SEGMENTATION = image_from_array(np.zeros((4, 4), np.uint16), "16UC1", Header())


@pytest.fixture
def bench(make_bench: Any) -> Any:
    bench = make_bench()
    bench.wait_for_scene()
    return bench


def test_a_plan_comes_with_its_moves_and_predicted_scenes(bench: Any) -> None:
    answer = bench.client.plan("red on green, blue on stack2")
    assert (answer.status, answer.message) == (
        Status.SUCCESS,
        "2 moves to 'red_box on green_box, blue_box on stack2'",
    )
    moves = [(move.source, move.target, move.object_name) for move in answer.plan.moves]
    assert moves == [(0, 2, "blue_box"), (0, 1, "red_box")]
    assert answer.plan.goal == [
        Relation(subject="blue_box", predicate="up", object="stack2"),
        Relation(subject="red_box", predicate="up", object="green_box"),
    ]
    assert answer.plan.initial.objects == scene_message(bench.world.stacks, Time()).objects
    assert answer.plan.plan_id
    assert answer.plan.header.stamp.sec > 0
    last = scene_message(((), ("green_box", "red_box"), ("blue_box",)), Time())
    assert [item.name for item in answer.states[-1].objects] == [x.name for x in last.objects]
    assert answer.states[-1].relations == last.relations
    assert answer.states[-1].bases == last.bases
    assert len(answer.states) == 2
    assert answer.expanded > 0
    assert answer.planning_seconds > 0.0


def test_the_goal_is_published_as_it_was_asked_for(bench: Any) -> None:
    answer = bench.client.plan("green above red, blue right of red")
    assert answer.plan.goal == [
        Relation(subject="green_box", predicate=Relation.ABOVE, object="red_box"),
        Relation(subject="red_box", predicate=Relation.LEFT, object="blue_box"),
    ]


@pytest.mark.parametrize(
    ("goal", "wanted"),
    [
        ("swap red and blue", {("red_box", "blue_box"), ("blue_box", "stack0"),
                               ("green_box", "stack1")}),
        ("put green where blue is", {("green_box", "red_box")}),
        ("red on the other stack", set()),
    ],
)  # fmt: skip
def test_a_goal_may_depend_on_how_the_blocks_stand(
    bench: Any, goal: str, wanted: set[tuple[str, str]]
) -> None:
    assert bench.world.stacks == (("red_box", "blue_box"), ("green_box",), ())
    answer = bench.client.plan(goal)
    if not wanted:  # there are two others
        assert answer.status == Status.AMBIGUOUS_OBJECT
        assert "stack1, stack2" in answer.message
        return
    assert answer.status == Status.SUCCESS, answer.message
    assert {(item.subject, item.object) for item in answer.plan.goal} == wanted
    last = {(item.subject, item.object) for item in answer.states[-1].relations}
    assert wanted <= last


def test_planning_alone_moves_nothing(bench: Any) -> None:
    bench.client.plan("red on green")
    answer = bench.client.plan("blue on green", execute=True)
    bench.ros.wait_until(lambda: bench.motion.plans)
    assert [plan.plan_id for plan in bench.motion.plans] == [answer.plan.plan_id]
    assert "published" in answer.message


def test_a_goal_that_holds_is_already_true_and_nothing_is_published(bench: Any) -> None:
    answer = bench.client.plan("blue on red", execute=True)
    assert (answer.status, list(answer.plan.moves)) == (Status.ALREADY_TRUE, [])
    assert bench.client.plan("green on blue", execute=True).status == Status.SUCCESS
    bench.ros.wait_until(lambda: bench.motion.plans)
    assert (len(bench.motion.plans), bench.motion.stops) == (1, [])


@pytest.mark.parametrize(
    ("goal", "status", "sentence"),
    [
        ("red on blue, green", Status.INVALID_GOAL, "offset 13 ('green')"),
        ("red on purple", Status.UNKNOWN_OBJECT, "blue_box, green_box, red_box"),
        ("red on stack3", Status.UNKNOWN_OBJECT, "there is no place 'stack3'"),
    ],
)
def test_a_bad_goal_is_refused_with_a_sentence(
    bench: Any, goal: str, status: int, sentence: str
) -> None:
    answer = bench.client.plan(goal, execute=True)
    assert answer.status == status
    assert sentence in answer.message
    assert bench.motion.plans == []


def test_another_planners_plan_is_checked_and_carried_out(bench: Any) -> None:
    there = "(move blue_box red_box stack2)\n(move red_box stack0 green_box)"
    answer = bench.client.plan("red on green", plan=there, execute=True)
    assert (answer.status, len(answer.plan.moves), answer.expanded) == (Status.SUCCESS, 2, 0)
    bench.ros.wait_until(lambda: bench.motion.plans)
    assert [(item.source, item.target) for item in bench.motion.plans[0].moves] == [(0, 2), (0, 1)]


def test_another_planners_plan_needs_no_goal(bench: Any) -> None:
    answer = bench.client.plan(plan="0 2")
    assert answer.status == Status.SUCCESS
    wanted = [(item.subject, item.object) for item in answer.plan.goal]
    assert ("blue_box", "stack2") in wanted


def test_another_planners_plan_is_refused_with_its_step(bench: Any) -> None:
    answer = bench.client.plan("red on green", plan="(0, 2)\n(0, 2)", execute=True)
    assert answer.status == Status.INVALID_PLAN
    assert "after the last move 'red_box on green_box' is not true" in answer.message
    answer = bench.client.plan("red on green", plan="(1, 2)\n(1, 0)", execute=True)
    assert "step 2 of the plan, '(1, 0)': stack1 is empty" in answer.message
    assert bench.motion.plans == []


@pytest.mark.parametrize("algorithm", ["auto", "breadth_first", "both_ends", "a_star"])
def test_the_search_can_be_changed_while_the_node_runs(bench: Any, algorithm: str) -> None:
    bench.set(search_algorithm=algorithm)
    answer = bench.client.plan("red on green, blue on red")
    assert (answer.status, len(answer.plan.moves)) == (Status.SUCCESS, 3)
    bench.set(max_expansions=1)
    answer = bench.client.plan("red on green, blue on red, blue above stack2")
    assert (answer.status, answer.expanded) == (Status.SEARCH_LIMIT, 1)


def test_without_a_scene_graph_there_is_no_plan(make_bench: Any) -> None:
    bench = make_bench(use_sim_time=True)
    bench.ros.wait_until(lambda: "clock" in bench.client.plan("red on blue").message)
    assert bench.client.plan("red on blue").status == Status.NO_SCENE_GRAPH


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (
            {"status": SceneGraph.OCCLUDED, "message": "the arm hides stack1"},
            "the arm hides stack1",
        ),
        ({"relations": [Relation(predicate="touches")]}, "unknown predicate 'touches'"),
    ],
)
def test_a_scene_that_cannot_be_trusted_is_not_planned_on(
    bench: Any, fault: dict[str, Any], sentence: str
) -> None:
    bench.perception.fault = fault
    bench.ros.wait_until(lambda: bench.client.plan("red on green").status != Status.SUCCESS)
    answer = bench.client.plan("red on green", execute=True)
    assert answer.status == Status.NOT_CONFIDENT
    assert sentence in answer.message
    bench.perception.fault = {}
    bench.ros.wait_until(lambda: bench.client.plan("red on green").status == Status.SUCCESS)


def test_a_motion_status_that_makes_no_sense_is_passed_over(bench: Any) -> None:
    bench.motion.report("foreign", 99)
    bench.motion.report("foreign", MotionStatus.EXECUTING)
    bench.ros.wait_until(lambda: bench.client.plan("red on green").status == Status.BUSY)


def test_a_goal_image_is_a_complete_goal(bench: Any) -> None:
    bench.perception.serve_images()
    target = (("green_box",), ("blue_box",), ("red_box",))
    bench.perception.shown = scene_message(target, Time())
    answer = bench.client.plan(goal_image=IMAGE, goal_segmentation=SEGMENTATION)
    assert answer.status == Status.SUCCESS
    assert answer.states[-1].relations == scene_message(target, Time()).relations


@pytest.mark.parametrize(
    ("shown", "sentences"),
    [
        (
            scene_message((("red_box",), ("pink_box",), ()), Time()),
            ("blue_box, green_box missing in the image", "pink_box not in the scene"),
        ),
        (SceneGraph(status=SceneGraph.BAD_IMAGE, message="image is 4x4"), ("image is 4x4",)),
        (None, ("within 0.2 s", "perception_node")),
    ],
)
def test_a_goal_image_that_does_not_fit_is_rejected(
    bench: Any, shown: SceneGraph | None, sentences: tuple[str, ...]
) -> None:
    if shown is None:
        bench.set(image_service_timeout=0.2)
    bench.perception.serve_images()
    bench.perception.shown = shown
    answer = bench.client.plan(goal_image=IMAGE, goal_segmentation=SEGMENTATION)
    assert answer.status == Status.GOAL_IMAGE_REJECTED
    assert all(sentence in answer.message for sentence in sentences)
    bench.perception.released.set()


def test_a_goal_image_without_perception_is_rejected(bench: Any) -> None:
    bench.set(image_service_timeout=0.2)
    answer = bench.client.plan(goal_image=IMAGE, goal_segmentation=Image())
    assert answer.status == Status.GOAL_IMAGE_REJECTED
    assert "is perception_node running?" in answer.message


def test_text_and_image_together_are_refused(bench: Any) -> None:
    answer = bench.client.plan("red on blue", goal_image=IMAGE, goal_segmentation=SEGMENTATION)
    assert answer.status == Status.INVALID_GOAL


def test_while_a_plan_is_carried_out_the_planner_is_busy(make_bench: Any) -> None:
    bench = make_bench(run_until_stopped)
    bench.wait_for_scene()
    plan = bench.client.plan("red on green", execute=True).plan
    answer = bench.client.plan("blue on green")
    assert answer.status == Status.BUSY
    assert plan.plan_id in answer.message
    bench.motion.stop_requested.set()
    bench.ros.wait_until(lambda: bench.client.plan("blue on green").status == Status.SUCCESS)
    assert len(bench.motion.plans) == 1


def test_a_scene_from_before_the_last_motion_is_not_planned_on(bench: Any) -> None:
    bench.perception.silent = True
    bench.motion.report("foreign", MotionStatus.SUCCEEDED)
    bench.ros.wait_until(lambda: "last motion" in bench.client.plan("red on green").message)
    bench.perception.silent = False
    bench.ros.wait_until(lambda: bench.client.plan("red on green").status == Status.SUCCESS)


def test_a_defect_is_reported_and_the_node_lives_on(
    bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def defect(*_: Any) -> None:
        raise ZeroDivisionError("of all things")

    with monkeypatch.context() as patch:
        patch.setattr("planner_node.node.plan_in", defect)
        answer = bench.client.plan("red on green")
    assert answer.status == Status.INTERNAL_ERROR
    assert "ZeroDivisionError: of all things" in answer.message
    assert bench.client.plan("red on green").status == Status.SUCCESS


@pytest.mark.parametrize(
    ("name", "value"),
    [("max_expansions", 0), ("search_algorithm", "magic"), ("perceive_timeout", -1.0)],
)
def test_parameters_out_of_range_are_refused(
    ros_context: Any, bench: Any, name: str, value: Any
) -> None:
    result = bench.planner.set_parameters([Parameter(name, value=value)])[0]
    assert not result.successful
    assert name in result.reason
    with pytest.raises(ValueError, match=name):
        PlannerNode(context=ros_context.context, parameter_overrides=[Parameter(name, value=value)])


def test_what_the_camera_sees_is_written_for_other_planners(
    bench: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    """The command's own context is that of the bench, whose nodes it then hears."""
    monkeypatch.setattr("planner_node.cli.write_pddl.prepare", lambda _arguments: None)
    monkeypatch.setattr("planner_node.cli.write_pddl.rclpy.try_shutdown", lambda: None)
    monkeypatch.setattr(
        "planner_node.cli.write_pddl.Node", partial(Node, context=bench.ros.context)
    )
    arguments = ["write_pddl", "red on green", "--out", str(tmp_path), "--timeout", "60"]
    assert write_pddl(arguments) == 0
    assert "(on blue_box red_box)" in (tmp_path / "problem.pddl").read_text()
