# SPDX-License-Identifier: Apache-2.0
"""Blocks that look alike keep their names while they move, or get new ones: never others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from perception_node.alike import Alike
from perception_node.names import unique_names
from perception_node.pipeline import Perceived
from scene_graph import (
    HIDDEN,
    GraphStatus,
    SceneGraph,
    SceneObject,
    hidden_name,
    up_relations,
)

PLACES = (-0.15, 0.0, 0.15)
COLORS = ("red", "red", "red", "blue", "blue", "green")
SECOND = 1_000_000_000


def picture(
    stacks: list[list[int]], rng: np.random.Generator, status: GraphStatus = GraphStatus.CONFIDENT
) -> tuple[Perceived, dict[tuple[float, float, float], int]]:
    """What is perceived of blocks, by their numbers, on three places, and who is where."""
    names = unique_names(COLORS, ["box"] * len(COLORS), stacks)
    objects, who = [], {}
    for place, stack in zip(PLACES, stacks):
        for level, block in enumerate(stack):
            x, y, z = np.array([0.5, place, 0.0225 + 0.045 * level]) + rng.normal(0, 0.001, 3)
            at = (float(x), float(y), float(z))
            who[at] = block
            objects.append(SceneObject(names[block], COLORS[block], "box", at, size=(0.045,) * 3))
    relations = up_relations(tuple(tuple(names[block] for block in stack) for stack in stacks))
    ordered = tuple(sorted(objects, key=lambda item: item.name))
    return Perceived(SceneGraph(ordered, frozenset(relations)), status), who


def moved(stacks: list[list[int]], rng: np.random.Generator) -> None:
    source = rng.choice([index for index, stack in enumerate(stacks) if stack])
    target = rng.choice([index for index in range(3) if index != source])
    stacks[target].append(stacks[source].pop())


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.lists(st.integers(0, 4), min_size=1, max_size=8))
def test_a_name_means_the_same_block_for_ever(seed: int, moves: list[int]) -> None:
    rng = np.random.default_rng(seed)
    stacks: list[list[int]] = [[], [], []]
    for block in rng.permutation(len(COLORS)):
        stacks[rng.integers(3)].append(int(block))
    alike, stamp = Alike(), 0
    owners: dict[str, int] = {}
    for count in (0, *moves):
        for _ in range(count):
            moved(stacks, rng)
        stamp += SECOND
        perceived, who = picture(stacks, rng)
        before = {item.position_world: item.name for item in perceived.graph.objects}
        named = alike.named(perceived, stamp)
        names = {before[item.position_world]: item.name for item in named.graph.objects}
        for item in named.graph.objects:
            block = who[item.position_world]
            assert COLORS[block] == item.color
            # Blocks that changed places behind the camera's back look as if nothing moved.
            if count <= 1:
                assert owners.setdefault(item.name, block) == block
        if count > 1:
            owners = {item.name: who[item.position_world] for item in named.graph.objects}
        if count == 1:
            assert all("box_" not in name or name in owners for name in names.values())
        renamed = {
            (names[r.subject], names.get(r.object, r.object)) for r in perceived.graph.relations
        }
        assert renamed == {(r.subject, r.object) for r in named.graph.relations}


def test_two_that_moved_at_once_get_names_that_none_had() -> None:
    rng = np.random.default_rng(0)
    alike = Alike()
    alike.named(picture([[0], [1], [5]], rng)[0], SECOND)
    named = alike.named(picture([[], [], [5, 1, 0]], rng)[0], 2 * SECOND)
    assert sorted(named.graph.names) == ["green_box", "red_box_3", "red_box_4"]


def test_a_block_is_followed_on_its_way_past_another_one_that_is_moved_later() -> None:
    rng = np.random.default_rng(0)
    alike = Alike()
    start, _ = picture([[0], [1], []], rng)
    alike.named(start, SECOND)
    (first, second) = start.graph.objects
    for step in range(31):  # the first one, over the other one, onto the third place
        y = -0.15 + 0.01 * step
        z = 0.0225 + 0.15 * np.sin(np.pi * step / 30)
        at = (0.5, y, float(z))
        objects = (
            SceneObject("red_box", "red", "box", second.position_world, size=(0.045,) * 3),
            SceneObject("red_box_2", "red", "box", at, size=(0.045,) * 3),
        )
        seen = Perceived(SceneGraph(objects, frozenset()), GraphStatus.OCCLUDED)
        named = alike.named(seen, SECOND + step * SECOND // 10)
        where = {item.name: item.position_world for item in named.graph.objects}
        assert where == {first.name: at, second.name: second.position_world}


def test_a_message_says_the_names_that_the_graph_has() -> None:
    rng = np.random.default_rng(0)
    alike = Alike()
    alike.named(picture([[0], [1], []], rng)[0], SECOND)
    seen, _ = picture([[], [1], [0]], rng)
    told = Perceived(seen.graph, seen.status, "red_box and red_box_2 stand")
    assert alike.named(told, 2 * SECOND).message == "red_box_2 and red_box stand"


def test_what_is_hidden_keeps_the_name_of_its_place() -> None:
    rng, alike = np.random.default_rng(0), Alike()
    for stamp, places in enumerate(([1], [1, 2], [0, 2], [2])):
        perceived, _ = picture([[0, 1], [2, 3], [4, 5]], rng, GraphStatus.HIDDEN)
        hidden = tuple(
            SceneObject(
                hidden_name(place), HIDDEN, "box", (0.4, PLACES[place], 0.1), size=(0.06, 0.06, 0.1)
            )
            for place in places
        )
        graph = replace(perceived.graph, objects=(*hidden, *perceived.graph.objects))
        named = alike.named(replace(perceived, graph=graph), stamp * SECOND)
        seen = {item.name for item in named.graph.objects if item.color == HIDDEN}
        assert seen == {hidden_name(place) for place in places}
