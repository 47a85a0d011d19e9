# SPDX-License-Identifier: Apache-2.0
"""The four nodes build a tower on a table whose places nobody told perception."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from judge import Judge
from rclpy.parameter import Parameter
from tamp_interfaces.action import AchieveGoal

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from sim_node.node import SimNode

#: How long a thing may take on a machine that has a lot to do [s].
PATIENCE = 120.0


@pytest.mark.timeout(600)
def test_a_tower_is_built_where_stacks_were_found(ros_context: Any, tmp_path: Path) -> None:
    context, scene = ros_context.context, tmp_path / "scene.yaml"
    scene.write_text("places: [[0.46, -0.07], [0.52, 0.10]]\n")
    world = {"scene": str(scene), "layout": ["red_box,blue_box", "green_box"]}
    # There is no third place on the table: blue has to go to one that perception lays.
    nodes: dict[Any, dict[str, Any]] = {
        SimNode: world,
        PerceptionNode: {"use_sim_time": True, "places": "found", "place_count": 3},
        PlannerNode: {"use_sim_time": True},
        MotionNode: {"use_sim_time": True},
    }
    for kind, told in nodes.items():
        overrides = [Parameter(name, value=value) for name, value in told.items()]
        ros_context.add(kind(context=context, parameter_overrides=overrides))
    judge = ros_context.add(Judge(context=context))
    ros_context.wait_until(lambda: judge.stacks, what="ground truth")
    with PlannerClient(context=context) as planner:
        planner.start("red on green", timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
    assert result.status == AchieveGoal.Result.SUCCESS, result.message
    assert result.moves_planned == 2 and len(result.final.bases) == 3
    assert judge.stacks[1] == ("green_box", "red_box")
