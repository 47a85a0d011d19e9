# SPDX-License-Identifier: Apache-2.0
"""Blocks that lie before the row are named, and nothing else changes; the world is the oracle."""

from __future__ import annotations

import math

import pytest
from seen_worlds import perceive

from perception_node.segment.volume import FALLEN, NEAR
from scene_graph import GraphStatus, Stacks, up_relations
from sim_node.world import World

LAYOUT: Stacks = (("red_box", "blue_box"), ("green_box",), ("yellow_box",))
STANDING: Stacks = (("red_box",), ("green_box",), ("yellow_box",))
#: On its side, and turned.
LYING = (math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4))


@pytest.mark.parametrize("away", [0.125, 0.16, 0.185])
@pytest.mark.parametrize("y", [-0.1, 0.07])
def test_a_block_that_fell_before_the_row_is_named_and_blinds_for_nothing(
    world: World, away: float, y: float
) -> None:
    assert NEAR < away < FALLEN
    world.reset(LAYOUT)
    there = (0.5 + away, y, 0.0225)
    world.move_block("blue_box", there, LYING)
    perceived = perceive(world)
    graph = perceived.graph
    stray = graph.object("blue_box")
    assert math.dist(stray.position_world[:2], there[:2]) < 0.03
    assert not any(stray.size)
    assert graph.relations == up_relations(STANDING)
    if perceived.status is not GraphStatus.CONFIDENT:  # it stands before a place
        assert perceived.status is GraphStatus.OCCLUDED
        assert perceived.message.endswith("before the places lies blue_box")


def test_what_stands_on_its_place_is_no_stray(world: World) -> None:
    world.reset(LAYOUT)
    graph = perceive(world).graph
    assert sorted(item.name for item in graph.objects if not any(item.size)) == []
    assert graph.stacks() == LAYOUT
