# SPDX-License-Identifier: Apache-2.0
"""Layouts: counted against the formula, refused where they cannot stand."""

from collections import Counter
from math import comb, factorial

import pytest
from numpy.random import default_rng

from scene_graph import BOX, COLORS, object_name
from sim_node.generators import requested_layout
from sim_node.layouts import (
    LayoutError,
    all_layouts,
    format_layout,
    parse_layout,
    random_arrangement,
    random_layout,
)
from sim_node.scene import SceneConfig


@pytest.mark.parametrize("blocks", [1, 2, 3, 4, 5])
def test_all_states_are_enumerated_once(blocks: int) -> None:
    states = list(all_layouts("abcde"[:blocks]))
    assert len(states) == len(set(states)) == factorial(blocks) * comb(blocks + 2, 2)


def test_random_states_are_uniform() -> None:
    rng = default_rng(3)
    counts = Counter(random_arrangement(("a", "b"), rng) for _ in range(12_000))
    assert len(counts) == 12
    # 12,000 draws over 12 states: five standard deviations around 1,000 are 150.
    assert all(abs(count - 1000) < 150 for count in counts.values())


def test_a_seed_gives_the_same_layout_again() -> None:
    assert random_layout(7, 6) == random_layout(7, 6) != random_layout(8, 6)


def test_text_and_layout_say_the_same() -> None:
    layout = random_layout(1, 7)
    assert parse_layout(format_layout(layout), 3) == layout


@pytest.mark.parametrize(
    ("texts", "reason"),
    [
        (["red_box", "red_box", ""], "one place only"),
        (["red_box", ""], "3 stacks"),
        (["", "", ""], "0 blocks"),
        (["red_teapot", "", ""], "red_teapot"),
        (["red_sphere,blue_box", "", ""], "roll off"),
        ([",".join(object_name(color, BOX) for color in list(COLORS)[:8]), "", ""], "8 blocks"),
    ],
)  # fmt: skip
def test_an_impossible_layout_is_refused_with_its_reason(texts: list[str], reason: str) -> None:
    with pytest.raises(LayoutError, match=reason):
        parse_layout(texts, 3)


@pytest.mark.parametrize("blocks", [0, 8, -1])
def test_a_number_of_blocks_that_does_not_fit_is_refused(blocks: int) -> None:
    with pytest.raises(LayoutError):
        random_layout(0, blocks)


@pytest.mark.parametrize("blocks", [0, 1, 2, 8, 65535])
def test_fault_9_a_random_scene_has_3_to_7_blocks_as_promised(blocks: int) -> None:
    with pytest.raises(LayoutError, match=f"{blocks} blocks asked for; a random scene has 3 to 7"):
        requested_layout(SceneConfig(), (), 1, blocks)


@pytest.mark.parametrize("blocks", [3, 7])
def test_a_random_scene_has_as_many_blocks_as_asked_for(blocks: int) -> None:
    assert sum(map(len, requested_layout(SceneConfig(), (), 1, blocks))) == blocks


def test_fault_9_an_explicit_layout_may_have_fewer_blocks_but_not_none() -> None:
    assert requested_layout(SceneConfig(), ["", "red_box", ""], 1, 0) == ((), ("red_box",), ())
    with pytest.raises(LayoutError, match="0 blocks"):
        requested_layout(SceneConfig(), ["", "", ""], 1, 5)
