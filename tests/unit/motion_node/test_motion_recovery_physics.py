# SPDX-License-Identifier: Apache-2.0
"""Faults in the simulator's world, where blocks are held by friction alone: they stay on stacks."""

from __future__ import annotations

import threading
from contextlib import suppress

import numpy as np
import pytest
from physical_arm import PhysicalArm
from tamp_runtime.motion_report import ArmPlace, MotionReport, MotionState

from motion_node.execution.condition import Condition
from motion_node.execution.executive import Executive
from motion_node.execution.follow import Follower
from motion_node.execution.plan import Plan
from motion_node.execution.settings import ExecutionSettings
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move
from sim_node.controller import ArmController
from sim_node.ground_truth import true_scene_graph
from sim_node.trajectory import TrajectoryError
from sim_node.world import World


class FaultyArm(PhysicalArm):
    """One that goes wrong as it is told to.

    Attributes:
        cut: shares of the next trajectories after which they end.
        deaf_fingers: the fingers stay open, whatever they are told.
        stop: set as soon as a finger is nearer to the middle than ``stop_below`` [m].
    """

    def __init__(self, world: World) -> None:
        self._controller = ArmController(world)
        self.cut: list[float] = []
        self.deaf_fingers = False
        self.stop, self.stop_below = threading.Event(), 0.0
        super().__init__(world, self._controller)

    def observe(self, fingers: np.ndarray) -> None:
        if fingers.min() < self.stop_below:
            self.stop.set()

    def send(self, trajectory: Trajectory, _begins: float | None = None) -> None:
        if self.cut:
            trajectory = trajectory.cut(0.0, self.cut.pop(0) * trajectory.duration)
        positions, velocities = trajectory.positions.joined(), trajectory.velocities.joined()
        if self.deaf_fingers:
            positions[:, -2:], velocities[:, -2:] = PANDA.gripper.finger_travel, 0.0
        with suppress(TrajectoryError):  # as the simulator does: what runs goes on
            self._controller.follow(PANDA.joint_names, trajectory.times, positions, velocities)


def carry_out(arm: FaultyArm, world: World, planner: MotionPlanner) -> MotionReport:
    follower = Follower(arm, arm.send, ExecutionSettings())
    condition = Condition(
        arm, lambda: follower.grip, planner.model.home, 0.04, planner.model.tool_at
    )
    executive = Executive(lambda: planner, arm, follower, condition, ExecutionSettings)
    plan = Plan("a", true_scene_graph(world), (Move(0, 2),), ("green_box",))
    executive.carry_out(plan, arm.stop, lambda _report: None)
    return condition.told_in(executive.report)


@pytest.mark.parametrize("cut", [[0.45], [0.5], [0.6], [0.55, 0.5]])
def test_fault_2_a_block_ends_on_a_stack_though_trajectories_end_early(
    planner: MotionPlanner, cut: list[float]
) -> None:
    with World() as world:
        world.reset((("red_box", "green_box"), ("blue_box",), ()), 0)
        arm = FaultyArm(world)
        arm.cut = list(cut)
        end = carry_out(arm, world, planner)
        assert end.state is MotionState.FAILED
        assert end.message.endswith("green_box was put down on stack2 and the arm is home")
        assert (end.arm, end.held, end.moves_done) == (ArmPlace.HOME, "", 1)
        assert true_scene_graph(world).stacks() == (("red_box",), ("blue_box",), ("green_box",))


def test_fault_4_fingers_that_never_close_leave_the_blocks_standing(planner: MotionPlanner) -> None:
    with World() as world:
        world.reset((("red_box", "green_box"), ("blue_box",), ()), 0)
        arm = FaultyArm(world)
        arm.deaf_fingers = True
        end = carry_out(arm, world, planner)
        assert end.message.startswith("the fingers did not close on green_box: they stand 80 mm")
        assert (end.arm, end.held, end.moves_done) == (ArmPlace.HOME, "", 0)
        assert true_scene_graph(world).stacks() == (("red_box", "green_box"), ("blue_box",), ())


@pytest.mark.parametrize("below", [0.035, 0.027, 0.025])
def test_a_stop_while_the_fingers_close_leaves_the_block_where_it_is(
    planner: MotionPlanner, below: float
) -> None:
    """Fingers that are 25 mm from the middle touch the block, 45 mm wide, before they turn."""
    with World() as world:
        world.reset((("red_box", "green_box"), ("blue_box",), ()), 0)
        arm = FaultyArm(world)
        arm.stop_below = below
        end = carry_out(arm, world, planner)
        assert end.state is MotionState.CANCELLED
        assert end.message == "stopped on request after 0 of 1 moves; the arm is home"
        assert (end.arm, end.held) == (ArmPlace.HOME, "")
        assert true_scene_graph(world).stacks() == (("red_box", "green_box"), ("blue_box",), ())
