# SPDX-License-Identifier: Apache-2.0
"""A block behind a tower of the front row is looked for first: the four nodes in one process."""

from __future__ import annotations

from typing import Any

import pytest
from judge import Judge
from rclpy.parameter import Parameter
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.messages.scene_graph import graph_from_message

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from scene_graph import FRONT, Relation
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
    overrides = [Parameter(name, value=value) for name, value in world.items()]
    ros_context.add(SimNode(context=context, parameter_overrides=overrides))
    for kind in (PerceptionNode, PlannerNode, MotionNode):
        overrides = [Parameter("use_sim_time", value=True)]
        if kind is PerceptionNode:
            overrides.append(Parameter("stack_positions", value=PLACES))
        ros_context.add(kind(context=context, parameter_overrides=overrides))
    judge = ros_context.add(Judge(context=context))
    ros_context.wait_until(lambda: judge.stacks, what="ground truth")
    with PlannerClient(context=context) as planner:
        answers: list[PlanToGoal.Response] = []

        def is_planned() -> bool:
            answers.append(planner.plan(GOAL))
            return bool(answers[-1].status == PlanToGoal.Response.SUCCESS)

        ros_context.wait_until(is_planned, PATIENCE)
        assert "hidden_stack3" in [item.name for item in answers[-1].plan.initial.objects]
        assert answers[-1].message == (
            f"2 moves to look, then '{GOAL}' is planned for: first what hides stack3 is moved "
            "aside (red_box, blue_box, green_box, purple_box on stack0), to see what stands there"
        )
        planner.start(GOAL, timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
    assert result.status == AchieveGoal.Result.SUCCESS, result.message
    assert result.moves_executed == 5
    assert judge.place_of("yellow_box") < 3 <= judge.place_of("red_box")
    # Between the lowest blocks of the rows; red has none beneath it.
    final = graph_from_message(result.final)
    lowest = final.stacks()[judge.place_of("yellow_box")][0]
    assert Relation(lowest, FRONT, "red_box") in final.relations
