# SPDX-License-Identifier: Apache-2.0
"""Bad requests get one sentence that says what is wrong, and change nothing."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from disturbed_world import DisturbedWorld

from scene_graph import Stacks
from sim_node import World
from sim_node.disturbance.kinds import KINDS
from sim_node.disturbance.request import DisturbanceError

SPHERE_THERE: Stacks = (("red_box",), ("yellow_sphere",), ("green_box", "blue_box"))

#: What is asked for, and what the sentence says.
BAD: list[tuple[tuple[str, ...], dict[str, Any], str]] = [
    (("explode",), {}, "kind is 'explode'; there are push, swap"),
    (("",), {}, "kind is ''"),
    (("push", "teapot"), {}, "no block 'teapot'; there are blue_box, green_box"),
    (("push",), {}, "no block is in the hand"),
    (("push", "red_box", "blue_box"), {}, "push takes 0 or 1 blocks, not 2"),
    (("push", "red_box"), {"force": -1.0}, "force is -1 N; 0 to 1000"),
    (("push", "red_box"), {"force": 1e6}, "force is 1e.06 N; 0 to 1000"),
    (("push", "red_box"), {"force": nan}, "force is nan N"),
    (("push", "red_box"), {"direction": (nan, 0.0, 1.0)}, "direction .* is not finite"),
    (("push", "red_box"), {"direction": (0.0, inf, 0.0)}, "direction .* is not finite"),
    (("push", "red_box"), {"seconds": -0.1}, "seconds is -0.1 s"),
    (("push", "red_box"), {"seconds": 1e4}, "seconds is 10000 s; 0 to 60"),
    (("push", "red_box"), {"delay": -1.0}, "delay is -1 s"),
    (("push", "red_box"), {"acceleration": 3.0}, "acceleration means nothing to push"),
    (("push", "red_box"), {"when": "tomorrow"}, "when is 'tomorrow'; there are now, at, grasp"),
    (("push", "red_box"), {"when": "at"}, "a stamp is given with when 'at'"),
    (("push", "red_box"), {"when": "at", "step": 3}, "the time asked for was .* s ago"),
    (("push", "red_box"), {"step": 10**6}, "a stamp is given with when 'at', and only"),
    (("push", "red_box"), {"count": 2}, "count and of belong to an event"),
    (("push", "red_box"), {"when": "grasp", "count": 10**6}, "count is 1000000"),
    (("push", "red_box"), {"when": "grasp", "of": "teapot"}, "no block 'teapot'"),
    (("push", "red_box"), {"when": "grasp", "height": 0.1}, "height belongs to in_air"),
    (("push", "red_box"), {"when": "in_air", "height": 3.0}, "height is 3 m; 0 to 0.5"),
    (("slip",), {}, "no block is in the hand"),
    (("slip",), {"when": "release"}, "nothing can slip at a release"),
    (("slip", "red_box"), {"when": "grasp"}, "blocks means nothing to slip"),
    (("jam",), {"force": 2.0}, "force means nothing to jam"),
    (("shove",), {"direction": (0.0, 0.0, 1.0)}, "leaves the table's plane"),
    (("shove",), {"acceleration": 1e3}, "acceleration is 1000 m/s²; 0 to 100"),
    (("cover",), {"what": "elephant"}, "what is 'elephant'; there are hand and sheet"),
    (("swap", "red_box"), {}, "swap takes 2 blocks, not 1"),
    (("swap", "red_box", "red_box"), {}, "swap takes 2 different blocks"),
    (("swap", "red_box", "teapot"), {}, "no block 'teapot'"),
    (("swap", "green_box", "yellow_sphere"), {}, "blue_box cannot stand on yellow_sphere"),
    (("take_away",), {}, "no block is in the hand"),
    (("take_away", "teapot"), {}, "no block 'teapot'"),
    (("calm",), {"delay": 1.0}, "calm is for now"),
    (("calm",), {"seconds": 1.0}, "seconds means nothing to calm"),
    (("add", "red_box"), {"on": "blue_box"}, "there is a red_box already"),
    (("add", "golden_box"), {"on": "blue_box"}, "golden_box.* is not COLOR_SHAPE"),
    (("add", "teapot"), {"on": "blue_box"}, "teapot.* is not COLOR_SHAPE"),
    (("add", "pink_box"), {}, "say on what"),
    (("add", "pink_box"), {"on": "teapot"}, "no block 'teapot'"),
    (("add", "pink_box"), {"on": "stack7"}, "no place stack7; there are stack0 to stack2"),
    (("add", "pink_box"), {"on": "stack0"}, "cannot stand there: red_box is there"),
    (("add", "pink_box"), {"on": "green_box"}, "cannot stand there: blue_box is there"),
    (("add", "pink_box"), {"on": "yellow_sphere"}, "would come off"),
    (("add", "pink_box"), {"position": (0.5, 0.1, 0.2)}, "would be in the air"),
    (("add", "pink_box"), {"position": (3.0, 0.0, 0.0)}, "would be in the air"),
    (("add", "pink_box"), {"position": (0.5, -0.13, 0.0)}, "cannot stand there: red_box"),
    (("add", "pink_box"), {"position": (0.6, 0.1, -0.03)}, "cannot stand there: the table"),
    (("add", "pink_box"), {"position": (0.02, 0.0, 0.0)}, "cannot stand there: the arm"),
    (("add", "pink_box"), {"position": (nan, 0.0, 0.0)}, "position .* is not finite"),
    (("add", "pink_box"), {"on": "stack0", "position": (0.3, 0.0, 0.0)}, "not both"),
]  # fmt: skip


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


@pytest.mark.parametrize(("names", "amounts", "sentence"), BAD)
def test_a_bad_request_is_refused_in_one_sentence(
    world: World, names: tuple[str, ...], amounts: dict[str, Any], sentence: str
) -> None:
    scene = DisturbedWorld(world, SPHERE_THERE)
    with pytest.raises(DisturbanceError, match=sentence) as refusal:
        scene.disturb(*names, **amounts)
    text = str(refusal.value)
    assert "\n" not in text and not text.endswith(".")
    assert scene.told == []
    assert (scene.disturber.pending, scene.disturber.active) == (0, 0)


def test_all_those_refusals_leave_the_world_as_it_was_bit_by_bit(world: World) -> None:
    def after(refusals: bool) -> np.ndarray:
        scene = DisturbedWorld(world, SPHERE_THERE)
        for names, amounts, _ in BAD if refusals else []:
            with pytest.raises(DisturbanceError):
                scene.disturb(*names, **amounts)
        scene.disturb("shove", acceleration=15.0)
        scene.run(1.0)
        return scene.state()

    np.testing.assert_array_equal(after(True), after(False))


def test_a_block_more_than_the_table_takes_is_refused(world: World) -> None:
    towers: Stacks = (("red_box", "green_box", "blue_box"), ("yellow_box", "purple_box"),
                      ("orange_box", "cyan_box"))  # fmt: skip
    scene = DisturbedWorld(world, towers)
    with pytest.raises(DisturbanceError, match="7 blocks already"):
        scene.disturb("add", "pink_box", on="cyan_box")


def test_what_cannot_happen_any_more_at_its_moment_is_told_and_passed_over(world: World) -> None:
    scene = DisturbedWorld(world)
    scene.disturb("push", "blue_box", delay=0.2)
    scene.disturb("slip", delay=0.2)
    scene.disturb("add", "pink_box", on="blue_box", delay=0.2)
    scene.disturb("take_away", "blue_box", delay=0.1)
    scene.run(0.5)
    ended = [text for text in scene.told if "cannot happen" in text]
    assert ended == [
        "disturbance 1 cannot happen: there is no block 'blue_box'; there are green_box, red_box",
        "disturbance 2 cannot happen: no block is in the hand",
        "disturbance 3 cannot happen: there is no block 'blue_box'; there are green_box, red_box",
    ]


def test_too_many_at_once_are_refused(world: World) -> None:
    scene = DisturbedWorld(world)
    for _ in range(100):
        scene.disturb("jam", delay=9.0)
    with pytest.raises(DisturbanceError, match="100 disturbances are pending or under way"):
        scene.disturb("jam", delay=9.0)


@pytest.mark.parametrize(
    ("kind", "amounts", "sentence"),
    [
        ("jam", {}, "the gripper jams: the fingers follow no command for 3 s, now"),
        ("jam", {"delay": 2.0}, "for 3 s, in 2 s"),
        ("jam", {"when": "grasp"}, "for 3 s, at the next grasp"),
        ("slip", {"when": "in_air", "count": 2, "of": "red_box"},
         "for 0.5 s, at the 2nd lift of red_box to more than 0.015 m"),
        ("jam", {"when": "release", "count": 3, "delay": 0.5}, "0.5 s after the 3rd release"),
    ],
)  # fmt: skip
def test_the_answer_says_what_happens_and_when(
    world: World, kind: str, amounts: dict[str, Any], sentence: str
) -> None:
    assert DisturbedWorld(world).promise(kind, **amounts).endswith(sentence)


def test_every_kind_explains_itself() -> None:
    assert len(KINDS) == 9
    for kind in KINDS.values():
        assert kind.__doc__
