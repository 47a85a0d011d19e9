# SPDX-License-Identifier: Apache-2.0
"""Optimised motions carried out in the simulator's world: fingers hold blocks by friction alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import random_moves

from motion_node.execution.arm_state import ArmState
from motion_node.execution.monitor import Monitor, MonitorSettings, Verdict
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.robots.joints import JointValues
from scene_graph import Move, SceneGraph, Stacks, apply_move
from sim_node.controller import ArmController
from sim_node.ground_truth import true_scene_graph
from sim_node.layouts import random_layout
from sim_node.world import World


def as_perceived(graph: SceneGraph, rng: np.random.Generator, error: float) -> SceneGraph:
    """Poses and sizes with errors of a standard deviation [m], as a camera gives them."""
    objects = tuple(
        replace(
            item,
            position_world=tuple(item.position_world + rng.normal(0, error, 3)),
            size=tuple(item.size + rng.normal(0, error, 3)),
        )
        for item in graph.objects
    )
    return replace(graph, objects=objects)


def joints(world: World) -> JointValues:
    return JointValues(*np.split(world.joint_state()[0], [len(PANDA.arm_joints)]))


def carry_out(
    world: World, planner: MotionPlanner, graph: SceneGraph, moves: list[Move]
) -> Verdict:
    """Follows the trajectory as the simulator does, watched by the monitor."""
    controller = ArmController(world)
    start = joints(world)
    trajectory = planner.solve(graph, moves, start.arm, start.fingers).trajectory
    positions, velocities = trajectory.positions.joined(), trajectory.velocities.joined()
    controller.follow(PANDA.joint_names, trajectory.times, positions, velocities)
    monitor = Monitor(trajectory, ArmState(world.time, 0.0, start, 1.0), MonitorSettings())
    while True:
        for _ in range(4):
            controller.update()
            world.step()
        state = ArmState(world.time, world.time, joints(world), 0.0)
        verdict = monitor.update(state)
        if verdict is not Verdict.GOING:
            return verdict


def assert_stacked(world: World, stacks: Stacks) -> None:
    for stack, base in zip(stacks, world.config.stack_positions):
        for level, name in enumerate(stack):
            position, _ = world.block_pose(name)
            expected = [*base[:2], (level + 0.5) * world.config.blocks.size.low]
            assert position == pytest.approx(expected, abs=0.012), name


@pytest.mark.parametrize(("seed", "blocks"), [(1, 4), (2, 6), (3, 7)])
def test_towers_are_built(planner: MotionPlanner, seed: int, blocks: int) -> None:
    rng = np.random.default_rng(seed)
    with World() as world:
        world.reset(random_layout(seed, blocks), seed)
        graph = true_scene_graph(world)
        moves = random_moves(graph, 5, rng)
        stacks = graph.stacks()
        for move in moves:
            stacks = apply_move(stacks, move)
        seen = as_perceived(graph, rng, error=0.0015)
        assert carry_out(world, planner, seen, moves) is Verdict.ARRIVED
        assert_stacked(world, stacks)


def test_a_tower_of_seven_is_taken_down(planner: MotionPlanner) -> None:
    names = tuple(f"{color}_box" for color in ("red", "green", "blue", "cyan", "pink", "brown"))
    with World() as world:
        world.reset(((*names, "yellow_box"), (), ()), 5)
        moves = [Move(0, 1), Move(0, 2), Move(0, 1), Move(0, 1)]
        graph = true_scene_graph(world)
        stacks = graph.stacks()
        for move in moves:
            stacks = apply_move(stacks, move)
        assert carry_out(world, planner, graph, moves) is Verdict.ARRIVED
        assert_stacked(world, stacks)


def test_a_block_that_is_not_there_is_noticed(planner: MotionPlanner) -> None:
    with World() as world:
        world.reset((("red_box", "green_box"), (), ("blue_box",)), 0)
        graph = true_scene_graph(world)
        higher = replace(
            graph,
            objects=tuple(
                replace(item, position_world=tuple(np.add(item.position_world, (0, 0, 0.06))))
                if item.name == "green_box"
                else item
                for item in graph.objects
            ),
        )
        assert carry_out(world, planner, higher, [Move(0, 1)]) is Verdict.GRASP_LOST
