# SPDX-License-Identifier: Apache-2.0
"""Two controllers in the simulator's world stack blocks; with one of them deaf they do not."""

from __future__ import annotations

import threading

import pytest
from physical_arm import PhysicalArm
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.motion_report import ArmPlace, MotionReason, MotionReport, MotionState

from motion_node.conversions import trajectory_to_two_messages
from motion_node.execution.condition import Condition
from motion_node.execution.executive import Executive
from motion_node.execution.follow import Follower
from motion_node.execution.plan import Plan
from motion_node.execution.settings import ExecutionSettings, StepSettings
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move
from sim_node.conversions import trajectory_arrays
from sim_node.ground_truth import true_scene_graph
from sim_node.stock_controller import TwoControllers
from sim_node.world import World

LAYOUT = (("red_box", "green_box"), ("blue_box",), ())
SETTINGS = ExecutionSettings(in_step=StepSettings())


class ApartArm(PhysicalArm):
    """One whose fingers have a controller of their own.

    Attributes:
        deaf: the topics whose messages do not arrive.
    """

    def __init__(self, world: World) -> None:
        self._controllers = TwoControllers(world)
        self.deaf: tuple[str, ...] = ()
        super().__init__(world, self._controllers)

    def send(self, trajectory: Trajectory, begins: float | None) -> None:
        messages = trajectory_to_two_messages(trajectory, PANDA, begins)
        for (topic, controller), message in zip(self._controllers.topics.items(), messages):
            if topic in self.deaf:
                continue
            stamp = nanoseconds(message.header.stamp)
            step = round(stamp * 1e-9 / self._world.timestep) if stamp else None
            controller.follow(message.joint_names, *trajectory_arrays(message), step)


def carry_out(world: World, planner: MotionPlanner, deaf: tuple[str, ...] = ()) -> MotionReport:
    """Red and green on blue, the upper one first."""
    arm = ApartArm(world)
    arm.deaf = deaf
    follower = Follower(arm, arm.send, SETTINGS)
    condition = Condition(
        arm, lambda: follower.grip, planner.model.home, 0.04, planner.model.tool_at
    )
    executive = Executive(lambda: planner, arm, follower, condition, lambda: SETTINGS)
    moves = (Move(0, 2), Move(0, 1))
    plan = Plan("a", true_scene_graph(world), moves, ("green_box", "red_box"))
    executive.carry_out(plan, threading.Event(), lambda _report: None)
    return condition.told_in(executive.report)


@pytest.fixture
def world() -> World:
    world = World()
    world.reset(LAYOUT, 0)
    return world


def test_two_controllers_build_a_tower(planner: MotionPlanner, world: World) -> None:
    with world:
        end = carry_out(world, planner)
        assert end.state is MotionState.SUCCEEDED, end.message
        assert true_scene_graph(world).stacks() == ((), ("blue_box", "red_box"), ("green_box",))


@pytest.mark.parametrize(
    ("topic", "reason"),
    [
        ("joint_trajectory", MotionReason.TRACKING_LOST),
        ("gripper_trajectory", MotionReason.GRASP_LOST),
    ],
)
def test_with_one_of_them_deaf_no_block_moves(
    planner: MotionPlanner, world: World, topic: str, reason: MotionReason
) -> None:
    with world:
        before = {name: world.block_pose(name)[0] for name in world.names}
        end = carry_out(world, planner, deaf=(topic,))
        assert (end.state, end.reason, end.arm) == (MotionState.FAILED, reason, ArmPlace.HOME)
        assert topic in end.message
        for name, position in before.items():
            assert world.block_pose(name)[0] == pytest.approx(position, abs=2e-3)
