# SPDX-License-Identifier: Apache-2.0
"""Blocks are named by their colours whatever the light, and equal ones are numbered."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from perception_node.light import color_names
from perception_node.names import mean_colors, name_blocks, unique_names
from scene_graph import BASIC_COLORS, COLORS

NAMES = BASIC_COLORS


@given(st.permutations(NAMES), st.integers(4, 7), st.floats(0.55, 1.1), st.integers(0, 1000))
def test_colours_are_named_under_any_light(
    order: list[str], count: int, light: float, seed: int
) -> None:
    chosen = order[:count]
    shade = light * np.random.default_rng(seed).uniform(0.95, 1.05, (count, 1))
    colors = np.clip(np.array([COLORS[name] for name in chosen]) * shade, 0.0, 1.0)
    assert color_names(colors) == tuple(chosen)


@pytest.mark.parametrize("name", NAMES)
def test_a_single_colour_is_named_in_the_usual_light(name: str) -> None:
    assert color_names(np.array([COLORS[name]]) * 0.8) == (name,)


def test_an_orange_block_in_a_dim_scene_is_not_brown() -> None:
    scene = np.array([COLORS["orange"], COLORS["yellow"], COLORS["green"]]) * 0.6
    assert color_names(scene) == ("orange", "yellow", "green")


def test_no_blocks_have_no_names() -> None:
    assert color_names(np.zeros((0, 3))) == ()


def test_a_few_foreign_pixels_do_not_change_a_colour() -> None:
    rgb = np.zeros((20, 20, 3), np.uint8)
    rgb[:] = (200, 20, 20)
    rgb[:3] = (255, 255, 255)
    colors = mean_colors(rgb, [np.ones((20, 20), bool)])
    assert color_names(colors) == ("red",)


def test_exchanged_channels_are_told() -> None:
    colors = [COLORS[name] for name in ("orange", "yellow", "green", "brown")]
    picture = np.repeat(np.array([colors]) * 200, 10, axis=0).repeat(10, axis=1).astype(np.uint8)
    segments: Any = []
    for index in range(len(colors)):
        part = np.zeros(picture.shape[:2], bool)
        part[:, 10 * index : 10 * index + 10] = True
        segments.append(SimpleNamespace(part=part))
    stacks = [[0], [1], [2, 3]]
    assert name_blocks(picture, segments, ["box"] * 4, stacks).doubt == ""
    exchanged = name_blocks(picture[..., ::-1], segments, ["box"] * 4, stacks)
    assert "with red and blue exchanged" in exchanged.doubt
    assert "encoding" in exchanged.doubt


def test_equal_blocks_are_numbered_from_the_left_and_the_bottom() -> None:
    names = unique_names(
        ["red", "blue", "red", "red"], ["box", "box", "box", "sphere"], [[2, 1], [], [3, 0]]
    )
    assert names == ("red_box_2", "blue_box", "red_box", "red_sphere")
