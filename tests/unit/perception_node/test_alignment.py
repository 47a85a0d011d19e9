# SPDX-License-Identifier: Apache-2.0
"""Smeared and displaced edges become steps where the picture has them."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from seen_worlds import TOWERS, camera_of, observe

from perception_node.alignment import aligned, fill, sharpened, smear_of
from perception_node.observation import Observation
from perception_node.segment import Volume
from scene_graph import ROW_OF_THREE
from sim_node.world import World

RED, BLUE = (180, 30, 30), (30, 50, 170)
EVERYWHERE = np.s_[:, :]
NEAR, FAR = 1.0, 1.5


def halves(
    left: tuple[int, ...], right: tuple[int, ...], shape: tuple[int, int] = (40, 60)
) -> NDArray[np.uint8]:
    """A picture of two colours side by side."""
    rgb = np.zeros((*shape, 3), np.uint8)
    rgb[:, : shape[1] // 2], rgb[:, shape[1] // 2 :] = left, right
    return rgb


def blurred(rgb: NDArray[np.uint8], sigma: float) -> NDArray[np.uint8]:
    return np.asarray(cv2.GaussianBlur(rgb, (0, 0), sigma), np.uint8)


def step(shape: tuple[int, int] = (40, 60)) -> NDArray[np.float32]:
    """Depth that is near on the left half and far on the right one [m]."""
    depth = np.full(shape, NEAR, np.float32)
    depth[:, shape[1] // 2 :] = FAR
    return depth


COLORS = st.tuples(*[st.integers(0, 255)] * 3)


@settings(max_examples=40)
@given(COLORS, COLORS, st.floats(0.3, 1.2))
def test_a_blurred_edge_of_two_colours_becomes_a_step_again(
    left: tuple[int, ...], right: tuple[int, ...], blur: float
) -> None:
    exact = halves(left, right)
    smeared = blurred(exact, blur)
    found, mixed = sharpened(smeared, 3, 0.0)
    # Nothing but the two colours is left wherever they differ so much that there is an edge.
    if max(abs(a - b) for a, b in zip(left, right)) > 60:
        assert np.abs(found.astype(int) - exact)[:, [0, 26, 33, -1]].max() < 8
        colours = np.abs(found[:, :, None].astype(int) - [left, right]).max(axis=-1).min(axis=-1)
        assert colours.max() < 8
        assert (mixed > 0.0) == (not np.array_equal(smeared, exact))


@given(COLORS, COLORS)
@settings(max_examples=30)
def test_a_step_stays_a_step(left: tuple[int, ...], right: tuple[int, ...]) -> None:
    exact = halves(left, right)
    found, mixed = sharpened(exact, 2, 0.0)
    assert np.array_equal(found, exact)
    assert mixed == 0.0


def test_a_picture_without_edges_has_none_that_are_mixed() -> None:
    found, mixed = sharpened(halves(RED, RED), 2, 0.0)
    assert np.array_equal(found, halves(RED, RED)) and mixed == 0.0


@pytest.mark.parametrize("moved", [-2, -1, 1, 2])
def test_depth_beside_colour_is_moved_to_it(moved: int) -> None:
    shape = (240, 640)
    rgb, depth = halves(RED, BLUE, shape), np.roll(step(shape), moved, axis=1)
    depth[:, :5], depth[:, -5:] = NEAR, FAR
    seen = aligned(Observation(rgb, None, depth), EVERYWHERE)
    assert seen.depth is not None and seen.sure is not None
    assert np.array_equal(seen.depth, step(shape))
    # What was moved is not as it was measured.
    measured_wrong = depth != step(shape)
    assert not seen.sure[measured_wrong].any() and seen.sure[:, [10, 300, 340, 630]].all()
    assert seen.edge_doubt > 0.0


def test_depth_that_fits_is_left_as_it_is() -> None:
    rgb, depth = halves(RED, BLUE), step()
    depth[10:14, 3:50:7] = np.nan
    seen = aligned(Observation(rgb, None, depth), EVERYWHERE)
    known = ~np.isnan(depth)
    assert seen.depth is not None and seen.sure is not None
    assert np.array_equal(seen.depth[known], depth[known])
    assert np.array_equal(seen.sure, known)
    assert seen.edge_doubt == 0.0


def test_what_is_outside_of_the_part_that_matters_stays() -> None:
    smeared = blurred(halves(RED, BLUE), 1.0)
    depth = np.roll(step(), 1, axis=1)
    seen = aligned(Observation(smeared, None, depth), np.s_[10:30, 20:40])
    assert seen.depth is not None
    outside = np.ones(depth.shape, bool)
    outside[10:30, 20:40] = False
    assert np.array_equal(seen.rgb[outside], smeared[outside])
    assert np.array_equal(seen.depth[outside], depth[outside])
    assert not np.array_equal(seen.rgb, smeared)


def test_without_depth_only_colours_change() -> None:
    smeared = blurred(halves(RED, BLUE), 0.7)
    seen = aligned(Observation(smeared), EVERYWHERE)
    assert seen.depth is None and seen.sure is None
    assert not np.array_equal(seen.rgb, smeared)


def test_an_exact_picture_of_blocks_is_not_taken_for_a_blurred_one(world: World) -> None:
    world.reset(TOWERS)
    observation = observe(world)
    box = Volume.over(np.array(ROW_OF_THREE), 0.36).seen_by(camera_of(world))
    assert box is not None
    exact = aligned(observation, box)
    smeared = blurred(observation.rgb, 1.0)
    soft = aligned(replace(observation, rgb=smeared), box)
    assert exact.edge_doubt == 0.0 < soft.edge_doubt
    # A line of one pixel, as the top of a block at the camera's height, stays what it is.
    assert np.array_equal(exact.rgb, observation.rgb)


def test_smears_grow_with_the_picture() -> None:
    assert [smear_of(width) for width in (64, 256, 320, 640, 1280)] == [1, 1, 1, 2, 5]


def test_pixels_without_depth_get_that_of_the_neighbour_that_looks_like_them() -> None:
    rgb, depth = halves(RED, BLUE), np.full((40, 60), 1.0, np.float32)
    depth[:, 30:] = 2.0
    bare = depth.copy()
    bare[:, 28:32] = np.nan
    assert np.array_equal(fill(bare, rgb, 2), depth)


def test_known_depth_stays_and_what_is_far_from_any_stays_unknown() -> None:
    rgb, depth = halves(RED, RED), np.full((40, 60), 1.0, np.float32)
    depth[10:30, 10:30] = np.nan
    filled = fill(depth, rgb, 2)
    known = ~np.isnan(depth)
    assert np.array_equal(filled[known], depth[known])
    assert np.isnan(filled[13:27, 13:27]).all()
    assert fill(depth, halves(BLUE, RED), 2)[12, 31] == 1.0


def test_a_neighbour_of_another_colour_is_not_asked() -> None:
    rgb, depth = halves(RED, BLUE), np.full((40, 60), 1.0, np.float32)
    depth[:, :30] = np.nan
    assert np.isnan(fill(depth, rgb, 2)[:, :30]).all()
