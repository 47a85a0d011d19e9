# SPDX-License-Identifier: Apache-2.0
"""A block between two colours is no reason to refuse: the four nodes in one process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from judge import Judge
from rclpy.parameter import Parameter
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from sim_node.node import SimNode

#: How long a thing may take on a machine that has a lot to do [s].
PATIENCE = 120.0
LAYOUT = ["blue_box,orange_box", "green_box", "yellow_box"]
#: The orange one came out about half as red as red.
SCENE = "blocks: {named: {orange_box: {paint: [0.92, 0.32, 0.07]}}}"
ASKED = "orange on green"


@pytest.mark.timeout(900)
def test_what_is_right_whatever_a_block_is_called_is_done_and_what_is_not_is_asked(
    ros_context: Any, tmp_path: Path
) -> None:
    context = ros_context.context
    (scene := tmp_path / "between.yaml").write_text(SCENE)
    world = {"scene": str(scene), "layout": LAYOUT}
    overrides = [Parameter(name, value=value) for name, value in world.items()]
    ros_context.add(SimNode(context=context, parameter_overrides=overrides))
    for kind in (PerceptionNode, PlannerNode, MotionNode):
        follow_clock = [Parameter("use_sim_time", value=True)]
        ros_context.add(kind(context=context, parameter_overrides=follow_clock))
    judge = ros_context.add(Judge(context=context))
    ros_context.wait_until(lambda: judge.stacks, what="ground truth")
    with PlannerClient(context=context) as planner:
        # Nobody has to know what it is called to move it out of the way.
        planner.start("green on blue", timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
        assert result.status == AchieveGoal.Result.SUCCESS, result.message
        (doubtful,) = [item for item in result.initial.objects if item.alternatives]
        assert result.moves_planned == 2
        assert judge.stacks[0] == ("blue_box", "green_box")
        # By its name it is asked for what it is.
        asked = planner.plan(ASKED, timeout=PATIENCE)
        assert asked.status == PlanToGoal.Response.NEEDS_ANSWER, asked.message
        assert "orange" in asked.answers and len(asked.answers) > 1
        place = judge.place_of("orange_box")
        assert f"stack{place} ({doubtful.name})" in asked.message
        planner.start(ASKED, answer="the orange one", timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
        assert result.status == AchieveGoal.Result.SUCCESS, result.message
    assert judge.stacks[0] == ("blue_box", "green_box", "orange_box")
