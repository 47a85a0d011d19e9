# SPDX-License-Identifier: Apache-2.0
"""Markers as obstacles: all they fill is kept clear of; what makes no sense changes nothing."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, Quaternion
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_scenes import scene
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from tamp_runtime.motion_report import MotionReport, ObstaclesHeard
from visualization_msgs.msg import Marker, MarkerArray

from motion_node import surroundings
from motion_node.conversions import obstacles_from_markers
from motion_node.frames import check_frame
from motion_node.obstacles import MOST, Obstacle
from motion_node.surroundings import Heard, Planners, Surroundings

Array = NDArray[np.float64]


def frame_is_the_arms(frame: str) -> None:
    check_frame(frame, "panda_link0", "world", "the obstacles")


def marker(kind: int = Marker.CUBE, **fields: Any) -> Marker:
    """A marker in world that stands in front of the arm."""
    result = Marker(type=kind, ns=fields.pop("ns", "wall"), id=fields.pop("id", 0))
    result.header.frame_id = fields.pop("frame", "world")
    result.action = fields.pop("action", Marker.ADD)
    size = fields.pop("size", (0.1, 0.1, 0.1))
    result.scale.x, result.scale.y, result.scale.z = (float(extent) for extent in size)
    position = result.pose.position
    position.x, position.y, position.z = map(float, fields.pop("at", (0.5, 0.1, 0.05)))
    x, y, z, w = (float(value) for value in fields.pop("turn", (0.0, 0.0, 0.0, 1.0)))
    result.pose.orientation = Quaternion(x=x, y=y, z=z, w=w)
    points = [tuple(map(float, point)) for point in fields.pop("points", ())]
    result.points = [Point(x=a, y=b, z=c) for a, b, c in points]
    assert not fields
    return result


def read(*markers: Marker, known: Mapping[str, tuple[Obstacle, ...]] | None = None) -> Heard:
    message = MarkerArray(markers=list(markers))
    return obstacles_from_markers(message, known or {}, frame_is_the_arms)


def inside(items: Sequence[Obstacle], points: Array) -> NDArray[np.bool_]:
    """Whether points (k, 3) are in any of the obstacles, to a micrometre."""
    found = np.zeros(len(points), dtype=bool)
    for item in items:
        away = points - item.position_world
        cos, sin = np.cos(item.yaw), np.sin(item.yaw)
        own = np.column_stack(
            [away @ (cos, sin, 0.0), away @ (-sin, cos, 0.0), away @ (0.0, 0.0, 1.0)]
        )
        half = np.array(item.size) / 2 + 1e-6
        level = np.abs(own[:, :2]) <= half[:2]
        flat = np.hypot(own[:, 0], own[:, 1]) <= half[0] if item.round else level.all(axis=1)
        found |= flat & (np.abs(own[:, 2]) <= half[2])
    return found


LENGTHS = st.floats(0.01, 0.5)
TURNS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 0.6)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([Marker.CUBE, Marker.CYLINDER]), st.tuples(LENGTHS, LENGTHS, LENGTHS), TURNS)
def test_all_that_a_turned_marker_fills_is_kept_clear_of(
    kind: int, size: tuple[float, float, float], turn: tuple[float, float, float, float]
) -> None:
    turn = tuple(np.array(turn) / np.linalg.norm(turn))
    (items,) = read(marker(kind, size=size, turn=turn)).values()
    sample = np.random.default_rng(0).uniform(-0.5, 0.5, (400, 3))
    if kind == Marker.CYLINDER:
        sample = sample[np.hypot(sample[:, 0], sample[:, 1]) <= 0.5]
    filled = Rotation.from_quat(turn).apply(sample * size) + (0.5, 0.1, 0.05)
    assert inside(items, filled).all()


@settings(max_examples=40, deadline=None)
@given(*[st.tuples(*[st.floats(-0.5, 0.5)] * 3)] * 2, st.floats(0.005, 0.1))
def test_capsules_are_the_lines_of_a_list_with_their_thickness(
    first: tuple[float, float, float], second: tuple[float, float, float], radius: float
) -> None:
    line = marker(Marker.LINE_LIST, size=(2 * radius, 0, 0), at=(0, 0, 0), points=[first, second])
    (items,) = read(line).values()
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    share = rng.uniform(0, 1, (300, 1))
    axis = (1 - share) * np.array(first) + share * np.array(second)
    assert inside(items, axis + radius * directions).all()


def test_an_upright_box_stays_as_it_is() -> None:
    half = np.pi / 12
    ((item,),) = read(
        marker(size=(0.3, 0.02, 0.2), turn=(0, 0, np.sin(half), np.cos(half)))
    ).values()
    assert item.name == "wall"
    assert not item.round
    np.testing.assert_allclose(item.size, (0.3, 0.02, 0.2))
    np.testing.assert_allclose(item.yaw, 2 * half)


def test_a_sphere_and_an_upright_cylinder_are_round() -> None:
    found = read(
        marker(Marker.SPHERE, ns="ball", turn=(1, 0, 0, 0)),
        marker(Marker.CYLINDER, ns="post", size=(0.1, 0.1, 0.3)),
    )
    assert [item.round for own in found.values() for item in own] == [True, True]


def test_markers_come_move_and_go_by_namespace_and_id() -> None:
    known = read(marker(), marker(id=1), marker(ns="lamp"))
    assert list(known) == ["wall", "wall 1", "lamp"]
    moved = read(marker(id=1, at=(0.4, 0.0, 0.05)), known=known)
    assert moved["wall 1"][0].position_world == (0.4, 0.0, 0.05)
    assert list(read(marker(id=1, action=Marker.DELETE), known=known)) == ["wall", "lamp"]
    assert list(read(marker(action=Marker.DELETEALL), known=known)) == ["lamp"]
    assert read(marker(ns="", action=Marker.DELETEALL), known=known) == {}
    anew = read(marker(ns="", action=Marker.DELETEALL), marker(ns="post"), known=known)
    assert list(anew) == ["post"]


@pytest.mark.parametrize(
    ("bad", "words", "verdict"),
    [
        (marker(frame="camera"), "frame 'camera'", ObstaclesHeard.UNKNOWN_FRAME),
        (marker(size=(np.nan, 0.1, 0.1)), "size", ObstaclesHeard.INVALID),
        (marker(size=(0.1, -0.1, 0.1)), "size", ObstaclesHeard.INVALID),
        (marker(at=(np.inf, 0.0, 0.0)), "position", ObstaclesHeard.INVALID),
        (marker(at=(9.0, 0.0, 0.0)), "position", ObstaclesHeard.INVALID),
        (marker(turn=(0, 0, 0, 0)), "orientation", ObstaclesHeard.INVALID),
        (marker(turn=(np.nan, 0, 0, 1)), "orientation", ObstaclesHeard.INVALID),
        (marker(Marker.TEXT_VIEW_FACING), "type = 9", ObstaclesHeard.INVALID),
        (marker(Marker.SPHERE, size=(0.1, 0.2, 0.1)), "a sphere is", ObstaclesHeard.INVALID),
        (marker(Marker.LINE_LIST), "points", ObstaclesHeard.INVALID),
        (marker(Marker.LINE_LIST, points=[(0, 0, 0)]), "points", ObstaclesHeard.INVALID),
        (marker(action=7), "action = 7", ObstaclesHeard.INVALID),
    ],
)
def test_what_makes_no_sense_is_refused_with_a_sentence_and_changes_nothing(
    bad: Marker, words: str, verdict: ObstaclesHeard
) -> None:
    around = Surroundings([Obstacle("file", (0.1, 0.1, 0.1), (0.5, 0.5, 0.05))])
    assert around.hear(lambda known: read(marker(), known=known))
    before = around.all
    assert not around.hear(lambda known: read(marker(ns="new"), bad, known=known))
    assert around.all is before
    told = around.told_in(MotionReport())
    assert (told.obstacles, told.obstacles_heard) == (2, verdict)
    assert words in told.obstacles_problem
    assert around.hear(lambda known: read(marker(ns="new"), known=known))
    told = around.told_in(MotionReport())
    assert (told.obstacles, told.obstacles_heard) == (3, ObstaclesHeard.TAKEN)
    assert told.obstacles_problem == ""


def test_more_than_are_kept_clear_of_are_refused() -> None:
    around = Surroundings([])
    many = [marker(id=index) for index in range(MOST + 1)]
    assert not around.hear(lambda known: read(*many, known=known))
    assert around.told_in(MotionReport()).obstacles_heard is ObstaclesHeard.TOO_MANY


def test_an_obstacle_of_the_file_is_not_replaced_by_a_message() -> None:
    around = Surroundings([Obstacle("wall", (0.1, 0.1, 0.1), (0.5, 0.5, 0.05))])
    assert not around.hear(lambda known: read(marker(), known=known))
    assert "wall" in around.problem


def test_the_same_again_is_no_news() -> None:
    around = Surroundings([])
    around.hear(lambda known: read(marker(), known=known))
    before = around.all
    around.hear(lambda known: read(marker(), known=known))
    assert around.all is before


@pytest.mark.parametrize("barred", [False, True])
def test_a_motion_under_way_is_looked_at_and_stopped_before_a_planner_is_built(
    monkeypatch: pytest.MonkeyPatch, barred: bool
) -> None:
    """Building holds up the thread that follows the arm, which meanwhile goes on."""
    order, asked, rests = list[str](), threading.Event(), threading.Event()

    def looks(*_around: Any, **_since: Any) -> Any:
        order.append("looked")
        contacts = [SimpleNamespace(other="wall", body="hand")] if barred else []
        return SimpleNamespace(contacts=contacts)

    def make(_obstacles: Sequence[Obstacle]) -> Any:
        order.append("made")
        return SimpleNamespace(model=None, obstacles=())

    def moves() -> bool:
        asked.set()
        return not rests.is_set()

    monkeypatch.setattr(surroundings, "dense_check", looks)
    monkeypatch.setattr(surroundings, "LOOKS", 60.0)
    around = Surroundings(())
    planners = Planners(around)
    planners.describe(make)
    planners.now()
    wall = Obstacle("wall", (0.1, 0.1, 0.1), (0.5, 0.1, 0.05))
    assert around.hear(lambda _known: {"wall": (wall,)})
    building = threading.Thread(target=planners.build, args=(moves,))
    building.start()
    assert asked.wait(60.0)
    motion: Any = SimpleNamespace(trajectory=None, floor=0.0)
    found = planners.in_the_way(motion, scene((1, 0, 0)), 0.0)
    assert found == ("obstacle wall is in the way of the hand" if barred else "")
    if barred:
        asked.clear()
        assert asked.wait(60.0)  # it goes on waiting
        order.append("rests")
        rests.set()
    building.join(60.0)
    assert order == ["made", "looked", *(["rests"] if barred else []), "made"]
