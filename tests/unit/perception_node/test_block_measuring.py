# SPDX-License-Identifier: Apache-2.0
"""Blocks are measured to about a millimetre, or say how badly; ray-cast solids are the oracle."""

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perception_scenes import Solid, cast, looking_camera, piled, tower

from perception_node.blocks.measure import measure_blocks
from perception_node.blocks.pose import MeasuredBlock, pose_blocks
from perception_node.errors import BadImageError
from perception_node.noise import depth_noise
from perception_node.segment import Segments
from scene_graph import BOX, CYLINDER, SPHERE

CAMERA = looking_camera()


def measure(
    solids: list[Solid], stacks: list[list[int]], noise: float = 0.0, seed: int = 0
) -> tuple[MeasuredBlock, ...]:
    """With noise of depth of this standard deviation at 1 m [m]."""
    depth, labels = cast(solids, CAMERA)
    if noise:
        errors = np.random.default_rng(seed).normal(0.0, noise, depth.shape)
        depth = depth + errors * depth**2
    segments = Segments.from_labels(labels)
    surfaces = measure_blocks(segments, depth, CAMERA, depth_noise(depth))
    return pose_blocks(surfaces, stacks, [0.0] * len(stacks))


def errors_of(blocks: Sequence[MeasuredBlock], solids: list[Solid]) -> list[float]:
    """Distances between measured and true centres [mm]."""
    return [
        1000.0 * float(np.linalg.norm(np.subtract(block.pose.position_world, solid.centre)))
        for block, solid in zip(blocks, solids, strict=True)
    ]


offsets = st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01))
yaws = st.floats(-0.78, 0.78)
edges = st.floats(0.03, 0.06)
cuboids = st.tuples(edges, edges, edges)


@settings(max_examples=30, derandomize=True)
@given(st.integers(0, 2), st.integers(1, 7), st.floats(-0.7, 0.7), offsets)
def test_cubes_of_one_size_are_measured_to_a_millimetre(
    place: int, height: int, yaw: float, offset: tuple[float, float]
) -> None:
    check_cubes(place, height, yaw, offset)


@pytest.mark.xfail(strict=True, raises=AssertionError, reason="the second of four is 1.27 mm off")
def test_a_tower_straight_from_in_front_is_measured_to_a_millimetre() -> None:
    check_cubes(1, 4, 0.0, (0.00390625, 0.002728962579062854))


def check_cubes(place: int, height: int, yaw: float, offset: tuple[float, float]) -> None:
    solids = tower(place, [BOX] * height, yaw, offset)
    blocks = measure(solids, [list(range(height))])
    # Straight from in front one face is seen, and where it ends between two rows of pixels.
    assert max(errors_of(blocks, solids)) < (1.0 if abs(yaw) > 0.05 else 1.2)
    for block in blocks:
        assert block.shape == BOX
        assert block.pose.yaw == pytest.approx(yaw, abs=0.02)
        assert block.pose.size == pytest.approx((0.045,) * 3, abs=0.001)
        assert block.tilt < 0.05


@settings(max_examples=30)
@given(st.integers(0, 2), st.lists(st.tuples(edges, yaws), min_size=1, max_size=4))
def test_cubes_of_mixed_sizes_are_measured_to_two_millimetres(
    place: int, cubes: list[tuple[float, float]]
) -> None:
    solids = piled(place, [(edge,) * 3 for edge, _ in cubes], [yaw for _, yaw in cubes])
    blocks = measure(solids, [list(range(len(cubes)))])
    assert max(errors_of(blocks, solids)) < 2.0
    # Where edges differ by a pixel or less, cubes may be taken for equal ones.
    sizes = sorted({edge for edge, _ in cubes})
    alike = any(below < above < below + 0.004 for below, above in pairwise(sizes))
    for block, (edge, _) in zip(blocks, cubes):
        assert block.pose.size == pytest.approx((edge,) * 3, abs=0.003 if alike else 0.002)


def test_cubes_that_differ_by_a_pixel_are_not_taken_for_equal_where_their_edges_tell() -> None:
    """As one of 47 and one of 43 mm once were, each off by two standard deviations and more."""
    edges = (0.046875, 0.04296875)
    blocks = measure(piled(1, [(edge,) * 3 for edge in edges], [0.0, 0.0]), [[0, 1]])
    for block, edge in zip(blocks, edges):
        assert block.pose.size == pytest.approx((edge,) * 3, abs=0.001)


@pytest.mark.parametrize("seed", range(6))
def test_noise_of_a_millimetre_and_a_half_costs_little(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solids = [
        box
        for place in range(3)
        for box in piled(
            place,
            [(edge,) * 3 for edge in rng.uniform(0.03, 0.06, 2)],
            rng.uniform(-0.7, 0.7, 2).tolist(),
        )
    ]
    blocks = measure(solids, [[0, 1], [2, 3], [4, 5]], noise=0.0015, seed=seed)
    assert {block.shape for block in blocks} == {BOX}
    assert max(errors_of(blocks, solids)) < 3.0


def is_no_cube(box: tuple[tuple[float, float, float], float]) -> bool:
    """Whether no picture lets it be taken for one."""
    return max(box[0]) - min(box[0]) > 0.01


# The examples are the same in every run: of others some few are as in the test after it.
@settings(max_examples=40, derandomize=True)
@given(
    st.integers(0, 2),
    st.lists(st.tuples(cuboids, yaws).filter(is_no_cube), min_size=1, max_size=3),
)
def test_where_little_deviation_is_stated_cuboids_are_where_they_are_measured(
    place: int, boxes: list[tuple[tuple[float, float, float], float]]
) -> None:
    assert_where_they_are_measured(place, boxes)


def test_so_are_cuboids_seen_straight_from_in_front() -> None:
    boxes = [((depth, 0.03125, 0.03125), 0.0) for depth in (0.046875, 0.04296875)]
    assert_where_they_are_measured(1, boxes)


def assert_where_they_are_measured(
    place: int, boxes: Sequence[tuple[tuple[float, float, float], float]]
) -> None:
    solids = piled(place, [size for size, _ in boxes], [yaw for _, yaw in boxes])
    blocks = measure(solids, [list(range(len(boxes)))])
    for block, solid in zip(blocks, solids):
        off = np.abs(np.subtract(block.pose.position_world, solid.centre))
        deviation = np.array(block.deviation[:3])
        if deviation.max() < 0.004:
            assert (off < 3.0 * deviation + 0.001).all(), (off, deviation)


@pytest.mark.parametrize("depth", [0.03, 0.045, 0.06])
def test_a_box_whose_back_is_not_seen_states_a_large_deviation(depth: float) -> None:
    """Under another block, looked at from in front: nothing says how far it goes back."""
    below, upper = piled(1, [(depth, 0.06, 0.04), (0.05, 0.05, 0.03)], [0.0, 0.0])
    front = 0.5 + 0.5 * depth
    wide = Solid(BOX, (front - 0.03, *upper.centre[1:]), (0.03, 0.035, 0.015))
    block, _ = measure([below, wide], [[0, 1]])
    off = abs(block.pose.position_world[0] - 0.5)
    assert block.deviation[0] > 0.004
    assert off < 3.0 * block.deviation[0]
    assert block.deviation[1] < 0.001


@settings(max_examples=25)
@given(st.integers(0, 2), st.sampled_from([CYLINDER, SPHERE]), offsets)
def test_round_blocks_are_recognised_and_measured(
    place: int, shape: str, offset: tuple[float, float]
) -> None:
    solids = tower(place, [BOX, shape], 0.0, offset)
    blocks = measure(solids, [[0, 1]])
    assert [block.shape for block in blocks] == [BOX, shape]
    assert max(errors_of(blocks, solids)) < 2.0


@settings(max_examples=25)
@given(st.integers(0, 2), st.sampled_from([CYLINDER, SPHERE]), st.floats(0.015, 0.03))
def test_round_blocks_of_any_radius_are_measured(place: int, shape: str, radius: float) -> None:
    x, y, z = tower(place, [BOX])[0].centre
    solid = Solid(shape, (x, y, z - 0.0225 + radius), radius)
    (block,) = measure([solid], [[0]])
    assert block.shape == shape
    assert errors_of([block], [solid])[0] < 2.0
    assert block.pose.size == pytest.approx((2.0 * radius,) * 3, abs=0.003)


def test_blocks_of_different_sizes_are_told_apart() -> None:
    large = Solid(BOX, (0.5, -0.15, 0.03), half=0.03)
    small = Solid(BOX, (0.5, 0.15, 0.02), half=0.02)
    first, second = measure([large, small], [[0], [1]])
    assert first.pose.size == pytest.approx((0.06,) * 3, abs=0.001)
    assert second.pose.size == pytest.approx((0.04,) * 3, abs=0.001)


def test_a_block_in_the_air_is_measured_where_it_is() -> None:
    solids = [*tower(1, [BOX]), Solid(BOX, (0.5, 0.0, 0.145))]
    lower, upper = measure(solids, [[0, 1]])
    assert upper.pose.bottom - lower.pose.top == pytest.approx(0.0775, abs=0.002)


def test_a_few_pixels_without_depth_are_tolerated() -> None:
    solids = tower(1, [BOX, BOX])
    depth, labels = cast(solids, CAMERA)
    lost = np.random.default_rng(1).random(depth.shape) < 0.15
    nothing = np.where(np.arange(depth.size).reshape(depth.shape) % 2, np.nan, 0)
    depth = np.where(lost, nothing, depth)
    surfaces = measure_blocks(Segments.from_labels(labels), depth, CAMERA, depth_noise(depth))
    assert max(errors_of(pose_blocks(surfaces, [[0, 1]], [0.0]), solids)) < 2.0


@pytest.mark.parametrize("gap", [1, 2])
def test_a_block_does_not_end_where_depth_is_lost_before_what_covers_it(gap: int) -> None:
    covered = Solid(BOX, (0.4, 0.02, 0.0225))
    solids = [covered, *(Solid(BOX, (0.6, 0.0, 0.0225 + 0.045 * level)) for level in range(4))]
    depth, labels = cast(solids, CAMERA)
    at = labels == 1
    assert 0.3 < np.count_nonzero(at) / np.count_nonzero(cast([covered], CAMERA)[1]) < 0.8
    others = cv2.dilate(at.view(np.uint8), np.ones((1, 2 * gap + 1))) > 0
    lost = others & (labels > 1)
    depth[lost], labels[lost] = np.nan, 0
    surface = measure_blocks(Segments.from_labels(labels), depth, CAMERA)[0]
    left, right = surface.position[1] + np.array([-0.5, 0.5]) * surface.widths[1]
    doubt = 3.0 * surface.covariance[4, 4] ** 0.5
    assert abs(right - 0.0425) < 0.002
    assert left < -0.0025 + 0.002 + doubt
    assert surface.widths[1] + doubt > 0.045


@pytest.mark.parametrize("value", [np.nan, 0.0, np.inf, -1.0])
def test_a_block_without_depth_is_refused(value: float) -> None:
    depth, labels = cast(tower(1, [BOX]), CAMERA)
    depth[labels == 1] = value
    with pytest.raises(BadImageError, match=r"label 1 .* only 0% of its pixels have depth"):
        measure_blocks(Segments.from_labels(labels), depth, CAMERA)


@settings(max_examples=25)
@given(st.floats(2e-4, 5e-3), st.floats(0.0, 0.2), st.integers(0, 1000))
def test_the_noise_of_a_plane_is_found_to_fifteen_percent(
    noise: float, lost: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    depth, _ = cast([], CAMERA)
    depth = depth + rng.normal(0.0, noise, depth.shape) * depth**2
    depth[rng.random(depth.shape) < lost] = np.nan
    assert depth_noise(depth) == pytest.approx(noise, rel=0.15)


def test_exact_pictures_and_such_without_depth_have_no_noise() -> None:
    assert depth_noise(cast([], CAMERA)[0]) < 1e-6
    assert depth_noise(np.zeros((64, 64))) == 0.0


def shape_and_rival(shape: str, seed: int, noise: float) -> tuple[str, str]:
    """What one block is taken for, and may be as well."""
    rng = np.random.default_rng(seed)
    solids = tower(int(rng.integers(3)), [shape], float(rng.uniform(-0.7, 0.7)))
    (block,) = measure(solids, [[0]], noise, seed)
    return block.shape, block.rival


@pytest.mark.parametrize("shape", [BOX, CYLINDER])
@pytest.mark.parametrize("seed", range(6))
def test_the_depth_of_a_real_camera_tells_boxes_from_cylinders(shape: str, seed: int) -> None:
    assert shape_and_rival(shape, seed, 0.0015) == (shape, "")


def test_noise_that_hides_a_shape_makes_it_doubtful_before_it_makes_it_wrong() -> None:
    found = [shape_and_rival(CYLINDER, seed, 0.0045) for seed in range(60)]
    assert all(CYLINDER in one for one in found)
    assert (CYLINDER, BOX) in found and (CYLINDER, "") in found
