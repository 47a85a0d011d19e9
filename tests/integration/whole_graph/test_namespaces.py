# SPDX-License-Identifier: Apache-2.0
"""Two graphs in two namespaces of one domain do not hear one another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import rclpy
from ros2_run import PROCESS_TIMEOUT, TOWER_TIMEOUT
from tamp_interfaces.action import AchieveGoal

from planner_node.cli.client import PlannerClient
from tamp_bringup.processes import NodeProcesses
from tamp_bringup.scene_observer import SceneObserver, true_stacks

LAYOUTS = {"left": "['red_box','blue_box','']", "right": "['','cyan_box','pink_box']"}
GOALS = {"left": "red on blue", "right": "pink on cyan"}
TOWERS = {"left": ("blue_box", "red_box"), "right": ("cyan_box", "pink_box")}


@pytest.fixture
def ros(domain_id: int) -> Any:
    del domain_id  # it is in the environment
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.mark.timeout(1200)
@pytest.mark.usefixtures("ros")
def test_fault_6_two_graphs_in_two_namespaces_work_side_by_side(tmp_path: Path) -> None:
    def graph(side: str) -> NodeProcesses:
        scene = {"layout": LAYOUTS[side], "real_time_factor": 0.0}
        return NodeProcesses(tmp_path / side, {"sim_node": scene}, namespace=side)

    def client(side: str) -> PlannerClient:
        return PlannerClient(namespace=side)

    with (
        graph("left") as left_graph,
        graph("right") as right_graph,
        SceneObserver(namespace="left") as left_truth,
        SceneObserver(namespace="right") as right_truth,
        client("left") as left,
        client("right") as right,
    ):
        for truth in (left_truth, right_truth):
            truth.confident_graph(TOWER_TIMEOUT)
        # Both at once: each arm, clock and camera is its own graph's.
        left.start(GOALS["left"], timeout=PROCESS_TIMEOUT)
        right.start(GOALS["right"], timeout=PROCESS_TIMEOUT)
        for side, planner, truth in (
            ("left", left, left_truth),
            ("right", right, right_truth),
        ):
            result = planner.result(TOWER_TIMEOUT)
            assert result.status == AchieveGoal.Result.SUCCESS, (side, result.message)
            stacks = true_stacks(truth.fresh_truth(PROCESS_TIMEOUT))
            assert stacks is not None and TOWERS[side] in stacks
        left_graph.check()
        right_graph.check()
