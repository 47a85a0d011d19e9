# SPDX-License-Identifier: Apache-2.0
"""The four nodes in one process, and a goal: how integration tests and notebooks do it.

Run it as

    python examples/graph_in_process.py "red on green"
"""

from __future__ import annotations

import sys

import rclpy
from rclpy.parameter import Parameter
from tamp_runtime.domain import reserve_domain
from tamp_runtime.node_process import prepare_process
from tamp_runtime.node_thread import NodeThread

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from sim_node.node import SimNode

LAYOUT = ["red_box,blue_box", "", "green_box"]


def main(goal: str = "red on green") -> int:
    prepare_process()
    rclpy.init(domain_id=reserve_domain())  # a graph of its own, whatever else runs here
    simulator = [Parameter("layout", value=LAYOUT), Parameter("real_time_factor", value=0.0)]
    clock = [Parameter("use_sim_time", value=True)]
    nodes = [SimNode(parameter_overrides=simulator)]
    nodes += [kind(parameter_overrides=clock) for kind in (PerceptionNode, PlannerNode, MotionNode)]
    spinning = NodeThread(*nodes, threads=8)
    try:
        with PlannerClient() as planner:
            planner.start(goal, timeout=60.0)
            while not planner.is_done():
                if feedback := planner.next_feedback(timeout=0.2):
                    print(feedback.message)
            result = planner.result(timeout=1.0)
    finally:
        spinning.stop()
        for node in reversed(nodes):
            node.destroy_node()
        rclpy.try_shutdown()
    print(result.message)
    return 0 if result.status in (result.SUCCESS, result.ALREADY_TRUE) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
