# SPDX-License-Identifier: Apache-2.0
"""Arm and gripper with a controller each build a tower in the whole graph."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import LATCHED, RELIABLE
from trajectory_msgs.msg import JointTrajectory

from motion_node.node import MotionNode
from motion_node.robots import ARMS
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from sim_node.node import SimNode

#: How long a thing may take on a machine that has a lot to do [s].
PATIENCE = 120.0
LAYOUT = ["red_box,blue_box", "", "green_box"]


class Listener(Node):
    """Hears both trajectories, and the ground truth that the nodes under test must not."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("listener", **kwargs)
        self.arm: list[JointTrajectory] = []
        self.gripper: list[JointTrajectory] = []
        self.truth: SceneGraph | None = None
        self.create_subscription(JointTrajectory, "joint_trajectory", self.arm.append, RELIABLE)
        self.create_subscription(
            JointTrajectory, "gripper_trajectory", self.gripper.append, RELIABLE
        )
        self.create_subscription(SceneGraph, "sim/ground_truth", self._on_truth, LATCHED)

    def _on_truth(self, message: SceneGraph) -> None:
        self.truth = message

    def stacks(self) -> Any:
        return graph_from_message(self.truth).stacks() if self.truth else None


@pytest.mark.timeout(600)
@pytest.mark.parametrize("robot", sorted(ARMS))
def test_two_controllers_build_a_tower_that_the_simulator_confirms(
    ros_context: Any, robot: str
) -> None:
    context = ros_context.context
    apart = [Parameter("gripper_apart", value=True), Parameter("robot", value=robot)]
    follow_clock = [Parameter("use_sim_time", value=True)]
    # On a busy machine a message may be on its way for long.
    motion = [*follow_clock, *apart, Parameter("start_lead", value=3.0)]
    layout = Parameter("layout", value=LAYOUT)
    ros_context.add(SimNode(context=context, parameter_overrides=[layout, *apart]))
    for kind in (PerceptionNode, PlannerNode):
        ros_context.add(kind(context=context, parameter_overrides=follow_clock))
    ros_context.add(MotionNode(context=context, parameter_overrides=motion))
    listener = ros_context.add(Listener(context=context))
    ros_context.wait_until(listener.stacks, what="ground truth")
    with PlannerClient(context=context) as planner:
        planner.start("red on green", timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
    assert result.status == AchieveGoal.Result.SUCCESS, result.message
    assert listener.stacks()[2][:2] == ("green_box", "red_box")
    assert len(listener.arm) == len(listener.gripper) > 0
    for arm, gripper in zip(listener.arm, listener.gripper):
        assert tuple(arm.joint_names) == ARMS[robot].arm_joints
        assert tuple(gripper.joint_names) == ARMS[robot].gripper.finger_joints
        assert arm.header.stamp == gripper.header.stamp
