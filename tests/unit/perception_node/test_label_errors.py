# SPDX-License-Identifier: Apache-2.0
"""Labels of a detector that errs are corrected or refused, never believed and wrong."""

from dataclasses import replace

import numpy as np
import pytest
from seen_worlds import LABELLED, TOWERS, observe, perceive

from perception_node.blocks.outline import shape_from_outline
from perception_node.errors import BadImageError
from perception_node.segment import Volume, given_labels
from perception_node.segment.mending import mended
from scene_graph import ROW_OF_THREE, GraphStatus, up_relations
from sim_node.layouts import random_layout
from sim_node.sensor import SegmentationConfig, SensorConfig, sense
from sim_node.sensor.segmentation import ERRORS
from sim_node.world import World

VOLUME = Volume.over(np.array(ROW_OF_THREE), 0.36)
#: Errors of where masks end, and of which pixels belong together: what was found tells better.
CORRECTED = [kind for kind in ERRORS if kind not in ("missing", "phantom")]


def erring(kind: str, strength: int = 1) -> SensorConfig:
    return SensorConfig(segmentation=SegmentationConfig(kind, strength))


@pytest.mark.parametrize("kind", ERRORS)
@pytest.mark.parametrize("seed", range(720, 725))
def test_a_graph_of_labels_that_err_is_right_or_refused(world: World, kind: str, seed: int) -> None:
    layout = random_layout(seed, 3 + seed % 5)
    world.reset(layout, seed)
    perceived = perceive(world, sense(world.render(), erring(kind), (seed, 0, 0)), LABELLED)
    if perceived.status is GraphStatus.CONFIDENT:
        assert perceived.graph.relations == up_relations(layout)
    else:
        assert perceived.message
    assert (perceived.status is GraphStatus.CONFIDENT) == (kind in CORRECTED)


@pytest.mark.parametrize("kind", ["eroded", "dilated", "shifted", "boundary", "merged", "split"])
def test_masks_that_err_become_those_of_the_blocks(world: World, kind: str) -> None:
    world.reset(TOWERS)
    frame = world.render()
    segments = given_labels(observe(world, sense(frame, erring(kind))), VOLUME)
    assert len(segments) == 5
    for segment in segments:
        label = np.bincount(frame.labels[segment.mask]).argmax()
        true = frame.labels == label
        assert label > 0 and np.mean(true[segment.mask]) > 0.95
        assert np.count_nonzero(true & segment.mask) > 0.95 * np.count_nonzero(true)


def test_labels_without_depth_are_taken_as_they_are(world: World) -> None:
    world.reset(TOWERS)
    observation = observe(world, sense(world.render(), erring("eroded", 2)))
    assert observation.labels is not None
    segments = given_labels(observation)
    assert np.array_equal(segments.label_image, observation.labels)


@pytest.mark.parametrize(("kind", "strength"), [("merged", 1), ("split", 1), ("speckled", 5)])
@pytest.mark.parametrize("seed", range(730, 734))
def test_without_depth_masks_are_mended_by_colour(
    world: World, kind: str, strength: int, seed: int
) -> None:
    layout = random_layout(seed, 6)
    world.reset(layout, seed)
    observation = observe(world, sense(world.render(), erring(kind, strength), (seed, 0, 0)))
    perceived = LABELLED.perceive(replace(observation, depth=None))
    assert perceived.status is GraphStatus.CONFIDENT, perceived.message
    assert perceived.graph.relations == up_relations(layout)


def tower(colors: list[tuple[int, int, int]], heights: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """A picture of blocks 20 px wide on one another, each of so many rows, and one beside them."""
    rgb, labels = np.full((128, 128, 3), 200, np.uint8), np.zeros((128, 128), np.int32)
    row = 110
    for label, (color, height) in enumerate(zip(colors, heights), start=1):
        rgb[row - height : row, 20:40], labels[row - height : row, 20:40] = color, label
        row -= height
    rgb[88:110, 80:100], labels[88:110, 80:100] = (20, 40, 200), len(colors) + 1
    return labels, rgb


def test_two_blocks_of_one_colour_stay_two() -> None:
    labels, rgb = tower([(200, 20, 20), (200, 20, 20)], [22, 22])
    assert mended(labels, rgb) is labels


def test_two_masks_in_one_block_are_one() -> None:
    labels, rgb = tower([(200, 20, 20), (180, 18, 18)], [9, 13])
    assert np.array_equal(mended(labels, rgb) > 0, labels > 0)
    assert len(np.unique(mended(labels, rgb))) == 3


def test_a_block_and_a_piece_of_its_colour_are_refused() -> None:
    with pytest.raises(BadImageError, match="no two blocks"):
        mended(*tower([(200, 20, 20), (200, 20, 20)], [22, 10]))


def test_a_mask_of_black_on_grey_is_two_and_one_with_a_bright_lid_is_one() -> None:
    labels, rgb = tower([(120, 120, 120), (15, 15, 15)], [22, 22])
    merged = np.where(labels == 2, 1, labels)
    assert len(np.unique(mended(merged, rgb))) == 4
    labels, rgb = tower([(150, 15, 15), (230, 25, 25)], [16, 6])
    assert len(np.unique(mended(np.where(labels == 2, 1, labels), rgb))) == 3


@pytest.mark.parametrize("kind", ["shifted", "boundary", "eroded"])
def test_without_depth_what_is_beside_a_block_does_not_change_its_shape(
    world: World, kind: str
) -> None:
    world.reset(TOWERS)
    observation = observe(world, sense(world.render(), erring(kind, 2)))
    perceived = LABELLED.perceive(replace(observation, depth=None))
    assert {item.shape for item in perceived.graph.objects} == {"box"}
    assert perceived.graph.relations == up_relations(TOWERS)


@pytest.mark.parametrize(("brightest", "noise"), [(12.0, 0.0), (60.0, 1.0), (200.0, 3.0)])
def test_one_or_two_even_faces_are_a_box_and_what_turns_from_the_light_is_round(
    brightest: float, noise: float
) -> None:
    x = (np.arange(32) + 0.5) / 16.0 - 1.0
    turned = np.arcsin(x)  # of the normal of a cylinder, lit from 0.7 rad aside
    for name, across in (
        ("box", np.ones(32)),
        ("box", np.where(x < 0.3, 1.0, 0.7)),
        ("cylinder", 0.4 + 0.6 * np.cos(turned - 0.7).clip(0.0)),
    ):
        light = brightest * np.tile(across, (32, 1))
        light = light + noise * np.random.default_rng(0).normal(size=light.shape)
        rgb = np.repeat(light[..., None].round().clip(0, 255).astype(np.uint8), 3, axis=2)
        assert shape_from_outline(rgb, np.ones((32, 32), bool)) == name
