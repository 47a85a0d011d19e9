# SPDX-License-Identifier: Apache-2.0
"""How blocks are taken: where the fingers close, in which direction, and how high."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from collision_oracle import replay
from motion_scenes import EDGE, scene

from motion_node.blocks import Block, read_scene
from motion_node.errors import InvalidPlanError
from motion_node.expand import free_yaw
from motion_node.grasps import GRASPS, Circumstances, choose_grasp
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from scene_graph import BOX, CYLINDER, SHAPES, SPHERE, Move, Place, wrap_line

HAND = PANDA.gripper
WIDEST = 0.07


def block(
    shape: str = BOX, yaw: float = 0.0, size: tuple[float, float, float] = (EDGE,) * 3
) -> Block:
    return Block((0.5, 0.0, size[2] / 2), yaw, size, f"red_{shape}", shape)


def angle_between_lines(one: float, other: float) -> float:
    return abs(wrap_line(one - other))


def test_there_is_a_grasp_for_every_shape() -> None:
    assert set(GRASPS) == set(SHAPES)


def test_a_shape_without_a_grasp_is_refused() -> None:
    with pytest.raises(InvalidPlanError, match="is a pyramid; there are grasps for box") as caught:
        choose_grasp(block("pyramid"), Circumstances(HAND), WIDEST)
    assert caught.value.object_name == "red_pyramid"


@pytest.mark.parametrize("yaw", [-0.7, -0.2, 0.0, 0.4, 1.2, 2.0, 3.0])
def test_fingers_close_on_faces_and_along_the_row_of_no_neighbour(yaw: float) -> None:
    grasp = choose_grasp(block(yaw=wrap_line(yaw)), Circumstances(HAND), WIDEST)
    assert abs(grasp.yaw) <= np.pi / 4 + 1e-9
    assert np.cos(4 * (grasp.yaw - yaw)) == pytest.approx(1.0)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("height", "lowest", "highest"), [(0.014, 0.0, 0.014), (0.12, 0.07, 0.12)])
def test_low_and_tall_blocks_are_taken_where_hand_and_table_allow(
    shape: str, height: float, lowest: float, highest: float
) -> None:
    taken = block(shape, size=(0.04, 0.04, height))
    grasp = choose_grasp(taken, Circumstances(HAND), WIDEST)
    tcp = taken.position_world[2] + grasp.height
    assert tcp - (HAND.finger_tip - HAND.tcp_offset) >= lowest + 0.004
    assert tcp + (HAND.tcp_offset - HAND.palm) >= highest + 0.004


@pytest.mark.parametrize("shape", [CYLINDER, SPHERE])
@pytest.mark.parametrize("free", [-0.6, 0.0, 1.1])
def test_a_round_block_is_taken_across_the_line_to_its_neighbour(shape: str, free: float) -> None:
    grasp = choose_grasp(block(shape), Circumstances(HAND, free_yaw=free), WIDEST)
    assert grasp.yaw == free
    assert grasp.width == grasp.depth == EDGE


@pytest.mark.parametrize(
    ("places", "direction"),
    [
        ([(0.5, -0.15), (0.5, 0.0), (0.5, 0.15)], 0.0),
        ([(0.4, 0.0), (0.6, 0.0)], np.pi / 2),
        ([(0.4, 0.0), (0.5, 0.1), (0.5, 0.5)], -np.pi / 4),
        ([(0.5, 0.0)], 0.0),
    ],
)
def test_the_free_direction_is_across_the_line_to_the_nearest_place(
    places: list[tuple[float, float]], direction: float
) -> None:
    row = [Place(index, (x, y, 0.0)) for index, (x, y) in enumerate(places)]
    assert angle_between_lines(free_yaw(row, 0), direction) < 1e-9


def test_a_round_block_between_places_one_behind_the_other_is_moved_and_touches_nothing(
    planner: MotionPlanner,
) -> None:
    """The boxes' rule, fingers along x, would put them into the tower behind."""
    graph = scene((1, 3), places=[(0.42, 0.0), (0.55, 0.0)])
    first = replace(graph.objects[0], shape=CYLINDER)
    graph = replace(graph, objects=(first, *graph.objects[1:]))
    assert read_scene(graph).stacks[0][0].shape == CYLINDER
    moves = [Move(0, 1)]
    motion = planner.solve(graph, moves, planner.model.home, np.array([0.04, 0.04]))
    pick = motion.phases[0].switch
    assert pick is not None
    assert abs(pick.yaw) == pytest.approx(np.pi / 2)
    result = replay(graph, moves, motion, planner.settings.phases.place_gap, vertical=0.03)
    assert result.free.distance > 0.005, result.free
