# SPDX-License-Identifier: Apache-2.0
"""Boxes and spheres of the arm against its meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pybullet
import pybullet_data
import pytest
from collision_oracle import CollisionOracle
from motion_scenes import scene
from numpy.typing import NDArray

from motion_node.blocks import read_scene
from motion_node.constraints import AlongPath, Clearances, HandClearance, LinkClearance
from motion_node.expand import expand
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA

Array = NDArray[np.float64]


def test_clearance_is_never_larger_than_the_meshes_distance(
    planner: MotionPlanner,
) -> None:
    """The safe side: what counts as clear is clear, for postures in which the hand points down."""
    graph = scene((6, 0, 0))
    oracle = CollisionOracle(graph)
    settings = planner.settings
    (phase,) = expand(read_scene(graph), [], PANDA.gripper, settings.phases, settings.squeeze)
    way = AlongPath(PANDA, phase, Clearances(0.0, 0.0), settings.path, None, None)
    clearances = [
        (constraint.row_names(phase), constraint.rows(planner.model, 3).value, given[0])
        for constraint in (HandClearance(PANDA), LinkClearance(PANDA))
        for given in [constraint.along_path(way).parameters]
    ]
    inverse = planner.inverse
    links = {
        "hand": ("panda_hand", "panda_link7", "panda_leftfinger", "panda_rightfinger"),
        "wrist": ("panda_link6",),
        "forearm": ("panda_link5",),
    }
    rng = np.random.default_rng(2)
    checked = 0
    for _ in range(150):
        point = rng.uniform((0.35, -0.3, 0.03), (0.65, 0.2, 0.45))
        near = np.array(PANDA.home) + rng.uniform(-0.6, 0.6, 7)
        near[6] -= np.pi / 2
        q = inverse.solve(point, np.array([0.0]), near)[0]
        if np.abs(inverse.residual(q[None], point)).max() > 1e-3:
            continue
        oracle.set_joints(PANDA.joint_names, np.array([*q, 0.04, 0.04]))
        gaps = {
            name: float(gap)
            for names, function, parameters in clearances
            for name, gap in zip(names, np.array(function(q, parameters)).ravel())
        }
        for body, parts in links.items():
            gap = gaps[f"clearance of {body} to stack0"]
            distance = min(
                point[8]
                for block in oracle.stacks[0]
                for part in parts
                for point in pybullet.getClosestPoints(
                    oracle.robot,
                    oracle.blocks[block],
                    1.0,
                    linkIndexA=oracle.links[part],
                    physicsClientId=oracle.client,
                )
            )
            if gap > 0:
                checked += 1
                assert distance > 0
                # One axis parts them by no more than their distance.
                assert gap <= distance + 0.002, (body, q, gap, distance)
    assert checked > 100
    oracle.close()


def mesh(name: str) -> Array:
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "meshes" / f"{name}.obj"
    lines = path.read_text(encoding="utf-8").splitlines()
    return np.array([[float(v) for v in line.split()[1:4]] for line in lines if line[:2] == "v "])


@pytest.mark.parametrize("link", ["link5", "link6"])
def test_spheres_cover_the_meshes(link: str) -> None:
    vertices = mesh(f"visual/{link}")
    spheres = [body for body in PANDA.bodies if body.link == f"panda_{link}"]
    outside = np.min(
        [np.linalg.norm(vertices - body.center, axis=1) - body.radius for body in spheres], axis=0
    )
    assert outside.max() < 0.002


def test_the_hands_box_covers_hand_and_flange() -> None:
    hand = mesh("visual/hand")
    turn = np.array([[np.cos(0.785), -np.sin(0.785)], [np.sin(0.785), np.cos(0.785)]])
    flange = mesh("collision/link7") - (0, 0, 0.107)
    flange[:, :2] = flange[:, :2] @ turn.T  # link7 to hand: 45 degrees about z
    for vertices in (hand, flange):
        assert np.abs(vertices[:, 0]).max() < PANDA.gripper.hand_half[0] + 1e-3
        assert np.abs(vertices[:, 1]).max() < PANDA.gripper.hand_half[1] + 1e-3
        assert vertices[:, 2].min() > PANDA.gripper.hand_top - 1e-3
    assert hand[:, 2].max() <= PANDA.gripper.palm + 1e-3
