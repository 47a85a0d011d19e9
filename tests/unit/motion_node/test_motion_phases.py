# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from motion_scenes import EDGE, scene

from motion_node.blocks import Block, block_from_object, placed, read_scene
from motion_node.errors import InvalidPlanError
from motion_node.expand import expand, way_home
from motion_node.phases import HOME, PICK, PLACE, Phase
from motion_node.robots import PANDA
from motion_node.settings import PhaseSettings
from scene_graph import Move, Relation, SceneGraph, SceneObject

SQUEEZE = 0.006


def phases_of(
    graph: SceneGraph, moves: list[tuple[int, int]], names: tuple[str, ...] = ()
) -> list[Phase]:
    steps = [Move(*m) for m in moves]
    return expand(read_scene(graph), steps, PANDA.gripper, PhaseSettings(), SQUEEZE, names)


def box(yaw: float = 0.0, size: tuple[float, float, float] = (EDGE,) * 3) -> SceneObject:
    quaternion = (0.0, 0.0, float(np.sin(yaw / 2)), float(np.cos(yaw / 2)))
    return SceneObject("red_box", "red", "box", (0.5, 0.0, size[2] / 2), quaternion, size)


def test_a_move_is_a_pick_and_a_place_and_the_plan_ends_at_home() -> None:
    phases = phases_of(scene((2, 0, 0)), [(0, 2), (0, 1)])
    assert [(p.kind, p.move, p.object_name) for p in phases] == [
        (PICK, 0, "green_box"),
        (PLACE, 0, "green_box"),
        (PICK, 1, "red_box"),
        (PLACE, 1, "red_box"),
        (HOME, 2, ""),
    ]
    assert [bool(p.tool.held) for p in phases] == [False, True, False, True, False]
    for before, after in pairwise(phases):
        assert after.start == before.switch


def test_columns_follow_the_modes() -> None:
    phases = phases_of(scene((2, 1, 0)), [(0, 1), (1, 2)])
    tops = [[round(column.top / EDGE) for column in phase.columns] for phase in phases]
    assert tops == [[2, 1, 0], [1, 1, 0], [1, 2, 0], [1, 1, 0], [1, 1, 1]]


def test_blocks_are_put_on_what_is_there() -> None:
    graph = scene((1, 2, 0))
    place = phases_of(graph, [(0, 1)])[1]
    assert place.switch is not None
    assert place.switch.position_world == pytest.approx((0.5, 0.0, 2.5 * EDGE + 0.002))
    assert place.switch.yaw == 0.0


def test_offsets_do_not_add_up() -> None:
    """Each block goes to the middle of the place, whatever the one below was off by."""
    graph = scene((3, 1, 0), np.random.default_rng(3), offset=0.006)
    places = [p for p in phases_of(graph, [(0, 1), (0, 1), (0, 1)]) if p.kind == PLACE]
    for place in places:
        assert place.switch is not None
        assert place.switch.position_world[:2] == pytest.approx((0.5, 0.0))


def test_a_block_stays_above_its_support() -> None:
    support = Block((0.53, 0.0, EDGE / 2), 0.0, (EDGE,) * 3, "a")
    block = Block((0.5, 0.15, EDGE / 2), 0.0, (EDGE,) * 3, "b")
    after = placed(block, 0.0, (0.5, 0.0, 0.0), support, max_overhang=0.2)
    assert after.position_world == pytest.approx((0.53 - 0.2 * EDGE, 0.0, 1.5 * EDGE))


def test_a_long_block_is_taken_across() -> None:
    block = scene((1, 0, 0))
    long = replace(block, objects=(replace(block.objects[0], size=(0.12, 0.04, 0.05)),))
    pick, place, _ = phases_of(long, [(0, 1)])
    assert pick.switch is not None
    assert abs(pick.switch.yaw) == pytest.approx(np.pi / 2)
    assert pick.grip == pytest.approx(0.02 - SQUEEZE)
    assert place.tool.half_x == pytest.approx(0.06)


def test_a_lying_block_is_taken_by_its_vertical_axis() -> None:
    item = SceneObject(
        "red_box", "red", "box", (0.5, 0.0, 0.02), (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)),
        (0.05, 0.04, 0.06),
    )  # fmt: skip
    block = block_from_object(item)
    assert block.size == (0.05, 0.06, 0.04)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"quaternion_world": (0.35, 0.0, 0.0, 0.94)}, "leans by 4"),
        ({"position_world": (np.nan, 0.0, 0.0)}, "no usable pose"),
        ({"size": (0.0, 0.04, 0.04)}, "no usable pose"),
        ({"quaternion_world": (0.0, 0.0, 0.0, 0.0)}, "no usable pose"),
    ],
)
def test_unusable_blocks_are_refused(change: dict[str, object], sentence: str) -> None:
    graph = scene((1, 0, 0))
    broken = replace(graph, objects=(replace(graph.objects[0], **change),))  # type: ignore[arg-type]
    with pytest.raises(InvalidPlanError, match=sentence) as caught:
        phases_of(broken, [(0, 1)])
    assert caught.value.object_name == "red_box"


@pytest.mark.parametrize(
    ("moves", "names", "index", "sentence"),
    [
        ([(0, 3)], (), 0, "names stack3; there are 3 stacks"),
        ([(0, 1), (2, 2)], (), 1, "ends where it starts"),
        ([(0, 1), (0, 1), (0, 1)], (), 2, "takes from stack0, which is empty"),
        ([(0, 1), (0, 1)], ("green_box", "blue_box"), 1, "but red_box is on top of stack0"),
    ],
)
def test_moves_that_do_not_fit_are_refused(
    moves: list[tuple[int, int]], names: tuple[str, ...], index: int, sentence: str
) -> None:
    with pytest.raises(InvalidPlanError, match=sentence) as caught:
        phases_of(scene((2, 0, 0)), moves, names)
    assert caught.value.move == index


def test_scenes_that_make_no_sense_are_refused() -> None:
    graph = scene((2, 0, 0))
    for broken, sentence in (
        (replace(graph, places=()), "no bases"),
        (replace(graph, objects=graph.objects[:1]), "green_box is missing"),
        (
            replace(graph, relations=graph.relations | {Relation("red_box", "up", "stack1")}),
            "inconsistent",
        ),
        (replace(graph, relations=frozenset()), "stands on nothing"),
        (replace(graph, places=graph.places[1:]), "not numbered from 0"),
    ):
        with pytest.raises(InvalidPlanError, match=sentence):
            phases_of(broken, [(0, 1)])


def test_the_way_home_in_the_middle_knows_what_was_done() -> None:
    phases = phases_of(scene((2, 1, 0)), [(0, 2), (1, 2)])
    tops = [
        [round(column.top / EDGE) for column in way_home(phases, done, PANDA.gripper).columns]
        for done in range(3)
    ]
    assert tops == [[2, 1, 0], [1, 1, 1], [1, 0, 2]]
