# SPDX-License-Identifier: Apache-2.0
"""A block behind a tower of the front row is looked for first: the four nodes in one process."""

from __future__ import annotations

from typing import Any

import pytest
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
from sim_node.node import SimNode

#: How long a thing may take on a machine that has a lot to do [s].
PATIENCE = 120.0
#: The yellow box stands behind a tower of four, which hides all of it.
LAYOUT = ["red_box,blue_box,green_box,purple_box", "", "", "yellow_box", "", ""]
PLACES = [0.58, -0.15, 0.0, 0.58, 0.0, 0.0, 0.58, 0.15, 0.0,
          0.42, -0.15, 0.0, 0.42, 0.0, 0.0, 0.42, 0.15, 0.0]  # fmt: skip
GOAL = "yellow in front of red"


@pytest.mark.timeout(600)
def test_a_hidden_block_is_uncovered_and_then_moved(ros_context: Any) -> None:
    context = ros_context.context
    world = {"scene": "two_rows", "layout": LAYOUT}
    ros_context.add(
        SimNode(
            context=context,
            parameter_overrides=[Parameter(name, value=value) for name, value in world.items()],
        )
    )
    for kind in (PerceptionNode, PlannerNode, MotionNode):
        own = {"stack_positions": PLACES} if kind is PerceptionNode else {}
        overrides = [
            Parameter(name, value=value) for name, value in {"use_sim_time": True, **own}.items()
        ]
        ros_context.add(kind(context=context, parameter_overrides=overrides))
    truths: list[SceneGraph] = []
    graphs: list[SceneGraph] = []
    ears = ros_context.listener if hasattr(ros_context, "listener") else None
    del ears
    with PlannerClient(context=context) as planner:
        planner_node = planner.node if hasattr(planner, "node") else None
        del planner_node, truths, graphs
        answers: list[PlanToGoal.Response] = []

        def is_planned() -> bool:
            answers.append(planner.plan(GOAL))
            return bool(answers[-1].status == PlanToGoal.Response.SUCCESS)

        ros_context.wait_until(is_planned, PATIENCE)
        print(answers[-1].message)
        planner.start(GOAL, timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
    print(result)
    assert result.status == AchieveGoal.Result.SUCCESS, result.message
    graph_from_message(result.final)
