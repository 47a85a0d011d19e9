# SPDX-License-Identifier: Apache-2.0
"""Two rows of places: the back one is reached over towers of the front one, touching nothing."""

from __future__ import annotations

import numpy as np
import pytest
from collision_oracle import replay

from motion_node import PANDA
from motion_node.planner import MotionPlanner
from scene_graph import Move, SceneGraph, SceneObject, Stacks, in_rows, up_relations

EDGE = 0.045


def scene(stacks: Stacks, apart: float, gap: float = 0.15) -> SceneGraph:
    """Two rows of three places that are so far apart, with so much between neighbours [m]."""
    positions = tuple((x, y, 0.0) for x in (0.58, 0.58 - apart) for y in (-gap, 0.0, gap))
    objects = [
        SceneObject(name, "red", "box", (*positions[i][:2], (level + 0.5) * EDGE), size=(EDGE,) * 3)
        for i, stack in enumerate(stacks)
        for level, name in enumerate(stack)
    ]
    places = in_rows(positions, (1.45, 0.0, 0.85))
    return SceneGraph(tuple(objects), up_relations(stacks), places)


TOWER = ("a_box", "b_box", "c_box")


@pytest.mark.parametrize(
    ("stacks", "moves"),
    [
        ((TOWER, (), (), ("d_box",), (), ()), (Move(3, 4), Move(4, 2))),
        (((), TOWER, (), ("d_box",), (), ()), (Move(3, 4), Move(1, 4))),
        ((("a_box",), ("b_box",), ("c_box",), (), ("d_box", "e_box"), ()), (Move(4, 5),)),
    ],
)
def test_the_back_row_is_reached_over_the_front_row(
    planner: MotionPlanner, stacks: Stacks, moves: tuple[Move, ...]
) -> None:
    graph = scene(stacks, 0.16)
    fingers = np.full(2, PANDA.gripper.finger_travel)
    motion = planner.solve(graph, moves, np.array(PANDA.home), fingers)
    settings = planner.settings
    found = replay(graph, moves, motion, settings.phases.place_gap, vertical=0.03)
    assert found.free.distance > 0.003, found.free


def test_where_rows_are_near_the_hand_is_turned_along_them(planner: MotionPlanner) -> None:
    stacks: Stacks = ((), ("a_box", "b_box"), (), (), ("c_box", "d_box"), ())
    graph = scene(stacks, 0.145, 0.17)
    fingers = np.full(2, PANDA.gripper.finger_travel)
    motion = planner.solve(graph, [Move(1, 0)], np.array(PANDA.home), fingers)
    assert motion.phases[0].switch is not None
    assert abs(motion.phases[0].switch.yaw) == pytest.approx(np.pi / 2, abs=0.01)
