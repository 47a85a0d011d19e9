# SPDX-License-Identifier: Apache-2.0
"""Named generators draw what they promise, in every scene, and the same for the same seed."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.random import default_rng

from scene_graph import BOX, FLAT_TOPPED, split_object_name
from sim_node.generators import GENERATORS, generate_layout, uniform
from sim_node.layouts import LayoutError, check_layout, random_layout
from sim_node.scene import SceneConfig, load_scene, parse_scene

SHAPES = load_scene("shapes")
ROWS = load_scene("two_rows")


@pytest.mark.parametrize("generator", ["", "uniform"])
def test_in_the_usual_scene_uniform_is_what_it_always_was(generator: str) -> None:
    for seed in range(40):
        for blocks in range(3, 8):
            layout = generate_layout(SceneConfig(), generator, seed, blocks)
            assert layout == random_layout(seed, blocks)


def test_the_seeds_of_published_results_give_the_layouts_that_they_gave() -> None:
    assert random_layout(7, 6) == (
        ("green_box", "pink_box", "cyan_box"), ("yellow_box", "red_box", "brown_box"), (),
    )  # fmt: skip


@given(st.integers(0, 2**32 - 1), st.integers(3, 14), st.sampled_from(sorted(GENERATORS)))
def test_whatever_is_drawn_can_be_built(seed: int, blocks: int, generator: str) -> None:
    try:
        layout = generate_layout(SHAPES, generator, seed, blocks)
    except LayoutError as error:
        assert "0.5 m" in str(error) or generator == "flat"
        return
    check_layout(layout, 3, SHAPES.blocks, seed)
    assert sum(map(len, layout)) == blocks
    assert layout == generate_layout(SHAPES, generator, seed, blocks)


@pytest.mark.parametrize("seed", range(10))
def test_a_tower_is_one_flat_has_none_and_a_row_is_even(seed: int) -> None:
    assert sorted(map(len, generate_layout(SHAPES, "tower", seed, 6))) == [0, 0, 6]
    assert max(map(len, generate_layout(ROWS, "flat", seed, 4))) == 1
    assert [len(stack) for stack in generate_layout(SHAPES, "row", seed, 8)] == [3, 3, 2]


def test_towers_and_flat_blocks_are_anywhere() -> None:
    towers = Counter(
        [bool(stack) for stack in generate_layout(ROWS, "tower", seed, 3)].index(True)
        for seed in range(120)
    )
    assert set(towers) == set(range(6))
    taken = Counter(
        place
        for seed in range(120)
        for place, stack in enumerate(generate_layout(ROWS, "flat", seed, 3))
        if stack
    )
    assert set(taken) == set(range(6))


def test_varied_blocks_have_all_shapes_and_share_colours() -> None:
    layouts = [generate_layout(SHAPES, "varied", seed, 10) for seed in range(40)]
    names = [[name for stack in layout for name in stack] for layout in layouts]
    shapes = Counter(split_object_name(name)[1] for item in names for name in item)
    assert set(shapes) == {"box", "cylinder", "sphere", "prism"}
    colors = [[split_object_name(name)[0] for name in item] for item in names]
    assert any(len(set(item)) < 10 for item in colors)
    uniform_names = [
        name for seed in range(40) for stack in generate_layout(SHAPES, "", seed, 10)
        for name in stack
    ]  # fmt: skip
    assert {split_object_name(name)[1] for name in uniform_names} == set(shapes)


def test_states_with_spheres_are_uniform_too() -> None:
    """Of two boxes and a sphere on two places: 6 states of the boxes, times 2 for the sphere."""
    rng = default_rng(1)
    names = ("red_box", "blue_sphere", "green_box")
    counts = Counter(uniform(names, rng, 2) for _ in range(12_000))
    assert len(counts) == 12
    # 12,000 draws over 12 states: five standard deviations around 1,000 are 150.
    assert all(abs(count - 1000) < 150 for count in counts.values())
    for layout in counts:
        assert all(split_object_name(name)[1] in FLAT_TOPPED for s in layout for name in s[:-1])


@pytest.mark.parametrize(
    ("scene", "generator", "blocks", "reason"),
    [
        (SceneConfig(), "pyramid", 5, "no generator 'pyramid'; known: uniform, varied, tower"),
        (SceneConfig(), "flat", 5, "5 blocks cannot all be on the table: it has 3 places"),
        (SceneConfig(), "tower", 8, "8 blocks asked for; a random scene has 3 to 7"),
        (SHAPES, "", 15, "3 to 14"),
        (SHAPES, "", 2, "3 to 14"),
        (SHAPES, "tower", 14, "m high; the arm stacks up to 0.5 m"),
        (parse_scene("blocks: {shapes: [sphere]}"), "", 5, "only 3 blocks for such a layout"),
        (parse_scene("blocks: {shapes: [prism]}"), "varied", 5, "only 3 blocks for such a layout"),
        (parse_scene("blocks: {most: 2}"), "", 5, "a random scene has 2 to 2"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_its_reason(
    scene: SceneConfig, generator: str, blocks: int, reason: str
) -> None:
    with pytest.raises(LayoutError, match=reason):
        generate_layout(scene, generator, 1, blocks)


def test_more_blocks_than_colours_share_them() -> None:
    scene = parse_scene("blocks: {shapes: [box, cylinder], colors: [red, blue, green], most: 6}")
    names = [name for stack in generate_layout(scene, "", 5, 6) for name in stack]
    assert len(set(names)) == 6
    first = [name for stack in generate_layout(scene, "", 5, 3) for name in stack]
    assert len({split_object_name(name)[0] for name in first}) == 3
    assert BOX in {split_object_name(name)[1] for name in names}
