# SPDX-License-Identifier: Apache-2.0
"""Two cameras make one graph: what one does not see the other does, and lies are found out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from seen_worlds import PERCEPTION, put

from perception_node import Observation, PerceptionConfig, PinholeCamera
from perception_node.joined_views import JoinedViews
from perception_node.next_view import next_view
from scene_graph import GraphStatus, Stacks
from sim_node import World, parse_scene, true_scene_graph

PLACES = tuple((x, y, 0.0) for x in (0.58, 0.42) for y in (-0.15, 0.0, 0.15))
SCENE = f"""
places: [{", ".join(f"[{x}, {y}]" for x, y, _ in PLACES)}]
cameras:
  - {{position: [1.45, 0.0, 0.4], target: [0.5, 0.0, 0.08]}}
  - {{name: side, position: [0.8, -1.05, 0.75], target: [0.5, 0.0, 0.1], vertical_fov: 0.6}}
"""
TOWER = ("red_box", "blue_box", "green_box")
HIDING: Stacks = ((), TOWER, (), (), ("yellow_box",), ())


@pytest.fixture(scope="module")
def built() -> Iterator[World]:
    with World(parse_scene(SCENE)) as world:
        yield world


@pytest.fixture
def rows(built: World) -> World:
    side = parse_scene(SCENE).cameras[1]
    built.move_camera(1, side.position_world, side.target_world)
    return built


def joined() -> JoinedViews:
    return JoinedViews(
        PERCEPTION.configured(PerceptionConfig(stack_positions=PLACES)), first="camera"
    )


def views(world: World) -> dict[str, Observation]:
    found = {}
    for number, item in enumerate(world.config.cameras):
        frame = world.render(number)
        camera = PinholeCamera(item.intrinsics, item.world_from_optical, item.width, item.height)
        found[item.name] = Observation(frame.rgb, None, frame.depth, camera)
    return found


def moved(observation: Observation, by: float) -> Observation:
    """The same picture, its camera said to be further along x [m]."""
    assert observation.camera is not None
    pose = observation.camera.world_from_optical.copy()
    pose[0, 3] += by
    return replace(observation, camera=replace(observation.camera, world_from_optical=pose))


def test_what_is_hidden_from_one_camera_the_other_sees(rows: World) -> None:
    rows.reset(HIDING)
    truth, seen = true_scene_graph(rows), views(rows)
    alone = joined().perceive({"camera": seen["camera"]})
    assert alone.status is GraphStatus.HIDDEN
    assert "hidden_stack4" in alone.graph.names
    both = joined().perceive(seen)
    assert both.status is GraphStatus.CONFIDENT, both.message
    assert both.graph.relations == truth.relations
    for item in truth.objects:
        off = np.subtract(both.graph.object(item.name).position_world, item.position_world)
        assert np.linalg.norm(off) < 0.002
    # What is in front is so for the first camera, whichever picture comes first.
    assert [place.row for place in both.graph.places] == [0, 0, 0, 1, 1, 1]


def test_the_order_of_the_cameras_changes_nothing(rows: World) -> None:
    rows.reset(HIDING)
    seen = views(rows)
    one, other = (
        joined().perceive({name: seen[name] for name in names}) for names in permutations(seen)
    )
    assert one.graph.relations == other.graph.relations
    for name in one.graph.names:
        np.testing.assert_allclose(
            one.graph.object(name).position_world, other.graph.object(name).position_world,
            atol=1e-6,
        )  # fmt: skip


@pytest.mark.parametrize("by", [0.007, 0.06])
def test_a_camera_that_is_not_where_it_is_said_to_be_is_named(rows: World, by: float) -> None:
    rows.reset(HIDING)
    seen = views(rows)
    wrong = joined().perceive({"camera": seen["camera"], "side": moved(seen["side"], by)})
    assert wrong.status is not GraphStatus.CONFIDENT
    assert "side/extrinsics" in wrong.message and "_box" in wrong.message


def test_a_block_that_one_camera_sees_and_another_sees_through_is_refused(rows: World) -> None:
    rows.reset(HIDING)
    before = views(rows)
    put(rows, "yellow_box", (0.0, 0.0, 2.0))
    after = views(rows)
    both = joined().perceive({"camera": after["camera"], "side": before["side"]})
    assert both.status is not GraphStatus.CONFIDENT or "yellow_box" in both.graph.names
    rows.reset(((), TOWER, (), ("yellow_box",), (), ()))
    before = views(rows)
    put(rows, "yellow_box", (0.0, 0.0, 2.0))
    both = joined().perceive({"camera": views(rows)["camera"], "side": before["side"]})
    assert both.status is GraphStatus.LOW_CONFIDENCE
    assert both.message.startswith("camera sees nothing where yellow_box stands for side; check ")


def test_a_colour_that_differs_is_refused_with_both_names(rows: World) -> None:
    rows.reset(HIDING)
    seen = views(rows)
    side = seen["side"].rgb.copy()
    red = (side[..., 0] > 90) & (side[..., 1] < 60) & (side[..., 2] < 60)
    side[red] = (25, 64, 217)
    both = joined().perceive({"camera": seen["camera"], "side": replace(seen["side"], rgb=side)})
    assert both.status is not GraphStatus.CONFIDENT
    assert "red_box" in both.message and "side" in both.message


def test_a_picture_that_cannot_be_used_is_told_and_done_without(rows: World) -> None:
    rows.reset(((), ("red_box",), (), (), (), ("yellow_box",)))
    truth, seen = true_scene_graph(rows), views(rows)
    black = replace(seen["side"], rgb=np.zeros_like(seen["side"].rgb))
    both = joined().perceive({"camera": seen["camera"], "side": black})
    assert both.graph.relations == truth.relations
    assert "side: the picture is black" in both.message
    views_ = {name: replace(item, rgb=np.zeros_like(item.rgb)) for name, item in seen.items()}
    assert joined().perceive(views_).status is GraphStatus.BAD_IMAGE


def test_the_view_that_is_asked_for_settles_what_is_hidden(rows: World) -> None:
    rows.reset(HIDING)
    rows.move_camera(1, (1.44, 0.03, 0.4), (0.5, 0.0, 0.1))
    seen = views(rows)
    before = joined().perceive(seen)
    assert before.status is GraphStatus.HIDDEN
    camera = seen["side"].camera
    assert camera is not None
    asked = next_view(before.graph, camera, PerceptionConfig(stack_positions=PLACES))
    assert asked is not None
    position, forward = asked.position_world, asked.world_from_optical[:3, 2]
    rows.move_camera(1, tuple(position), tuple(position + forward))
    after = joined().perceive(views(rows))
    assert after.status is GraphStatus.CONFIDENT, after.message
    assert after.graph.relations == true_scene_graph(rows).relations
    assert next_view(after.graph, asked, PerceptionConfig(stack_positions=PLACES)) is None
