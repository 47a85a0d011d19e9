# SPDX-License-Identifier: Apache-2.0
"""From a rendered picture to a stable plan that the simulated arm carries out; no ROS."""

from __future__ import annotations

import numpy as np
import pytest

from motion_node import MotionPlanner
from perception_node import Observation, Perception, PinholeCamera, load_weights
from planner_node import Scene, SearchResult, Settings, parse_goal, resolve_goal
from planner_node.loop import plan_in
from scene_graph import SceneGraph, Stacks
from sim_node.controller import ArmController
from sim_node.ground_truth import true_scene_graph
from sim_node.urdf import robot_description
from sim_node.world import World

#: The shortest plan for "green on stack1" puts the blue box on the sphere.
LAYOUT: Stacks = (("green_box",), ("blue_box",), ("red_sphere",))
EDGE = 0.045


def look(world: World) -> SceneGraph:
    frame, config = world.render(), world.config.camera
    camera = PinholeCamera(
        config.intrinsics, config.world_from_optical, config.width, config.height
    )
    observation = Observation(frame.rgb, depth=frame.depth, camera=camera)
    return Perception(load_weights()).perceive(observation).graph


def carry_out(world: World, seen: SceneGraph, found: SearchResult) -> None:
    """All moves, and two seconds more."""
    planner, (joints, _, _) = MotionPlanner(robot_description()), world.joint_state()
    trajectory = planner.solve(seen, found.moves, joints[:7], joints[7:]).trajectory
    positions, velocities = (
        np.hstack([values.arm, values.fingers])
        for values in (trajectory.positions, trajectory.velocities)
    )
    arm = ArmController(world)
    arm.follow(planner.arm.joint_names, trajectory.times, positions, velocities)
    while arm.moving:
        arm.update()
        world.step()
    for _ in range(480):
        world.step()


@pytest.mark.parametrize(("stability", "moves", "stands"), [("avoid", 4, True),
                                                            ("ignore", 2, False)])  # fmt: skip
def test_a_plan_around_a_sphere_stands_where_the_shortest_one_falls(
    stability: str, moves: int, stands: bool
) -> None:
    world = World()
    world.reset(LAYOUT)
    seen = look(world)
    goal = resolve_goal(parse_goal("green on stack1"), seen.names)
    found = plan_in(Scene(seen, seen.stacks()), goal, Settings(stability=stability), lambda: False)
    assert len(found.moves) == moves
    carry_out(world, seen, found)
    truth = true_scene_graph(world)
    predicted = found.states[-1]
    heights = {item.name: item.position_world[2] for item in truth.objects}
    rests = [
        abs(heights[name] - (level + 0.5) * EDGE) < 0.5 * EDGE
        for stack in predicted
        for level, name in enumerate(stack)
    ]
    assert all(rests) == stands
    if stands:
        assert truth.stacks() == predicted
