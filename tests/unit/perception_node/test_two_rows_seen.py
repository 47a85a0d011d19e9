# SPDX-License-Identifier: Apache-2.0
"""Two rows of places: what is seen is right, and what blocks hide is said to be hidden."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from seen_worlds import PERCEPTION, move_hand, observe, perceive, put

from perception_node import Perceived, Perception, PerceptionConfig
from scene_graph import FRONT, UP, GraphStatus, Relation, SceneGraph, Stacks, is_hidden
from sim_node import World, parse_scene, true_scene_graph

PLACES = tuple((x, y, 0.0) for x in (0.58, 0.42) for y in (-0.15, 0.0, 0.15))
TOWER = ("red_box", "blue_box", "green_box", "purple_box")


def world_from(height: float) -> World:
    """Two rows, and a camera at a height over the table [m]."""
    places = ", ".join(f"[{x}, {y}]" for x, y, _ in PLACES)
    camera = f"- {{position: [1.45, 0.0, {height}], target: [0.5, 0.0, 0.08]}}"
    return World(parse_scene(f"places: [{places}]\ncameras:\n  {camera}\n"))


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with world_from(0.6) as found:
        yield found


@pytest.fixture(scope="module")
def perception() -> Perception:
    return PERCEPTION.configured(PerceptionConfig(stack_positions=PLACES))


def look(world: World, perception: Perception, layout: Stacks, seed: int = 0) -> Perceived:
    world.reset(layout, seed)
    return perceive(world, perception=perception)


def stand_ins(graph: SceneGraph) -> list[str]:
    return [name for name in graph.names if is_hidden(name)]


def test_nothing_hidden_is_confident_with_front_relations(
    world: World, perception: Perception
) -> None:
    seen = look(world, perception, (("red_box",), (), (), ("blue_box", "green_box"), (), ()))
    assert seen.status is GraphStatus.CONFIDENT, seen.message
    assert seen.graph.relations == true_scene_graph(world).relations
    assert Relation("red_box", FRONT, "blue_box") in seen.graph.relations
    assert [place.row for place in seen.graph.places] == [0, 0, 0, 1, 1, 1]
    assert [place.column for place in seen.graph.places] == [0, 1, 2, 0, 1, 2]


def test_a_block_of_which_nothing_is_seen_is_reported_hidden(
    world: World, perception: Perception
) -> None:
    seen = look(world, perception, ((), TOWER, (), (), ("yellow_box",), ()))
    assert seen.status is GraphStatus.HIDDEN
    assert seen.message == (
        "what stands on stack4 is hidden by red_box, blue_box, green_box, purple_box on stack1; "
        "move that aside, or look from higher up"
    )
    assert seen.graph.stacks() == ((), TOWER, (), (), ("hidden_stack4",), ())


def test_a_place_that_nothing_is_seen_of_is_not_said_to_be_empty(
    world: World, perception: Perception
) -> None:
    seen = look(world, perception, ((), TOWER, (), ("yellow_box",), (), ()))
    assert seen.status is GraphStatus.HIDDEN
    assert stand_ins(seen.graph) == ["hidden_stack4"]


def test_what_is_seen_over_hidden_blocks_stands_on_what_stands_for_them(
    world: World, perception: Perception
) -> None:
    behind = ("yellow_box", "orange_box", "cyan_box")
    seen = look(world, perception, ((), TOWER[:3], (), (), behind, ()))
    assert seen.status is GraphStatus.HIDDEN, seen.message
    stack = seen.graph.stacks()[4]
    assert stack[0] == "hidden_stack4" and stack[-1] == "cyan_box"
    bottom = seen.graph.object("hidden_stack4")
    above = seen.graph.object(stack[1])
    assert bottom.size[2] == pytest.approx(above.position_world[2] - 0.5 * above.size[2], abs=0.004)


def test_a_block_of_which_half_is_seen_is_measured(world: World, perception: Perception) -> None:
    seen = look(world, perception, ((), ("red_box", "blue_box"), (), (), ("yellow_box",), ()))
    assert seen.status is GraphStatus.CONFIDENT, seen.message
    true = true_scene_graph(world).object("yellow_box")
    found = seen.graph.object("yellow_box")
    assert np.allclose(found.position_world, true.position_world, atol=0.003)
    assert np.allclose(found.size, true.size, atol=0.003)


def test_how_high_a_stack_may_be_that_hides_nothing_is_told(
    world: World, perception: Perception
) -> None:
    low = look(world, perception, (("red_box",), (), (), (), (), ())).graph.places[0].clear[3]
    with world_from(0.85) as other:
        high = look(other, perception, (("red_box",), (), (), (), (), ())).graph.places[0].clear[3]
    assert 0.045 < low < 0.09 <= high + 0.01
    places = look(world, perception, (("red_box",), (), (), (), (), ())).graph.places
    assert all(np.isinf(places[3].clear)) and np.isinf(places[0].clear[4])


def test_a_block_in_the_air_over_a_place_that_is_seen_is_unstable(
    world: World, perception: Perception
) -> None:
    world.reset((("red_box",), (), (), ("blue_box",), (), ()), 0)
    put(world, "blue_box", (0.0, 0.0, 0.06))
    seen = perceive(world, perception=perception)
    assert seen.status is GraphStatus.UNSTABLE
    assert "in the air" in seen.message


def test_a_hand_over_the_places_is_no_block(world: World, perception: Perception) -> None:
    world.reset((("red_box",), (), (), ("blue_box",), (), ()), 0)
    move_hand(world, (0.5, 0.1, 0.25))
    assert perceive(world, perception=perception).status is GraphStatus.OCCLUDED


def test_without_depth_it_cannot_be_told_which_row(world: World, perception: Perception) -> None:
    world.reset((("red_box",), (), (), ("blue_box",), (), ()), 0)
    seen = perception.perceive(replace(observe(world), depth=None))
    assert seen.status is GraphStatus.BAD_IMAGE
    assert "which of two rows" in seen.message


@pytest.mark.parametrize("seed", range(6))
def test_no_graph_says_what_is_not_true(world: World, perception: Perception, seed: int) -> None:
    rng = np.random.default_rng(seed)
    colors = ("red", "blue", "green", "yellow", "purple", "orange")
    stacks: list[list[str]] = [[] for _ in PLACES]
    for color in rng.permutation(colors):
        stacks[rng.choice((0, 0, 1, 1, 2, 3, 4, 5))].append(f"{color}_box")
    layout = tuple(map(tuple, stacks))
    seen = look(world, perception, layout, seed)
    assert seen.status in (GraphStatus.CONFIDENT, GraphStatus.HIDDEN), seen.message
    names = {name for name in seen.graph.names if not is_hidden(name)}
    for here, there in zip(seen.graph.stacks(), layout):
        assert [n for n in here if not is_hidden(n)] == [n for n in there if n in names]
        assert any(map(is_hidden, here)) or here == there
    for relation in seen.graph.relations:
        if relation.predicate == UP and not is_hidden(relation.object + relation.subject):
            assert relation in true_scene_graph(world).relations or any(
                map(is_hidden, (relation.subject, relation.object))
            )
