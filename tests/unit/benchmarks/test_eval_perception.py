# SPDX-License-Identifier: Apache-2.0
"""The sets of pictures that perception is measured on are what they say, and counted rightly."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from perception.answers import Answer
from perception.earlier import earlier_state
from perception.found_truth import on_found_places, place_errors
from perception.readings import reading_rows, relations_of
from perception.scenes import CLUTTER_GAP
from perception.score import refusals, rows_of
from perception.sets import SETS, PictureSet, UnknownSetError, sets_named
from perception.views import view_of

from scene_graph import Place, Relation, SceneGraph, SceneObject, up_relations
from sim_node import SceneConfig, World, parse_scene, random_layout


@pytest.mark.parametrize("item", SETS, ids=lambda item: item.name)
def test_the_same_number_is_the_same_picture_and_others_are_others(item: PictureSet) -> None:
    assert item.draw(3) == item.draw(3)
    drawn = [item.draw(number) for number in range(8)]
    assert len({str(entry.layout) for entry in drawn}) > 1
    assert all(entry.seed >= 1000 for entry in drawn)


@pytest.mark.parametrize("item", SETS, ids=lambda item: item.name)
def test_every_scene_is_a_scene(item: PictureSet) -> None:
    for number in range(3):
        drawn = item.draw(number)
        if drawn.scene is not None:
            scene = parse_scene(yaml.safe_dump(dict(drawn.scene)))
            assert len(scene.stack_positions) == len(drawn.layout)


def test_what_stands_around_is_over_the_table_in_any_of_many_scenes() -> None:
    (item,) = sets_named("rgb_hard")
    for number in range(4100, 4125):  # one of them once had a thing beside the table
        parse_scene(yaml.safe_dump(dict(item.draw(number).scene or {})))


def test_all_states_of_six_blocks_are_drawn_once() -> None:
    (six,) = sets_named("six")
    assert six.count == math.factorial(6) * math.comb(8, 2)
    assert len({six.draw(number).layout for number in range(six.count)}) == six.count


@pytest.mark.parametrize("name", ["blurred", "jpeg", "shifted_depth", "real_camera"])
def test_masks_are_found_in_pictures_as_cameras_take_them(name: str) -> None:
    (item,) = sets_named(name)
    assert item.mask_source == "rgbd" and not item.sensor.is_exact
    scene = item.draw(0).scene
    assert scene is not None
    (camera,) = parse_scene(yaml.safe_dump(dict(scene))).cameras
    assert (camera.width, camera.height) == (640, 480)
    # All else is as in the plain world.
    assert replace(camera, width=256, height=256) == SceneConfig().camera


def middles(labels: np.ndarray) -> np.ndarray:
    """Row and column of the middle of each block's pixels, shape (6, 2) [px]."""
    return np.array([np.argwhere(labels == label).mean(axis=0) for label in range(1, 7)])


def test_pictures_through_a_lens_are_interpreted_as_if_there_were_none() -> None:
    (item,) = sets_named("lens")
    scene = item.draw(0).scene
    assert scene is not None
    lens = parse_scene(yaml.safe_dump(dict(scene))).cameras[0]
    assert lens.distortion[0] == -0.28
    frames, pinhole = {}, replace(lens, distortion=(0.0,) * 5)
    for camera in (lens, pinhole):
        with World(SceneConfig(cameras=(camera,))) as world:
            world.reset(random_layout(3, 6), 3)
            frames[camera] = world.render()
    bent, straight = frames[lens], frames[pinhole]
    seen = view_of(lens, bent).observation(bent.rgb, bent.labels, bent.depth)
    assert seen.labels is not None and seen.camera is not None
    expected = middles(straight.labels)
    assert np.abs(middles(bent.labels) - expected).max() > 3.0
    assert np.abs(middles(seen.labels) - expected).max() < 0.4
    assert np.abs(seen.camera.intrinsics - lens.intrinsics).max() < 1e-6
    exact = view_of(pinhole, straight)
    assert exact.rectification is None and (exact.camera.intrinsics == pinhole.intrinsics).all()


def test_what_a_set_requires_stands_beside_its_rows() -> None:
    (six, real) = sets_named("six,real_camera")
    for item, bounds in ((six, (">= 0.998", ">= 0.95")), (real, (">= 0.97", ">= 0.97"))):
        required = {row.metric: row.required for row in rows_of(item, [answer(True, True)])}
        assert (required["graph right"], required["accepted and right"]) == bounds
        assert required["accepted and wrong"] == "<= 0.001"


@pytest.mark.parametrize("name", ["color_frozen", "color_as_high"])
def test_frozen_colours_are_contradicted_by_depth_where_stacks_are_not_as_high(name: str) -> None:
    (item,) = sets_named(f"damage_{name}")
    bounds = {row.metric: row.required for row in rows_of(item, [answer(False, True)])}
    assert (bounds["accepted and wrong"] is None) == item.as_high
    drawn = item.draw(5)
    with drawn.world() as world:
        world.reset(drawn.layout, drawn.seed)
        now, then = world.render(), earlier_state(world, drawn, item.as_high)
    assert (now.rgb != then.rgb).any()
    assert np.array_equal(now.depth, then.depth) == item.as_high


def test_clutter_stands_clear_of_the_places() -> None:
    (hard,) = sets_named("hard")
    for number in range(20):
        scene = hard.draw(number).scene
        assert scene is not None
        for thing in scene["obstacles"]:
            nearest = min(math.dist(thing["position"], place) for place in scene["places"])
            assert nearest > CLUTTER_GAP


def test_an_unknown_set_is_answered_with_those_that_there_are() -> None:
    with pytest.raises(UnknownSetError, match="there are six, seven"):
        sets_named("six,eight")
    assert sets_named("") == SETS


def answer(right: bool, confident: bool, message: str = "") -> Answer:
    status = "CONFIDENT" if confident else "LOW_CONFIDENCE"
    errors = ((1.0, 2.0, 3.0),) if confident else ()
    return Answer(0, right, confident, status, message, (0.9,), 0.02, errors)


def test_graphs_are_counted_by_right_and_accepted() -> None:
    (item,) = sets_named("six")
    answers = [answer(True, True)] * 6 + [answer(True, False)] * 3 + [answer(False, True)]
    values = {row.metric: row.value for row in rows_of(item, answers)}
    assert values["graph right"] == pytest.approx(0.9)
    assert values["accepted and right"] == pytest.approx(0.6)
    assert values["accepted and wrong"] == pytest.approx(0.1)
    assert values["picture to graph, median"] == pytest.approx(20.0)
    assert values["error of sizes, 99th percentile"] == pytest.approx(2.0)
    assert not any(np.isnan(value) for value in values.values())


def test_refusals_are_counted_without_names_and_numbers() -> None:
    answers = [
        answer(True, False, "red_box is 3 mm high"),
        answer(True, False, "blue_cylinder_2 is 14 mm high"),
        answer(True, True),
    ]
    assert refusals(answers) == {"LOW_CONFIDENCE: BLOCK is N mm high": 2}


def test_a_doubtful_graph_stands_for_each_that_its_names_make() -> None:
    objects = (
        SceneObject("blue_box", "blue", "box"),
        SceneObject("unknown_box", "unknown", "box", alternatives=("orange", "blue", "red")),
    )
    up = frozenset([Relation("unknown_box", "up", "blue_box")])
    graphs = relations_of(SceneGraph(objects, up))
    # Blue it is not, where another one is.
    assert graphs == [
        frozenset([Relation(name, "up", "blue_box")]) for name in ("orange_box", "red_box")
    ]


def test_what_is_published_is_counted_by_how_many_graphs_it_may_be() -> None:
    answers = [(0, False), (1, True), (1, True), (2, True), (4, False)]
    values = {row.metric: row.value for row in reading_rows("a set", answers)}
    assert values == {
        "one graph or a set published": 0.8,
        "right one among the published": 0.75,
        "graphs of a set, mean": 2.0,
        "single graphs among the published": 0.5,
        "right one among the published, of sets of two or more": 0.5,
    }


def on_places(stacks: tuple[tuple[str, ...], ...], *along: float) -> SceneGraph:
    """Stacks at places that are so far along a row [m], the blocks right over them."""
    places = tuple(Place(index, (0.5, y, 0.0)) for index, y in enumerate(along))
    objects = tuple(
        SceneObject(name, name, "box", position_world=place.position_world)
        for stack, place in zip(stacks, places)
        for name in stack
    )
    return SceneGraph(objects, up_relations(stacks), places)


def test_of_places_that_are_found_those_with_stacks_have_to_be_right() -> None:
    truth = on_places((("a", "b"), (), ("c",)), -0.15, 0.0, 0.15)
    # The free one is anybody's choice.
    for found in (
        on_places((("a", "b"), (), ("c",)), -0.152, -0.03, 0.15),
        on_places((("a", "b"), ("c",), ()), -0.152, 0.15, 0.27),
    ):
        assert on_found_places(truth, found) == found.relations
        assert place_errors(truth, found) == pytest.approx((2.0, 0.0))
    # A stack has a place of its own, where it stands.
    elsewhere: list[tuple[float, ...]] = [(-0.15, 0.0), (-0.15, 0.19), (), (0.15,)]
    for along in elsewhere:
        assert on_found_places(truth, on_places((), *along)) is None
