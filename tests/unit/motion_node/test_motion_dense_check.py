# SPDX-License-Identifier: Apache-2.0
"""The dense check against pybullet: of hulls, and of trajectories through a wall."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_scenes import random_heights, random_moves, scene
from obstacle_scenes import WIDE, wall

from motion_node.blocks import read_scene
from motion_node.constraints import Clearances
from motion_node.dense_check import Checked, check
from motion_node.errors import InfeasibleError
from motion_node.hull_distances import MovingBox, MovingSpheres, Upright
from motion_node.obstacles import Obstacle
from motion_node.phases import PhasePath
from motion_node.planner import MotionPlanner
from motion_node.refining import refined
from scene_graph import Move

OPEN = np.full(2, 0.04)


def bullet_gap(first: int, second: int, client: int) -> float:
    points = pybullet.getClosestPoints(first, second, 5.0, physicsClientId=client)
    return min(point[8] for point in points)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), rounded=st.booleans())
def test_gaps_are_never_more_than_bullets_distances(seed: int, rounded: bool) -> None:
    rng = np.random.default_rng(seed)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        half, other = rng.uniform(0.02, 0.2, 3), rng.uniform(0.02, 0.3, 3)
        yaw, center = float(rng.uniform(-3, 3)), rng.uniform(-0.1, 0.1, 3)
        if rounded:
            other[1] = other[0]
        still = Upright(("o",), center[None], other[None], np.array([yaw]), np.array([rounded]))
        shape = (
            pybullet.createCollisionShape(
                pybullet.GEOM_CYLINDER, radius=other[0], height=2 * other[2], physicsClientId=client
            )
            if rounded
            else pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=other, physicsClientId=client
            )
        )
        turn = (0, 0, np.sin(yaw / 2), np.cos(yaw / 2))
        body = pybullet.createMultiBody(0, shape, -1, center, turn, physicsClientId=client)
        position, quaternion = rng.uniform(-0.5, 0.5, 3), rng.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        rotation = np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        box = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client
        )
        moving = pybullet.createMultiBody(0, box, -1, position, quaternion, physicsClientId=client)
        gap = float(MovingBox(rotation[None], position[None], half).gaps(still)[0, 0])
        distance = bullet_gap(moving, body, client)
        assert gap <= distance + 1e-3
        if distance < 0 and not rounded:
            assert gap < 1e-3  # it overlaps: no axis may part them
        radius = float(half[0])
        ball = pybullet.createMultiBody(
            0,
            pybullet.createCollisionShape(
                pybullet.GEOM_SPHERE, radius=radius, physicsClientId=client
            ),
            -1, position, physicsClientId=client,
        )  # fmt: skip
        sphere = float(MovingSpheres(position[None, None], np.array([radius])).gaps(still)[0, 0, 0])
        outside = bullet_gap(ball, body, client)
        assert sphere <= outside + 1e-3
        if outside > 0:
            assert sphere == pytest.approx(outside, abs=2e-3)
    finally:
        pybullet.disconnect(client)


@pytest.mark.parametrize("seed", range(6))
def test_motions_without_obstacles_pass(planner: MotionPlanner, seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = scene(random_heights(rng, 5), rng)
    motion = planner.solve(graph, random_moves(graph, 3, rng), planner.model.home, OPEN)
    checked = check(planner.model, motion.trajectory, read_scene(graph), ())
    assert checked.contacts == ()
    assert abs(checked.least) < 2e-3  # a block leaves what it stands on


def test_a_wall_in_the_way_is_found_and_named(planner: MotionPlanner) -> None:
    graph = scene((1, 0, 0), places=WIDE)
    motion = planner.solve(graph, [Move(0, 2)], planner.model.home, OPEN)
    thin = Obstacle("wire", (0.4, 0.001, 0.4), (0.5, 0.1, 0.2))
    checked = check(planner.model, motion.trajectory, read_scene(graph), [thin])
    contact = checked.contacts[0]
    assert (contact.phase.kind, contact.other) == ("place", "wire")
    assert contact.gap < 0


def test_a_block_that_stands_in_the_way_is_found(planner: MotionPlanner) -> None:
    """The motion was planned for another scene than the one that is checked."""
    graph = scene((1, 0, 0), places=WIDE)
    motion = planner.solve(graph, [Move(0, 2)], planner.model.home, OPEN)
    tower = scene((1, 6, 0), places=WIDE)
    checked = check(planner.model, motion.trajectory, read_scene(tower), ())
    assert {contact.other for contact in checked.contacts} & set(tower.names)


def test_what_is_objected_to_is_solved_again_with_more_room(planner: MotionPlanner) -> None:
    graph = scene((1, 0, 0), places=WIDE)
    motion = planner.solve(graph, [Move(0, 2)], planner.model.home, OPEN)
    found = [
        check(planner.model, motion.trajectory, read_scene(graph), [wall(0.5, 0.1, 0.4, 0.4)]),
        Checked(0.01, ()),
    ]
    asked: list[Clearances] = []

    def solve(index: int, kept: Clearances) -> PhasePath:
        asked.append(kept)
        return replace(motion.paths[index])

    clear = Clearances(0.015, 0.0)
    refined(
        list(motion.paths), clear, solve, lambda _: motion.trajectory, lambda _: found.pop(0),
        frozenset({"wall"}),
    )  # fmt: skip
    assert asked
    assert all(kept.extra > 0 and kept.margin == clear.margin for kept in asked)


def test_what_more_room_does_not_help_is_refused(planner: MotionPlanner) -> None:
    graph = scene((1, 0, 0), places=WIDE)
    motion = planner.solve(graph, [Move(0, 2)], planner.model.home, OPEN)
    around = [wall(0.5, 0.1, 0.4, 0.4)]
    with pytest.raises(InfeasibleError, match="to wall between the path's steps") as failure:
        refined(
            list(motion.paths), Clearances(0.015, 0.0), lambda index, _: motion.paths[index],
            lambda _: motion.trajectory,
            lambda sent: check(planner.model, sent, read_scene(graph), around),
            frozenset({"wall"}),
        )  # fmt: skip
    assert (failure.value.bound, failure.value.phase) == ("path", "place")
