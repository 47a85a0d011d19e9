# SPDX-License-Identifier: Apache-2.0
"""Blocks found in colour alone: pixels put together, what is behind them, what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from perception_scenes import PLACES, looking_camera

from perception_node import Observation, Perception, PerceptionConfig, Volume
from perception_node.errors import BadImageError, WeightsError
from perception_node.segment import rgb as segmenting
from perception_node.segment.background import stands_behind
from perception_node.segment.front_view import FrontView
from perception_node.segment.mask_network import DEFAULT_WEIGHTS, load_weights
from perception_node.segment.rgb import find_in_rgb, instances
from perception_node.visual_module.mask_centroid import MaskCentroid
from scene_graph import GraphStatus, Stacks
from sim_node.world import World

VOLUME = Volume.over(np.array(PLACES), 0.36)
SEEN: Stacks = (("red_box", "green_box", "blue_box"), (), ("yellow_box", "purple_box", "cyan_box"))


def rectangles(shape: tuple[int, int], *boxes: tuple[int, int, int, int]) -> tuple:
    """How sure pixels are, and their middles, of blocks (top, left, height, width)."""
    surety, middles = np.full(shape, -1.0, np.float32), np.zeros((2, *shape), np.float32)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    for top, left, height, width in boxes:
        box = np.s_[top : top + height, left : left + width]
        surety[box] = 1.0
        middles[0][box] = left + 0.5 * (width - 1) - columns[box]
        middles[1][box] = top + 0.5 * (height - 1) - rows[box]
    return surety, middles


# Pixels put together


def test_two_blocks_that_touch_are_two() -> None:
    boxes = ((40, 30, 20, 22), (60, 31, 20, 20), (60, 51, 20, 20))
    fields = instances(*rectangles((96, 112), *boxes))
    found = {tuple(map(tuple, np.argwhere(field.mask((96, 112))))) for field in fields}
    wanted = {
        tuple((row, column) for row in range(t, t + h) for column in range(left, left + w))
        for t, left, h, w in boxes
    }
    assert found == wanted


def test_an_edge_between_pixels_is_where_the_surety_is_zero() -> None:
    surety, middles = rectangles((64, 64), (20, 20, 20, 20))
    # A quarter of the next pixel to the right is covered as well.
    surety[20:40, 40] = -0.5
    (field,) = instances(surety, middles)
    edge = field.edge()
    assert edge[:, 0].max() == pytest.approx(39.0 + 1.0 / 1.5, abs=0.05)
    assert edge[:, 0].min() == pytest.approx(19.5, abs=0.05)
    assert edge[:, 1].max() == pytest.approx(39.5, abs=0.05)


def test_specks_and_nothing_are_no_blocks() -> None:
    assert instances(*rectangles((64, 64))) == ()
    assert instances(*rectangles((64, 64), (10, 10, 4, 4))) == ()


# Behind the row


def test_what_has_plain_table_before_it_is_behind_the_row() -> None:
    view = FrontView.of(looking_camera(), VOLUME)
    middle, foot = view.shape[1] // 2, int(view.feet[view.shape[1] // 2])
    masks = []
    for low in (foot, foot - 22, foot - 80):  # a block, one on it, and a thing far behind
        mask = np.zeros(view.shape, bool)
        mask[low - 20 : low + 1, middle - 10 : middle + 10] = True
        masks.append(mask)
    table = np.full((*view.shape, 3), 170, np.uint8)
    surety = np.where(np.logical_or.reduce(masks), 1.0, -1.0).astype(np.float32)
    assert stands_behind(masks, view, table, surety) == [False, False, True]
    alone = np.where(masks[0], np.float32(-1.0), surety).astype(np.float32)
    # Without the one it stands on, the second is behind the row as well, unless something is there.
    assert stands_behind(masks[1:], view, table, alone) == [True, True]
    table[masks[0]] = (200, 30, 30)
    assert not stands_behind(masks[1:], view, table, alone)[0]


# Refused


def test_without_calibration_or_places_it_is_said() -> None:
    black = Observation(np.zeros((256, 256, 3), np.uint8))
    with pytest.raises(BadImageError, match="need the camera's calibration"):
        find_in_rgb(black, VOLUME)
    with pytest.raises(BadImageError, match="set stack_positions"):
        find_in_rgb(replace(black, camera=looking_camera()), None)


def test_weights_that_are_not_there_damaged_or_others_are_told(tmp_path: Path) -> None:
    with pytest.raises(WeightsError, match=r"does not exist; train new ones with `make train-mask"):
        load_weights(tmp_path / "none.safetensors")
    cut = tmp_path / "cut.safetensors"
    cut.write_bytes(DEFAULT_WEIGHTS.read_bytes()[:5000])
    with pytest.raises(WeightsError, match="damaged"):
        load_weights(cut)
    other = DEFAULT_WEIGHTS.with_name("visual_module.safetensors")
    with pytest.raises(WeightsError, match="holds no network for masks"):
        load_weights(other)


def test_two_rows_need_depth(world: World) -> None:
    world.reset(SEEN)
    rows = tuple((x, y, 0.0) for x in (0.58, 0.42) for y in (-0.15, 0.0, 0.15))
    perception = Perception(
        MaskCentroid(), PerceptionConfig(mask_source="rgb", stack_positions=rows)
    )
    seen = perception.perceive(Observation(world.render().rgb, camera=looking_camera()))
    assert seen.status is GraphStatus.BAD_IMAGE and "only depth tells apart" in seen.message


# With the package's weights


def test_towers_in_the_simulator_are_seen_in_colour(world: World) -> None:
    perception = Perception(MaskCentroid(), PerceptionConfig(mask_source="rgb"))
    world.reset(SEEN, seed=5)
    frame = world.render()
    seen = perception.perceive(Observation(frame.rgb, camera=looking_camera()))
    assert seen.graph.stacks() == SEEN, seen.message
    assert seen.status is GraphStatus.CONFIDENT, seen.message
    for name in world.names:
        position, _ = world.block_pose(name)
        found = seen.graph.object(name)
        assert np.linalg.norm(np.subtract(found.position_world, position)) < 0.015
    # The picture of a cut-off camera, of which the left half is black, is refused.
    half = frame.rgb.copy()
    half[:, :128] = 0
    lost = perception.perceive(Observation(half, camera=looking_camera()))
    assert lost.status is not GraphStatus.CONFIDENT and lost.message


def test_the_network_is_read_once() -> None:
    assert segmenting.network() is segmenting.network()
