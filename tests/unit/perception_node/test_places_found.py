# SPDX-License-Identifier: Apache-2.0
"""Places are where stacks stand, and free ones lie beside them (5.4.1); cast solids and the
simulated world are the oracles."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from perception_scenes import Solid, cast, looking_camera
from seen_worlds import PERCEPTION, move_hand, observe

from perception_node import Observation, PerceptionConfig, PlaceSearch
from perception_node.blocks import BlockSurface
from perception_node.errors import HiddenPlacesError, PlacesError
from perception_node.parameters import FOUND, PARAMETERS, config_from_parameters
from perception_node.places import Points
from perception_node.places.found import SLACK, find_places, search_volume
from perception_node.segment import RGB
from scene_graph import GraphStatus, Stacks
from sim_node import World, parse_scene

CAMERA = looking_camera()
Spot = tuple[float, float]


def surface(x: float, y: float, level: int = 0) -> BlockSurface:
    low = 0.045 * level
    return BlockSurface(
        "box", (x, y), 0.0, (0.045, 0.045), low, low + 0.045, np.zeros((7, 7)), seen_low=low
    )


def found(
    stacks: dict[Spot, int], search: PlaceSearch | None = None, others: tuple[Solid, ...] = ()
) -> Points:
    """Of stacks that are so high, each at its spot, with other things around them."""
    search = search or PlaceSearch()
    solids = [
        Solid("box", (x, y, 0.0225 + 0.045 * level))
        for (x, y), height in stacks.items()
        for level in range(height)
    ]
    depth, labels = cast([*solids, *others], CAMERA)
    labelled = (labels > 0) & (labels <= len(solids))
    rgb = np.full((*depth.shape, 3), 128, np.uint8)
    surfaces = [surface(*spot, level) for spot, height in stacks.items() for level in range(height)]
    volume = search_volume(search, 0.36)
    return find_places(Observation(rgb, None, depth, CAMERA), labelled, surfaces, search, volume)


def spots(places: Points) -> list[Spot]:
    return [(x, y) for x, y, _ in places]


def test_there_are_as_many_places_as_stacks_from_the_left() -> None:
    there = {(0.47, 0.17): 2, (0.52, -0.16): 1, (0.5, 0.02): 4}
    assert spots(found(there)) == [(0.52, -0.16), (0.5, 0.02), (0.47, 0.17)]
    assert found({}) == ()


def test_a_tower_that_leans_on_its_way_up_has_its_place_under_its_lowest_block() -> None:
    bent = [surface(0.5, 0.04, 2), surface(0.5, 0.0), surface(0.5, 0.02, 1)]
    depth, _ = cast([], CAMERA)
    observation = Observation(np.full((*depth.shape, 3), 128, np.uint8), None, depth, CAMERA)
    search = PlaceSearch()
    nothing = np.zeros(depth.shape, bool)
    places = find_places(observation, nothing, bent, search, search_volume(search, 0.36))
    assert spots(places) == [(0.5, 0.0)]


@settings(max_examples=10, deadline=None)
@given(st.floats(-0.12, 0.0), st.floats(0.13, 0.16), st.floats(-0.05, 0.05))
def test_free_places_are_on_the_line_in_reach_and_leave_the_hand_room(
    y: float, apart: float, turn: float
) -> None:
    there = {(0.5, y): 1, (0.5 + turn, y + apart): 2}
    search = PlaceSearch(count=3)
    places = found(there, search)
    assert len(places) == 3 and set(there) <= set(spots(places))
    assert [place[1] for place in places] == sorted(place[1] for place in places)
    (one, other) = there
    length = math.dist(one, other)
    for x, y_free in set(spots(places)) - set(there):
        off = (other[0] - one[0]) * (y_free - one[1]) - (other[1] - one[1]) * (x - one[0])
        assert abs(off) / length < 1e-9
        assert 0.30 <= math.hypot(x, y_free) <= 0.75
        others = [spot for spot in spots(places) if spot != (x, y_free)]
        nearest = min(math.dist((x, y_free), spot) for spot in others)
        # Never nearer than the hand needs, and no farther than one step.
        assert search.gap <= nearest <= search.gap + 0.005


def test_beside_one_stack_places_are_laid_across_the_view() -> None:
    places = found({(0.5, 0.0): 1}, PlaceSearch(count=3))
    assert np.allclose([x for x, _, _ in places], 0.5)
    assert np.allclose([y for _, y, _ in places], [-0.12, 0.0, 0.12], atol=0.0051)


def test_free_places_are_not_where_other_things_stand() -> None:
    there, search = {(0.5, -0.06): 1, (0.5, 0.08): 1}, PlaceSearch(count=3)
    places = found(there, search, (Solid("box", (0.5, 0.2, 0.1), (0.04, 0.04, 0.1)),))
    assert places[0][1] == pytest.approx(-0.18, abs=0.0051)
    (_, _, right) = found(there, search, (Solid("box", (0.5, -0.2, 0.1), (0.04, 0.04, 0.1)),))
    assert right[1] == pytest.approx(0.2, abs=0.0051)


def test_places_are_not_found_where_something_may_hide_a_stack_of_the_row() -> None:
    there = {(0.5, -0.06): 1, (0.5, 0.08): 1}
    hand = Solid("box", (0.75, 0.16, 0.1), (0.01, 0.05, 0.1))
    with pytest.raises(
        HiddenPlacesError, match=r"hides \(0.50, 0.2\d\) m, where a stack may stand"
    ):
        found(there, others=(hand,))
    # What is too low, or over it, or the foot of the arm behind it, hides none.
    for others in (
        replace(hand, centre=(0.75, 0.16, 0.02), half=(0.01, 0.05, 0.02)),
        replace(hand, centre=(0.75, 0.16, 0.4)),
        Solid("box", (0.0, 0.0, 0.2), (0.08, 0.08, 0.2)),
    ):
        assert len(found(there, others=(others,))) == 2


@pytest.mark.parametrize(
    ("there", "search", "sentence"),
    [
        (
            {(0.5, -0.15): 1, (0.5, 0.0): 1, (0.5, 0.15): 1},
            PlaceSearch(count=2),
            "3 stacks are seen but place_count is 2; take blocks away, or raise place_count",
        ),
        (
            {(0.5, 0.0): 1, (0.78, 0.15): 1},
            PlaceSearch(),
            r"a stack stands at \(0.78, 0.15\) m, 0.79 m from the arm's axis, which reaches 0.3 to "
            r"0.75 m \(place_reach\); move it, or take it away",
        ),
        (
            {(0.5, 0.0): 1, (0.5, 0.1): 1},
            PlaceSearch(),
            r"the stacks at \(0.50, 0.00\) m and \(0.50, 0.10\) m are 100 mm apart, and the hand "
            "needs 105 mm; move one, or lower place_gap",
        ),
        (
            {(0.4, 0.0): 1, (0.6, 0.02): 1},
            PlaceSearch(),
            "one stands before the other, as the camera sees them; move one aside",
        ),
        (
            {(0.5, -0.1): 1, (0.5, 0.1): 1},
            PlaceSearch(count=8),
            "there is room for [0-5] free places, 120 mm apart, .* place_count asks for 8; lower",
        ),
    ],
)
def test_stacks_that_make_no_row_are_refused_with_what_to_do(
    there: dict[Spot, int], search: PlaceSearch, sentence: str
) -> None:
    with pytest.raises(PlacesError, match=sentence):
        found(there, search)


def test_stacks_that_are_there_may_be_a_little_nearer_than_free_places_are_laid() -> None:
    apart = PlaceSearch().gap - SLACK + 0.001
    assert len(found({(0.5, 0.0): 1, (0.5, apart): 1})) == 2


LAYOUT: Stacks = (("red_box", "blue_box"), ("green_box",), ("yellow_box", "purple_box"))
PLACES = [[0.47, -0.21], [0.50, 0.05], [0.51, 0.18]]
SOUGHT = PerceptionConfig(stack_positions=(), search=PlaceSearch(count=4))


def test_stacks_anywhere_are_found_in_one_picture_and_interpreted_with_their_places() -> None:
    perception = PERCEPTION.configured(SOUGHT)
    with World(parse_scene(yaml.safe_dump({"places": PLACES}))) as world:
        world.reset(LAYOUT, 7)
        observation = observe(world)
        bottoms = [world.block_pose(stack[0])[0] for stack in LAYOUT]
        move_hand(world, (0.55, 0.04, 0.2))
        covered = observe(world)
    it_with_places, perceived = perception.find_places(observation)
    assert perceived.status is GraphStatus.CONFIDENT, perceived.message
    # The free one has room between the first two.
    assert perceived.graph.stacks() == (LAYOUT[0], (), *LAYOUT[1:])
    positions = [place.position_world for place in perceived.graph.places]
    for position, bottom in zip([positions[0], *positions[2:]], bottoms):
        assert math.dist(position[:2], bottom[:2]) < 0.002
    assert all(math.dist(a, b) > 0.115 for a, b in itertools.combinations(positions, 2))
    again = it_with_places.perceive(observation)
    assert again.graph.relations == perceived.graph.relations

    # What cannot be planned on leaves no places, and another perception of the same parts alone.
    same, perceived = perception.find_places(covered)
    assert same is perception and not perceived.status.sees_all and perceived.message
    same, perceived = perception.find_places(replace(observation, depth=None))
    assert same is perception and perceived.status is GraphStatus.BAD_IMAGE
    few = perception.configured(replace(SOUGHT, search=PlaceSearch(count=2)))
    same, perceived = few.find_places(observation)
    assert same is few and perceived.status is GraphStatus.NO_PLACES
    assert "3 stacks are seen but place_count is 2" in perceived.message


def test_an_empty_table_has_no_places(world: World) -> None:
    world.reset((("red_box",), (), ()))
    world.move_block("red_box", (3.0, 3.0, 0.0225), (0.0, 0.0, 0.0, 1.0))
    perception = PERCEPTION.configured(SOUGHT)
    same, perceived = perception.find_places(observe(world))
    assert same is perception and perceived.status is GraphStatus.NO_OBJECTS
    assert perceived.message.startswith("no block is seen in reach")


def test_places_cannot_be_found_in_colour_alone() -> None:
    values = {item.name: item.default for item in PARAMETERS} | {"places": FOUND}
    assert config_from_parameters(values).stack_positions == ()
    with pytest.raises(ValueError, match="places are found in depth"):
        config_from_parameters({**values, "mask_source": RGB})
