# SPDX-License-Identifier: Apache-2.0
"""Executes a task without ROS: planners, simulator and controller of the product in one process.

Quicker than the four nodes, and the same every time. What the camera would see is replaced by the
truth with errors of its size; where the goal is missed it is planned for anew from what stands, as
the closed loop does.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_node.errors import MotionError
from motion_node.planner import MotionPlanner
from motion_node.timing.trajectory import Trajectory
from planner_node import make_plan, parse_goal, resolve_goal
from planner_node.errors import PlannerError
from scene_graph import SceneGraph
from sim_node.controller import ArmController
from sim_node.ground_truth import true_scene_graph
from sim_node.layouts import random_layout
from sim_node.world import World
from tamp_bringup.task import goal_text, random_goal, triples
from tamp_bringup.task_runner import goal_holds

from .arm_links import bodies_in
from .carry_out import STEPS_PER_ENTRY, TraceWriter
from .recording import Command, Recording

#: Standard deviation of what perception says of positions and sizes [m].
PERCEPTION_ERROR: Final = 0.0015
#: How often a goal is planned for.
ATTEMPTS: Final = 3
#: How long the arm stands still between two trajectories [s].
PAUSE: Final = 0.5


def record_in_process(world: World, planner: MotionPlanner, seed: int, blocks: int) -> Recording:
    """Executes the task of a seed, as ``make eval-tasks`` draws it, and says what happened.

    Args:
        world: is reset.
        planner: for the world's arm.
    """
    world.reset(random_layout(seed, blocks, world.config.stack_count), seed)
    rng = np.random.default_rng([seed, 2])
    bodies, start = bodies_in(world), world.joint_state()[0]
    goal = goal_text(random_goal(true_scene_graph(world).names, seed))
    controller, first = ArmController(world), world.steps
    names = tuple(body.name for body in bodies if body.mass > 0.0)
    trace, commands = TraceWriter(names), list[Command]()

    def go_on(seconds: float) -> None:
        for _ in range(round(seconds / world.timestep)):
            if (world.steps - first) % STEPS_PER_ENTRY == 0:
                now = (world.steps - first) * world.timestep
                trace.add(now, world.joint_state()[0], poses_in(world, names))
            controller.update()
            world.step()

    for _ in range(ATTEMPTS):
        go_on(PAUSE)
        truth = true_scene_graph(world)
        if goal_holds(goal, truth):
            break
        try:
            trajectory = _trajectory(world, planner, _as_seen(truth, rng), goal)
        except (PlannerError, MotionError) as error:
            trace.notes.append(f"planning ended the task: {error}")
            break
        positions, velocities = trajectory.positions.joined(), trajectory.velocities.joined()
        begins = (world.steps - first) * world.timestep
        commands.append(Command(begins, trajectory.times, positions, velocities))
        controller.follow(planner.arm.joint_names, trajectory.times, positions, velocities)
        go_on(trajectory.duration)
    go_on(1.0)
    final = true_scene_graph(world)
    return Recording(
        seed=seed,
        source="process",
        goal=goal,
        success=goal_holds(goal, final),
        robot=world.arm.name,
        joints=planner.arm.joint_names,
        places=world.config.stack_positions,
        bodies=bodies,
        start=start,
        commands=tuple(commands),
        trace=trace.finished(),
        relations=tuple((item[0], item[1], item[2]) for item in triples(final.relations)),
    )


def poses_in(world: World, names: tuple[str, ...]) -> NDArray[np.float64]:
    """Poses of blocks, shape (b, 7): position [m], quaternion (x, y, z, w)."""
    return np.array([np.concatenate(world.block_pose(name)) for name in names])


def _trajectory(world: World, planner: MotionPlanner, seen: SceneGraph, goal: str) -> Trajectory:
    found = make_plan(seen.stacks(), resolve_goal(parse_goal(goal), seen.names))
    arm, fingers = np.split(world.joint_state()[0], [len(world.arm.arm_joints)])
    return planner.solve(seen, found.moves, arm, fingers).trajectory


def _as_seen(truth: SceneGraph, rng: np.random.Generator) -> SceneGraph:
    def off(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(np.add(values, rng.normal(0.0, PERCEPTION_ERROR, 3)).tolist())

    objects = tuple(
        replace(item, position_world=off(item.position_world), size=off(item.size))  # type: ignore[arg-type]
        for item in truth.objects
    )
    return replace(truth, objects=objects)
