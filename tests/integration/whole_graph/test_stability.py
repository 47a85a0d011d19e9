# SPDX-License-Identifier: Apache-2.0
"""A sphere that the camera sees is never put anything on: the four nodes in one process."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import LATCHED

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from scene_graph import UP
from sim_node.node import SimNode

#: How long a thing may take on a machine that has a lot to do [s].
PATIENCE = 120.0
#: The shortest plan for "green on stack1" puts the blue box on the sphere.
LAYOUT = ["green_box", "blue_box", "red_sphere"]
GOAL = "green on stack1"


class Judge(Node):
    """Reads the ground truth, which the nodes under test must not.

    Attributes:
        standing: pairs of what stood on what so far.
        stacks: the newest arrangement; None before the first.
    """

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("judge", **kwargs)
        self.standing: set[tuple[str, str]] = set()
        self.stacks: Any = None
        self.create_subscription(SceneGraph, "sim/ground_truth", self._on_truth, LATCHED)

    def _on_truth(self, message: SceneGraph) -> None:
        graph = graph_from_message(message)
        ups = {(item.subject, item.object) for item in graph.relations if item.predicate == UP}
        self.standing |= ups
        if len(ups) == len(graph.objects):  # none is in the hand
            self.stacks = graph.stacks()


@pytest.mark.timeout(600)
def test_nothing_is_put_on_a_sphere_that_the_camera_sees(ros_context: Any) -> None:
    context = ros_context.context
    ros_context.add(
        SimNode(context=context, parameter_overrides=[Parameter("layout", value=LAYOUT)])
    )
    for kind in (PerceptionNode, PlannerNode, MotionNode):
        overrides = [Parameter("use_sim_time", value=True)]
        ros_context.add(kind(context=context, parameter_overrides=overrides))
    judge = ros_context.add(Judge(context=context))
    ros_context.wait_until(lambda: judge.stacks, what="ground truth")
    with PlannerClient(context=context) as planner:
        answers: list[PlanToGoal.Response] = []

        def is_planned() -> bool:
            answers.append(planner.plan(GOAL))
            return bool(answers[-1].status == PlanToGoal.Response.SUCCESS)

        ros_context.wait_until(is_planned, PATIENCE)
        assert answers[-1].message == (
            "4 moves to 'green_box on stack1'; 2 moves longer than the shortest plan, which "
            "puts blue_box on red_sphere (it would roll off)"
        )
        refused = planner.plan("blue on red")
        assert refused.status == PlanToGoal.Response.UNREACHABLE
        assert "blue_box cannot stand on red_sphere" in refused.message
        planner.start(GOAL, timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
    assert result.status == AchieveGoal.Result.SUCCESS, result.message
    assert "longer than the shortest plan" in result.message
    assert judge.stacks[1][0] == "green_box"
    assert ("red_sphere", "green_box") in judge.standing
    assert not [pair for pair in judge.standing if pair[1] == "red_sphere"]
