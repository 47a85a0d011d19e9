# SPDX-License-Identifier: Apache-2.0
"""The four nodes on a table with a wall between two places: it is passed, and never touched."""

from __future__ import annotations

from typing import Any

import pybullet
import pytest
from rclpy.parameter import Parameter
from tamp_interfaces.action import AchieveGoal

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from sim_node.ground_truth import true_scene_graph
from sim_node.node import SimNode
from sim_node.scene.files import example_scenes
from sim_node.world import World

PATIENCE = 240.0
#: On a machine that has a lot to do anything may take long.
PATIENT_PLANNER = [
    Parameter(name, value=PATIENCE)
    for name in (
        "perceive_timeout",
        "graph_max_age",
        "motion_accept_timeout",
        "motion_silence_timeout",
    )
]
PATIENT_MOTION = [
    Parameter(name, value=PATIENCE)
    for name in ("joint_state_timeout", "description_timeout", "rest_timeout")
]
LAYOUT = ["red_box,blue_box", "green_box", ""]


class Witness:
    """Looks after each step of the physics what the arm and the blocks touch."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.touched: set[str] = set()
        self.stacks: Any = None
        self.steps = 0
        original = World.step

        def step(world: World) -> None:
            original(world)
            self.steps += 1
            for name, body in world.obstacles.items():
                if pybullet.getContactPoints(world.robot, body, physicsClientId=world.client):
                    self.touched.add(f"arm to {name}")
                for block in world.names:
                    if pybullet.getContactPoints(
                        world.body(block), body, physicsClientId=world.client
                    ):
                        self.touched.add(f"{block} to {name}")
            if self.steps % 60 == 0:
                self.stacks = true_scene_graph(world).stacks()

        monkeypatch.setattr(World, "step", step)


@pytest.mark.timeout(900)
def test_a_wall_between_two_places_is_never_touched(
    ros_context: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    witness = Witness(monkeypatch)
    scene = str(example_scenes()["wall"])
    context, simulated = ros_context.context, Parameter("use_sim_time", value=True)
    ros_context.add(
        SimNode(
            context=context,
            parameter_overrides=[
                Parameter("layout", value=LAYOUT),
                Parameter("scene", value=scene),
            ],
        )
    )
    ros_context.add(PerceptionNode(context=context, parameter_overrides=[simulated]))
    ros_context.add(PlannerNode(context=context, parameter_overrides=[simulated, *PATIENT_PLANNER]))
    around = Parameter("obstacles", value=scene)
    ros_context.add(
        MotionNode(context=context, parameter_overrides=[simulated, around, *PATIENT_MOTION])
    )
    with PlannerClient(context=context) as planner:
        planner.start("red on stack2, green on red", timeout=PATIENCE)
        result = planner.result(timeout=3.0 * PATIENCE)
    assert result.status == AchieveGoal.Result.SUCCESS, result.message
    assert witness.stacks[2][:2] == ("red_box", "green_box")
    assert result.moves_executed >= 3
    assert witness.steps > 600
    assert witness.touched == set()
