# SPDX-License-Identifier: Apache-2.0
"""A gripper that knows "go to this width" only, behind the topic `gripper_trajectory`.

Franka's gripper, and every other one behind the action control_msgs/GripperCommand, follows no
trajectory. `GripperBehindTopic` hears the one that motion_node (with `gripper_apart`) sends, and
calls a function of yours whenever the fingers are to set out. Yours sends the action's goal:

    goal = GripperCommand.Goal()                      # from control_msgs.action
    goal.command.position, goal.command.max_effort = width / 2, 30.0   # Franka's: half the width
    client.send_goal_async(goal)                      # an ActionClient("/gripper/gripper_cmd")

Here, where that action does not exist, the function moves the simulator's fingers instead, and the
whole graph builds a tower with them:

    python examples/gripper_action_behind_a_topic.py "red on green"
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from tamp_runtime.domain import reserve_domain
from tamp_runtime.messages.stamps import duration_from_seconds, seconds
from tamp_runtime.node_process import prepare_process
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import RELIABLE
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from sim_node.node import SimNode

LAYOUT = ["red_box,blue_box", "", "green_box"]
#: Widths nearer to one another than this are the same [m].
SAME = 1e-4


@dataclass(frozen=True)
class Command:
    """Fingers that set out.

    Attributes:
        start: since the trajectory's start [s].
        width: between the fingers, where they go [m].
        speed: of the fingers towards or from one another [m/s].
    """

    start: float
    width: float
    speed: float


def commands_of(message: JointTrajectory) -> list[Command]:
    """One command a way from rest to rest; the first one says where the fingers are."""
    times = [seconds(point.time_from_start) for point in message.points]
    widths = [sum(point.positions) for point in message.points]
    resting = [not any(point.velocities) for point in message.points]
    commands = [Command(times[0], widths[0], 0.1)]
    begins = 0
    for now in range(1, len(times)):
        if not resting[now]:
            continue
        way = widths[now] - widths[begins]
        if abs(way) > SAME:
            speed = abs(way) / (times[now] - times[begins])
            commands.append(Command(times[begins], widths[now], speed))
        begins = now
    return commands


class GripperBehindTopic(Node):
    """Hears `gripper_trajectory` and calls when the fingers are to set out.

    Args:
        move: sends fingers to a width [m] at a speed [m/s]; must not wait until they are there.
    """

    def __init__(self, move: Callable[[float, float], None], **kwargs: Any) -> None:
        super().__init__("gripper_behind_topic", **kwargs)
        self._move, self._sent = move, -1.0
        self._commands: list[Command] = []
        self._begins = 0.0
        self.create_subscription(JointTrajectory, "gripper_trajectory", self._hear, RELIABLE)
        self.create_timer(0.01, self._look)

    def _now(self) -> float:
        return seconds(self.get_clock().now().to_msg())

    def _hear(self, message: JointTrajectory) -> None:
        """Replaces what is still to come; without a stamp it starts now."""
        self._begins = seconds(message.header.stamp) or self._now()
        self._commands = commands_of(message)
        self._look()

    def _look(self) -> None:
        due = [item for item in self._commands if self._begins + item.start <= self._now()]
        if not due:
            return
        self._commands = self._commands[len(due) :]
        if abs(due[-1].width - self._sent) > SAME:
            self._sent = due[-1].width
            self._move(due[-1].width, due[-1].speed)


class SimulatedGripper(Node):
    """Stands for the gripper's action: sends the simulator's fingers to a width."""

    def __init__(self, joints: tuple[str, str], **kwargs: Any) -> None:
        super().__init__("simulated_gripper", **kwargs)
        self._joints, self.calls, self._width = joints, 0, 0.08
        self._fingers = self.create_publisher(JointTrajectory, "simulated_fingers", RELIABLE)

    def move(self, width: float, speed: float) -> None:
        """Fingers go there and go on pressing."""
        print(f"the gripper is sent to {1000 * width:.0f} mm at {1000 * speed:.0f} mm/s")
        self.calls += 1
        duration = max(abs(width - self._width) / max(speed, 0.01), 0.1)
        self._width = width
        there = JointTrajectoryPoint(
            positions=[width / 2, width / 2], time_from_start=duration_from_seconds(duration)
        )
        self._fingers.publish(JointTrajectory(joint_names=list(self._joints), points=[there]))


def main(goal: str = "red on green") -> int:
    prepare_process()
    rclpy.init(domain_id=reserve_domain())  # a graph of its own, whatever else runs here
    apart = Parameter("gripper_apart", value=True)
    clock = Parameter("use_sim_time", value=True)
    # A gripper behind an action sets out late: the arm stands still for it a little longer.
    patient = [Parameter(f"{what}_seconds", value=1.5) for what in ("open", "close")]
    patient += [Parameter("max_apart", value=1.0), Parameter("start_lead", value=0.5)]
    gripper = SimulatedGripper(("panda_finger_joint1", "panda_finger_joint2"))
    nodes: list[Node] = [
        SimNode(
            parameter_overrides=[Parameter("layout", value=LAYOUT), apart],
            cli_args=["--ros-args", "-r", "gripper_trajectory:=simulated_fingers"],
        ),
        gripper,
        GripperBehindTopic(gripper.move, parameter_overrides=[clock]),
        PerceptionNode(parameter_overrides=[clock]),
        PlannerNode(parameter_overrides=[clock]),
        MotionNode(parameter_overrides=[clock, apart, *patient]),
    ]
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
    print(f"{result.message} ({gripper.calls} calls of the gripper)")
    return 0 if result.status in (result.SUCCESS, result.ALREADY_TRUE) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
