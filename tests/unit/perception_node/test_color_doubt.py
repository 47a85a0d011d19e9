# SPDX-License-Identifier: Apache-2.0
"""A colour that fits no name is not given one, and coloured light is not taken for other blocks."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from seen_worlds import TOWERS, camera_of

from perception_node import Observation, Perception, load_weights
from perception_node.names import MAX_DISTANCE, MIN_MARGIN, explain_colors
from scene_graph import BASIC_COLORS, COLORS, GraphStatus, up_relations
from sim_node import ColorConfig, SensorConfig, World, sense

PERCEPTION = Perception(load_weights())


def certain(colors: np.ndarray) -> np.ndarray:
    fit = explain_colors(colors)
    return (fit.distances <= MAX_DISTANCE) & (fit.margins >= MIN_MARGIN)


@given(st.permutations(tuple(COLORS)), st.integers(4, 7), st.floats(0.6, 1.0))
def test_all_colours_are_named_and_certain_in_white_light(
    order: list[str], count: int, light: float
) -> None:
    colors = np.array([COLORS[name] for name in order[:count]]) * light
    assert explain_colors(colors).names == tuple(order[:count])
    assert certain(colors).all()


@given(st.permutations(BASIC_COLORS), st.floats(0.8, 1.15), st.floats(0.75, 1.2))
def test_the_blocks_tell_the_colour_of_the_light(order: list[str], red: float, blue: float) -> None:
    colors = np.array([COLORS[name] for name in order[:6]]) * 0.8 * (red, 1.0, blue)
    assert explain_colors(np.clip(colors, 0.0, 1.0)).names == tuple(order[:6])


def test_a_white_block_among_others_has_no_name() -> None:
    colors = np.array([COLORS["red"], COLORS["blue"], COLORS["yellow"], (1.0, 1.0, 1.0)])
    sure = certain(colors * (0.8, 0.8, 0.8))
    assert sure[:3].all() and not sure[3]


@pytest.mark.parametrize("cast", [(1.15, 1.0, 0.75), (0.8, 1.0, 1.2)])
def test_towers_in_warm_and_cold_light_are_read_rightly(
    world: World, cast: tuple[float, float, float]
) -> None:
    world.reset(TOWERS)
    frame = sense(world.render(), SensorConfig(color=ColorConfig(cast=cast)), (1, 0, 0))
    seen = PERCEPTION.perceive(Observation(frame.rgb, None, frame.depth, camera_of(world)))
    assert seen.status is GraphStatus.CONFIDENT, seen.message
    assert seen.graph.relations == up_relations(TOWERS)


@pytest.mark.parametrize(
    "color", [ColorConfig(cast=(1.4, 1.0, 0.5)), ColorConfig(exposure=2.5)], ids=str
)
def test_in_light_that_tells_no_colours_no_graph_is_accepted(
    world: World, color: ColorConfig
) -> None:
    world.reset(TOWERS)
    frame = sense(world.render(), SensorConfig(color=color), (1, 0, 0))
    seen = PERCEPTION.perceive(Observation(frame.rgb, None, frame.depth, camera_of(world)))
    assert seen.status is not GraphStatus.CONFIDENT
    assert seen.message
