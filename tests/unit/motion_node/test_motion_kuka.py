# SPDX-License-Identifier: Apache-2.0
"""The KUKA iiwa with Franka's hand: its hulls hold its meshes, and it builds towers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pybullet_data
import pytest
from numpy.typing import NDArray

from motion_node.planner import MotionPlanner
from motion_node.robots import KUKA_IIWA
from scene_graph import Move
from sim_node import simulated_arms
from sim_node.controller import ArmController
from sim_node.ground_truth import true_scene_graph
from sim_node.urdf import robot_description
from sim_node.world import World

Array = NDArray[np.float64]
MESHES = Path(pybullet_data.getDataPath()) / "kuka_iiwa" / "meshes"


def mesh(name: str) -> Array:
    lines = (MESHES / f"{name}.obj").read_text(encoding="utf-8").splitlines()
    return np.array([[float(v) for v in line.split()[1:4]] for line in lines if line[:2] == "v "])


@pytest.fixture(scope="module")
def kuka() -> MotionPlanner:
    return MotionPlanner(robot_description(simulated_arms.KUKA_IIWA), KUKA_IIWA)


@pytest.mark.parametrize("number", [2, 3, 4, 5, 6])
def test_spheres_cover_the_meshes(number: int) -> None:
    vertices = mesh(f"link_{number}")
    bodies = (*KUKA_IIWA.bodies, *KUKA_IIWA.upper_bodies)
    spheres = [body for body in bodies if body.link == f"lbr_iiwa_link_{number}"]
    outside = np.min(
        [np.linalg.norm(vertices - body.center, axis=1) - body.radius for body in spheres], axis=0
    )
    assert outside.max() < 0.002


def test_the_hands_box_covers_the_flange() -> None:
    assert simulated_arms.KUKA_IIWA.hand is not None
    flange = mesh("link_7") - (0, 0, simulated_arms.KUKA_IIWA.hand.distance)
    assert np.abs(flange[:, 0]).max() < KUKA_IIWA.gripper.hand_half[0]
    assert np.abs(flange[:, 1]).max() < KUKA_IIWA.gripper.hand_half[1]
    assert flange[:, 2].min() > KUKA_IIWA.gripper.hand_top - 1e-3


def test_at_home_the_hand_points_down_above_all_towers(kuka: MotionPlanner) -> None:
    rows = np.array(kuka.model.hand(np.array(KUKA_IIWA.home))[0]).ravel()
    assert rows[2] > 0.45
    assert np.abs(rows[3:5]).max() < 0.01


@pytest.mark.parametrize("seed", range(4))
def test_it_builds_a_tower_of_three(kuka: MotionPlanner, seed: int) -> None:
    with World(arm=simulated_arms.KUKA_IIWA) as world:
        world.reset((("red_box", "blue_box"), ("green_box",), ()), seed)
        controller, joints = ArmController(world), world.joint_state()[0]
        moves = [Move(0, 2), Move(0, 1), Move(2, 1)]
        motion = kuka.solve(true_scene_graph(world), moves, joints[:7], joints[7:])
        whole = motion.trajectory
        positions, velocities = whole.positions.joined(), whole.velocities.joined()
        controller.follow(KUKA_IIWA.joint_names, whole.times, positions, velocities)
        while controller.moving:
            controller.update()
            world.step()
        stacks = true_scene_graph(world).stacks()
        assert stacks == ((), ("green_box", "red_box", "blue_box"), ())
        for name in world.names:
            assert world.block_pose(name)[0][:2] == pytest.approx((0.5, 0.0), abs=0.006)
