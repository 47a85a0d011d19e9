# SPDX-License-Identifier: Apache-2.0
"""Motions among obstacles, judged by pybullet's distances of the arm's meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pybullet_data
import pytest
from collision_oracle import CollisionOracle, replay
from motion_scenes import scene
from numpy.typing import NDArray
from obstacle_scenes import WIDE, pen, plan_geometrically, wall

from motion_node.blocks import read_scene
from motion_node.constraints import (
    AlongPath,
    Clearances,
    ObstacleClearance,
    default_constraints,
)
from motion_node.errors import InfeasibleError
from motion_node.expand import expand
from motion_node.obstacles import Obstacle
from motion_node.planner import Motion, MotionPlanner
from motion_node.robots import PANDA
from scene_graph import Move, SceneGraph

OPEN = np.full(2, 0.04)
#: Meshes keep at least this [m]; hulls cover them.
FREE = 0.002
NOWHERE = Obstacle("far post", (0.02, 0.02, 0.02), (-0.4, -0.5, 0.01))


@pytest.fixture(scope="module")
def surrounded(urdf: str) -> MotionPlanner:
    """Among up to four obstacles; tests put them where they like."""
    return MotionPlanner(urdf, obstacles=[NOWHERE] * 4)


def moved(
    planner: MotionPlanner,
    graph: SceneGraph,
    moves: list[Move],
    obstacles: list[Obstacle] | tuple[Obstacle, ...],
) -> Motion:
    """A motion that touches nothing but what it means to."""
    planner.surround(obstacles)
    motion = planner.solve(graph, moves, planner.model.home, OPEN)
    gap = planner.settings.phases.place_gap
    result = replay(graph, moves, motion, gap, vertical=0.05, step=0.02, obstacles=obstacles)
    assert result.free.distance > FREE, result.free
    return motion


@pytest.mark.parametrize("move", [Move(0, 2), Move(1, 2)])
@pytest.mark.parametrize(("height", "length"), [(0.12, 0.2), (0.3, 0.5), (0.5, 0.2), (0.5, 0.5)])
def test_a_wall_is_passed_over_or_round(
    surrounded: MotionPlanner, height: float, length: float, move: Move
) -> None:
    graph = scene((1, 1, 0), places=WIDE)
    moved(surrounded, graph, [move], [wall(0.5, 0.1, length, height)])


def test_posts_and_turned_walls_are_passed(surrounded: MotionPlanner) -> None:
    post = Obstacle("post", (0.04, 0.04, 0.4), (0.6, -0.1, 0.2), round=True)
    turned = wall(0.45, 0.095, 0.12, 0.12, yaw=0.3)
    graph = scene((2, 1, 0), places=WIDE)
    moved(surrounded, graph, [Move(0, 2), Move(1, 2), Move(0, 1)], [post, turned])


def test_a_lamp_over_the_table_is_passed_below_or_beside(surrounded: MotionPlanner) -> None:
    lamp = Obstacle("lamp", (0.3, 0.06, 0.05), (0.74, 0.1, 0.35))
    moved(surrounded, scene((1, 1, 0), places=WIDE), [Move(0, 2)], [lamp])


def test_a_wall_beside_a_tower_leaves_one_grasp(surrounded: MotionPlanner) -> None:
    """Fingers along x would touch it: the hand is long in the direction of its fingers."""
    graph = scene((3, 0, 0), places=WIDE)
    before = wall(0.58, -0.2, 0.3, 0.2, yaw=np.pi / 2)
    motion = moved(surrounded, graph, [Move(0, 1)], [before])
    switch = motion.phases[0].switch
    assert switch is not None
    assert abs(abs(switch.yaw) - np.pi / 2) < 0.1


def test_a_place_between_walls_is_put_down_on_across(surrounded: MotionPlanner) -> None:
    graph = scene((1, 0, 0), places=WIDE)
    walls = [
        wall(x, 0.2, 0.3, 0.12, yaw=np.pi / 2, name=name)
        for x, name in ((0.42, "back"), (0.58, "front"))
    ]
    motion = moved(surrounded, graph, [Move(0, 2)], walls)
    switch = motion.phases[1].switch
    assert switch is not None
    assert abs(abs(switch.yaw) - np.pi / 2) < 0.1


def test_a_place_that_is_walled_in_is_refused_with_the_pair_and_what_is_missing(
    surrounded: MotionPlanner,
) -> None:
    surrounded.surround(pen(0.5, 0.2, 0.3))
    graph = scene((1, 1, 0), places=WIDE)
    with pytest.raises(InfeasibleError) as failure:
        surrounded.solve(graph, [Move(1, 0), Move(0, 2)], surrounded.model.home, OPEN)
    error = failure.value
    assert (error.move, error.bound, error.phase, error.excludes) == (1, "pose", "place", "putting")
    assert error.object_name == "green_box"
    assert error.constraint.startswith("clearance of")
    assert error.constraint.endswith("fence")
    assert 0.005 < error.violation < 0.2


def test_what_is_out_of_reach_is_refused_with_how_far_it_is(surrounded: MotionPlanner) -> None:
    surrounded.surround([NOWHERE])
    graph = scene((1, 1, 0), places=(*WIDE[:2], (0.95, 0.2)))
    with pytest.raises(InfeasibleError, match="reach of the hand to") as failure:
        surrounded.solve(graph, [Move(0, 2)], surrounded.model.home, OPEN)
    assert (failure.value.bound, failure.value.excludes) == ("pose", "putting")
    assert failure.value.violation > 0.05


def test_out_of_reach_is_told_without_obstacles_too(planner: MotionPlanner) -> None:
    graph = scene((1, 1, 0), places=(*WIDE[:2], (0.95, 0.2)))
    with pytest.raises(InfeasibleError) as failure:
        planner.solve(graph, [Move(0, 2)], planner.model.home, OPEN)
    assert (failure.value.bound, failure.value.excludes) == ("pose", "putting")


def test_a_walled_in_place_is_planned_around(surrounded: MotionPlanner) -> None:
    """blue has to leave red, and the shortest plans put it into the pen, or under green."""
    surrounded.surround(pen(0.5, 0.2, 0.3))
    graph = scene((2, 1, 0), places=WIDE)
    bottom, top = graph.stacks()[0]
    other = graph.stacks()[1][0]
    result = plan_geometrically(surrounded, graph, f"{bottom} on {other}, {top} not on {bottom}")
    assert result.motion is None or result.moves >= 2
    assert all("fence" in item.reason for item in result.exclusions)
    impossible = plan_geometrically(surrounded, graph, f"{bottom} on stack2")
    assert impossible.motion is None
    assert impossible.refusal.startswith("impossible")
    assert f"{bottom} cannot be put on stack2: clearance of" in impossible.refusal


def test_without_obstacles_the_problem_is_what_it_was(planner: MotionPlanner) -> None:
    assert len(planner.constraints) == len(default_constraints(PANDA))
    assert not any(isinstance(item, ObstacleClearance) for item in planner.constraints)
    motion = planner.solve(scene((1, 0, 0)), [Move(0, 2)], planner.model.home, OPEN)
    assert {len(path.q) for path in motion.paths} == {planner.settings.path.steps + 1}


def test_clearance_to_obstacles_is_never_larger_than_the_meshes_distance(
    planner: MotionPlanner,
) -> None:
    rng = np.random.default_rng(7)
    graph = scene((0, 0, 0))
    settings = planner.settings
    (phase,) = expand(read_scene(graph), [], PANDA.gripper, settings.phases, settings.squeeze)
    links = {
        "hand": ("panda_hand", "panda_link7"),
        "fingers": ("panda_leftfinger", "panda_rightfinger"),
        "wrist": ("panda_link6",),
        "forearm": ("panda_link5",),
        "elbow": ("panda_link4",),
        "upper arm": ("panda_link3",),
        "shoulder": ("panda_link2",),
    }
    checked = 0
    for _ in range(40):
        size = rng.uniform(0.02, 0.3, 3)
        rounded = bool(rng.integers(2))
        if rounded:
            size[1] = size[0]
        center = rng.uniform((0.1, -0.4, 0.1), (0.7, 0.4, 0.8))
        item = Obstacle("o", tuple(size), tuple(center), float(rng.uniform(-3, 3)), rounded)
        clearance = ObstacleClearance(PANDA, [item], 1)
        way = AlongPath(PANDA, phase, Clearances(0.0, 0.0), settings.path, None, None)
        given = clearance.along_path(way).parameters[0]
        value = clearance.rows(planner.model, 3).value
        oracle = CollisionOracle(graph, [item])
        try:
            for _ in range(4):
                q = np.array(PANDA.home) + rng.uniform(-0.5, 0.5, 7)
                oracle.set_joints(PANDA.joint_names, np.array([*q, 0.04, 0.04]))
                gaps = np.array(value(q, given)).ravel()
                for name, gap in zip(clearance.row_names(phase), gaps):
                    part = name.removeprefix("clearance of ").removesuffix(" to o")
                    distance = oracle.distance(links[part], "o")
                    if gap > 0:
                        checked += 1
                        assert distance > 0, (name, gap)
                        assert gap <= distance + 0.005, (name, gap, distance)
        finally:
            oracle.close()
    assert checked > 300


def mesh(name: str) -> NDArray[np.float64]:
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "meshes" / f"{name}.obj"
    lines = path.read_text(encoding="utf-8").splitlines()
    return np.array([[float(v) for v in line.split()[1:4]] for line in lines if line[:2] == "v "])


@pytest.mark.parametrize("link", ["link2", "link3", "link4"])
def test_spheres_cover_the_upper_links(link: str) -> None:
    vertices = mesh(f"visual/{link}")
    spheres = [body for body in PANDA.upper_bodies if body.link == f"panda_{link}"]
    outside = np.min(
        [np.linalg.norm(vertices - body.center, axis=1) - body.radius for body in spheres], axis=0
    )
    assert outside.max() < 0.002
