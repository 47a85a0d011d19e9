# SPDX-License-Identifier: Apache-2.0
"""Facets end where colour, brightness or depth jump, in any light and under noise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from perception_node.alignment import smoothed
from perception_node.noise import color_noise
from perception_node.segment.facets import Facets, Look, find_facets, on_one_facet

RED, BLUE = (180, 30, 30), (30, 50, 170)
NO_DEPTH = np.full((40, 60), np.nan, np.float32)
EVERYWHERE = np.ones((40, 60), bool)


def halves(left: tuple[int, ...], right: tuple[int, ...]) -> NDArray[np.uint8]:
    """A picture of two colours side by side, (40, 60)."""
    rgb = np.zeros((40, 60, 3), np.uint8)
    rgb[:, :30], rgb[:, 30:] = left, right
    return rgb


def facets_of(rgb: NDArray[np.uint8], depth: NDArray[np.float32] = NO_DEPTH) -> Facets:
    noise = color_noise(rgb)
    return find_facets(EVERYWHERE, on_one_facet(Look.of(smoothed(rgb, noise), noise), depth))


def test_two_colours_are_two_facets_that_touch_along_their_border() -> None:
    facets = facets_of(halves(RED, BLUE))
    assert facets.count == 2
    assert facets.borders.tolist() == [[1, 2, 40]]
    assert np.unique(facets.ids[:, :30]).tolist() == [1]
    assert np.unique(facets.ids[:, 30:]).tolist() == [2]


def test_one_colour_lit_differently_is_two_facets_of_one_hue() -> None:
    bright, dim = (180, 40, 30), (126, 28, 21)
    look = Look.of(halves(bright, dim), 0.0)
    assert facets_of(halves(bright, dim)).count == 2
    assert look.chroma[0, 0] == pytest.approx(look.chroma[0, -1], abs=0.03)


def test_shading_that_changes_steadily_is_one_facet() -> None:
    shade = np.linspace(1.0, 0.4, 60)[None, :, None]
    rgb = (shade * np.array(RED) * np.ones((40, 1, 1))).astype(np.uint8)
    assert facets_of(rgb).count == 1


@pytest.mark.parametrize(("jump", "count"), [(0.05, 2), (0.005, 1)])
def test_a_jump_of_depth_ends_a_facet(jump: float, count: int) -> None:
    depth = np.full((40, 60), 1.0, np.float32)
    depth[:, 30:] += jump
    assert facets_of(halves(RED, RED), depth).count == count


def test_pixels_that_are_no_candidates_are_of_no_facet() -> None:
    candidates = EVERYWHERE.copy()
    candidates[:, 25:35] = False
    look = Look.of(halves(RED, RED), 0.0)
    facets = find_facets(candidates, on_one_facet(look, NO_DEPTH))
    assert facets.count == 2 and len(facets.borders) == 0
    assert not facets.ids[:, 25:35].any()


@settings(max_examples=20)
@given(st.floats(0.2, 1.0), st.floats(0.0, 10.0), st.integers(0, 1000))
def test_neither_exposure_nor_noise_makes_facets(light: float, noise: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    exact = light * halves(RED, BLUE)
    rgb = np.clip(exact + rng.normal(0.0, light * noise, exact.shape), 0, 255).astype(np.uint8)
    ids = facets_of(rgb).ids
    left, right = (np.bincount(half.ravel()) for half in (ids[:, :30], ids[:, 30:]))
    assert left.argmax() != right.argmax()
    assert left.max() > 0.95 * left.sum() and right.max() > 0.95 * right.sum()


@settings(max_examples=20)
@given(st.floats(2.0, 20.0), st.integers(0, 1000))
def test_the_noise_of_colours_is_found(noise: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    exact = np.tile(halves((120, 90, 100), (100, 130, 140)), (3, 3, 1))
    rgb = np.clip(np.rint(exact + rng.normal(0.0, noise, exact.shape)), 0, 255).astype(np.uint8)
    # Its steps are those of whole grey levels.
    assert color_noise(rgb) == pytest.approx(noise, rel=0.2, abs=0.7)
    assert color_noise(exact) == 0.0
