# SPDX-License-Identifier: Apache-2.0
"""What would make a refused plan feasible: followed by its words, and no larger than needed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import scene
from obstacle_scenes import WIDE, pen, wall
from refusal_tables import Refused, followed

from motion_node.certificate import Suggestions
from motion_node.certificate.changes import Change
from motion_node.certificate.levers import Table
from motion_node.certificate.tower_lever import TowerLever
from motion_node.errors import InfeasibleError
from motion_node.obstacles import Obstacle
from motion_node.planner import MotionPlanner
from scene_graph import Move

OPEN = np.full(2, 0.04)
NOWHERE = Obstacle("far post", (0.02, 0.02, 0.02), (-0.4, -0.5, 0.01))


@pytest.fixture(scope="module")
def surrounded(urdf: str) -> MotionPlanner:
    return MotionPlanner(urdf, obstacles=[NOWHERE] * 4)


def refusal(planner: MotionPlanner, table: Refused) -> InfeasibleError | None:
    if table.obstacles:
        planner.surround(table.obstacles)
    try:
        planner.solve(table.graph, [table.move], planner.model.home, OPEN)
    except InfeasibleError as error:
        return error
    return None


def suggested(planner: MotionPlanner, table: Refused) -> tuple[str, Change]:
    """What is said of a table; it helps, and half of it does not."""
    error = refusal(planner, table)
    assert error is not None
    assert any(word in error.constraint for word in table.words), error
    before = planner.obstacles
    found = Suggestions(planner).suggest(table.graph, [table.move], planner.model.home, OPEN, error)
    assert planner.obstacles == before
    assert found is not None
    assert refusal(planner, followed(table, found.words)) is None
    change = found.change
    half = replace(change, amounts=tuple(0.5 * amount for amount in change.amounts))
    halved = half.made(Table(table.graph, table.obstacles))
    half_way = replace(table, graph=halved.graph, obstacles=halved.obstacles)
    assert refusal(planner, half_way) is not None
    return found.words, found.change


def test_a_place_out_of_reach_is_moved_nearer_by_what_is_missing(planner: MotionPlanner) -> None:
    graph = scene((1, 1, 0), places=(*WIDE[:2], (0.95, 0.2)))
    table = Refused("", graph, ("reach of the hand to",))
    words, change = suggested(planner, table)
    assert words.startswith("move the place stack2 ")
    assert words.endswith("mm nearer to the arm")
    error = refusal(planner, table)
    assert error is not None
    assert change.size == pytest.approx(error.violation, abs=0.03)


def test_a_block_out_of_reach_is_moved_without_its_place(planner: MotionPlanner) -> None:
    graph = scene((1, 0, 0), places=((0.9, -0.2), *WIDE[1:]))
    words, _ = suggested(planner, Refused("", graph, ("reach of the hand to",)))
    assert words.startswith("move red_box ")


def test_a_block_too_wide_has_to_be_narrower_by_what_is_missing(planner: MotionPlanner) -> None:
    words, _ = suggested(planner, Refused("", scene((1, 0, 0), edge=0.08), ("width",)))
    assert words == "make red_box 11 mm narrower"


def test_a_tower_too_high_loses_whole_blocks(planner: MotionPlanner) -> None:
    graph = scene((1, 0, 12), places=WIDE, edge=0.065)
    table = Refused("", graph, ("reach of the hand to", "lift"))
    words, _ = suggested(planner, table)
    top = graph.stacks()[2][::-1]
    taken = words.removeprefix("take ").removesuffix(" off the stack at stack2").split(", ")
    assert taken == list(top[: len(taken)])
    # With one block less taken it cannot be.
    if fewer := ", ".join(taken[:-1]):
        less = followed(table, f"take {fewer} off the stack at stack2")
        assert refusal(planner, less) is not None


def test_a_stack_is_lowered_by_parts_of_blocks_and_by_whole_ones() -> None:
    table = Table(scene((0, 0, 3), places=WIDE, edge=0.05))
    names = table.graph.stacks()[2][::-1]
    lever = TowerLever(2, names, (0.05,) * 3)
    for amount, left in ((0.001, 3), (0.049, 3), (0.05, 2), (0.06, 2), (0.1, 1), (0.15, 0)):
        graph = lever.pulled(table, amount).graph
        assert graph.stacks()[2] == names[::-1][:left]
        tops = [item.position_world[2] + item.size[2] / 2 for item in graph.objects]
        assert max(tops, default=0.0) == pytest.approx(0.15 - amount)
    assert [lever.rounded(a) for a in (0.001, 0.05, 0.051, 9.0)] == pytest.approx(
        [0.05, 0.05, 0.1, 0.15]
    )


def test_a_fence_round_a_place(surrounded: MotionPlanner) -> None:
    table = Refused("", scene((1, 1, 0), places=WIDE), ("fence",), pen(0.5, 0.2, 0.15))
    words, _ = suggested(surrounded, table)
    assert "fence" in words or "stack2" in words


def test_a_wall_beside_a_place(surrounded: MotionPlanner) -> None:
    around = (wall(0.5, 0.14, 0.3, 0.3),)
    words, _ = suggested(surrounded, Refused("", scene((1, 1, 0), places=WIDE), ("wall",), around))
    assert "wall" in words or "stack2" in words


def test_what_is_stopped_suggests_nothing(planner: MotionPlanner) -> None:
    table = Refused("", scene((1, 0, 0), places=((0.9, -0.2), *WIDE[1:])), ())
    error = refusal(planner, table)
    assert error is not None
    found = Suggestions(planner).suggest(
        table.graph, [Move(0, 2)], planner.model.home, OPEN, error, lambda: True
    )
    assert found is None
