# SPDX-License-Identifier: Apache-2.0
"""Blocks are measured to about a millimetre; ray-cast solids are the oracle."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perception_scenes import Solid, cast, looking_camera, tower

from perception_node.blocks.measure import measure_block
from perception_node.blocks.pose import MeasuredBlock, pose_blocks
from perception_node.errors import BadImageError
from scene_graph import BOX, CYLINDER, SPHERE

CAMERA = looking_camera()


def measure(
    solids: list[Solid], stacks: list[list[int]], noise: float = 0.0
) -> tuple[MeasuredBlock, ...]:
    depth, labels = cast(solids, CAMERA)
    if noise:
        depth = depth + np.random.default_rng(0).normal(0.0, noise, depth.shape)
    surfaces = [measure_block(labels == i + 1, depth, CAMERA) for i in range(len(solids))]
    return pose_blocks(surfaces, stacks, [0.0] * len(stacks))


def worst_error(blocks: Sequence[MeasuredBlock], solids: list[Solid]) -> float:
    """Largest distance between measured and true centres [mm]."""
    return 1000.0 * max(
        float(np.linalg.norm(np.subtract(block.pose.position_world, solid.centre)))
        for block, solid in zip(blocks, solids)
    )


offsets = st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01))


@settings(max_examples=40)
@given(st.integers(0, 2), st.integers(1, 7), st.floats(-0.7, 0.7), offsets)
def test_a_tower_of_boxes_is_measured_to_two_millimetres(
    place: int, height: int, yaw: float, offset: tuple[float, float]
) -> None:
    solids = tower(place, [BOX] * height, yaw, offset)
    blocks = measure(solids, [list(range(height))])
    assert worst_error(blocks, solids) < 2.0
    for block in blocks:
        assert block.shape == BOX
        assert block.pose.yaw == pytest.approx(yaw, abs=0.02)
        assert block.pose.size == pytest.approx((0.045,) * 3, abs=0.0025)
        assert block.tilt < 0.05


def test_most_boxes_are_measured_to_half_a_millimetre() -> None:
    errors = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        solids = [
            solid
            for place in range(3)
            for solid in tower(
                place, [BOX] * 2, float(rng.uniform(-0.05, 0.05)), tuple(rng.normal(0, 0.001, 2))
            )
        ]
        errors.append(worst_error(measure(solids, [[0, 1], [2, 3], [4, 5]]), solids))
    assert np.median(errors) < 1.0


@settings(max_examples=25)
@given(st.integers(0, 2), st.sampled_from([CYLINDER, SPHERE]), offsets)
def test_round_blocks_are_recognised_and_measured(
    place: int, shape: str, offset: tuple[float, float]
) -> None:
    solids = tower(place, [BOX, shape], 0.0, offset)
    blocks = measure(solids, [[0, 1]])
    assert [block.shape for block in blocks] == [BOX, shape]
    assert worst_error(blocks, solids) < 3.0


def test_noisy_depth_costs_little() -> None:
    solids = tower(0, [BOX] * 3, 0.1) + tower(2, [BOX] * 2, -0.2)
    blocks = measure(solids, [[0, 1, 2], [3, 4]], noise=0.001)
    assert {block.shape for block in blocks} == {BOX}
    assert worst_error(blocks, solids) < 2.5


def test_blocks_of_different_sizes_are_told_apart() -> None:
    large = Solid(BOX, (0.5, -0.15, 0.03), half=0.03)
    small = Solid(BOX, (0.5, 0.15, 0.02), half=0.02)
    first, second = measure([large, small], [[0], [1]])
    assert first.pose.size == pytest.approx((0.06,) * 3, abs=0.0025)
    assert second.pose.size == pytest.approx((0.04,) * 3, abs=0.0025)


def test_a_block_in_the_air_is_measured_where_it_is() -> None:
    solids = [*tower(1, [BOX]), Solid(BOX, (0.5, 0.0, 0.145))]
    lower, upper = measure(solids, [[0, 1]])
    assert upper.pose.bottom - lower.pose.top == pytest.approx(0.0775, abs=0.004)


def test_a_few_pixels_without_depth_are_tolerated() -> None:
    solids = tower(1, [BOX, BOX])
    depth, labels = cast(solids, CAMERA)
    lost = np.random.default_rng(1).random(depth.shape) < 0.15
    depth = np.where(
        lost, np.where(np.arange(depth.size).reshape(depth.shape) % 2, np.nan, 0), depth
    )
    surfaces = [measure_block(labels == i + 1, depth, CAMERA) for i in range(2)]
    assert worst_error(pose_blocks(surfaces, [[0, 1]], [0.0]), solids) < 2.5


@pytest.mark.parametrize("value", [np.nan, 0.0, np.inf, -1.0])
def test_a_block_without_depth_is_refused(value: float) -> None:
    depth, labels = cast(tower(1, [BOX]), CAMERA)
    depth[labels == 1] = value
    with pytest.raises(BadImageError, match="0% of its pixels have depth"):
        measure_block(labels == 1, depth, CAMERA)
