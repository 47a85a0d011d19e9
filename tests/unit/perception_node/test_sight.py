# SPDX-License-Identifier: Apache-2.0
"""What a picture does not show is not taken for free."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from seen_worlds import LABELLED, TOWERS, observe, perceive

from scene_graph import BOX, COLORS, GraphStatus, object_name
from sim_node import World, parse_scene


@pytest.mark.parametrize("side", ["left", "right", "upper", "lower"])
def test_a_picture_that_lost_a_half_makes_no_graph(world: World, side: str) -> None:
    world.reset(TOWERS)
    frame = world.render()
    half = np.zeros(frame.labels.shape, bool)
    rows, columns = (int(number) // 2 for number in frame.rgb.shape[:2])
    part: dict[str, Any] = {
        "left": np.s_[:, :columns],
        "right": np.s_[:, columns:],
        "upper": np.s_[:rows],
        "lower": np.s_[rows:],
    }
    half[part[side]] = True
    rgb, depth = frame.rgb.copy(), np.where(half, 0.0, frame.depth)
    rgb[half] = 0
    perceived = perceive(world, replace(frame, rgb=rgb, depth=depth))
    assert perceived.status is GraphStatus.BAD_IMAGE
    assert "stack" in perceived.message


@pytest.mark.parametrize("name", [name for stack in TOWERS for name in stack])
def test_a_block_without_label_and_depth_is_missed_by_nobody(world: World, name: str) -> None:
    world.reset(TOWERS)
    frame = world.render()
    gone = frame.labels == world.label(name)
    labels, depth = np.where(gone, 0, frame.labels), np.where(gone, np.nan, frame.depth)
    perceived = perceive(world, replace(frame, labels=labels, depth=depth), LABELLED)
    assert perceived.status is not GraphStatus.CONFIDENT and perceived.message


def scene_of(text: str) -> World:
    return World(parse_scene(text))


def test_a_place_outside_the_picture_is_named() -> None:
    with scene_of("cameras: [{name: camera, target: [0.5, 0.25, 0.1]}]") as world:
        world.reset((("red_box",), (), ("blue_box",)))
        perceived = perceive(world)
    assert perceived.status is GraphStatus.BAD_IMAGE
    assert perceived.message.startswith("stack0 is not in the picture")


def test_a_tower_that_ends_above_the_picture_is_noticed() -> None:
    names = [object_name(color, BOX) for color in list(COLORS)[:7]]
    with scene_of("cameras: [{name: camera, target: [0.5, 0.0, 0.0]}]") as world:
        world.reset((tuple(names), (), ()))
        perceived = perceive(world, world.render())
    assert perceived.status is GraphStatus.BAD_IMAGE
    reaching = "block reaches the upper edge of the picture"
    told = {color for color in COLORS if perceived.message.startswith(f"the {color} {reaching}")}
    assert len(told) == 1
    # The others are told of, and nothing of how they stand.
    others = {item.color for item in perceived.graph.objects}
    assert {*list(COLORS)[:5]} <= others < {*list(COLORS)[:7]} and not others & told
    assert not perceived.graph.relations


@pytest.mark.parametrize(("count", "seen"), [(8, True), (9, False), (10, False)])
def test_a_tower_higher_than_what_is_looked_at_is_noticed(count: int, seen: bool) -> None:
    names = tuple(object_name(color, BOX) for color in list(COLORS)[:count])
    camera = {"name": "camera", "position": [1.6, 0.0, 0.45], "target": [0.5, 0.0, 0.24]}
    blocks = {"most": 12, "colors": list(COLORS)}
    with scene_of(yaml.safe_dump({"blocks": blocks, "cameras": [camera]})) as world:
        world.reset((names, (), ()))
        perceived = perceive(world, world.render())
    assert (perceived.status is GraphStatus.CONFIDENT) == seen, perceived.message
    assert seen or "set column_height" in perceived.message


def test_the_observation_of_a_whole_scene_is_believed(world: World) -> None:
    world.reset(TOWERS)
    assert observe(world).depth is not None
    assert perceive(world).status is GraphStatus.CONFIDENT
