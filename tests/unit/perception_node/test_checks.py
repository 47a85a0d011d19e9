# SPDX-License-Identifier: Apache-2.0
"""Pictures whose parts contradict one another are refused with what to check."""

from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
import pytest
from seen_worlds import LABELLED, PERCEPTION, TOWERS, observe, perceive, put

from perception_node import Observation, Perception
from perception_node.errors import BadImageError
from perception_node.segment import Segments, Volume
from perception_node.segment.checks import check_segments
from scene_graph import GraphStatus
from sim_node.layouts import random_layout
from sim_node.world import World

BOTH = pytest.mark.parametrize("perception", [PERCEPTION, LABELLED], ids=["found", "given"])


@pytest.fixture(scope="module")
def observations() -> Iterator[list[Observation]]:
    with World() as world:
        found = []
        for seed in range(4):
            world.reset(random_layout(seed, 3 + seed, 3), seed)
            found.append(observe(world))
        yield found


def refusal(observation: Observation, perception: Perception) -> str:
    perceived = perception.perceive(observation)
    assert perceived.status is GraphStatus.BAD_IMAGE
    return perceived.message


@BOTH
def test_scenes_as_they_are_are_confident(
    observations: list[Observation], perception: Perception
) -> None:
    for observation in observations:
        assert perception.perceive(observation).status is GraphStatus.CONFIDENT


@BOTH
def test_fault_13_colours_that_are_noise_are_said_to_be(
    observations: list[Observation], perception: Perception
) -> None:
    rng = np.random.default_rng(0)
    for observation in observations:
        noise = rng.integers(0, 256, observation.rgb.shape).astype(np.uint8)
        assert "no common colour" in refusal(replace(observation, rgb=noise), perception)


def test_two_blocks_under_one_label_are_named(observations: list[Observation]) -> None:
    """As those that fell on one another may be, where depth tells of one thing."""
    observation = observations[0]
    assert observation.labels is not None
    rgb, (label, *_) = observation.rgb.copy(), np.unique(observation.labels)[1:]
    rows, columns = np.nonzero(observation.labels == label)
    upper = rows <= np.median(rows)
    rgb[rows, columns] = np.where(upper[:, None], (200, 30, 30), (30, 60, 190))
    segments = Segments.from_labels(observation.labels, "camera/segmentation")
    check_segments(observation.rgb, segments)
    with pytest.raises(BadImageError, match="the red block and the blue block"):
        check_segments(rgb, segments)


def test_a_mirrored_picture_is_not_taken_for_other_blocks(observations: list[Observation]) -> None:
    """The masks then cover what stands there in the mirror, and blocks are seen without depth."""
    for observation in observations:
        mirrored = replace(observation, rgb=observation.rgb[:, ::-1].copy())
        message = refusal(mirrored, LABELLED)
        assert "shows the same pixels as camera/segmentation" in message or "no depth" in message
        found = PERCEPTION.perceive(mirrored)
        assert found.status is not GraphStatus.CONFIDENT and found.message


@pytest.mark.parametrize("light", [1.0, 0.3])
@pytest.mark.parametrize("by", [-2, 2])
def test_masks_two_pixels_too_small_or_too_large_still_have_edges(
    observations: list[Observation], light: float, by: int
) -> None:
    kernel = np.ones((5, 5), np.uint8)
    for observation in observations:
        labels = observation.labels
        assert labels is not None
        changed = np.zeros_like(labels)
        for label in np.unique(labels[labels > 0]):
            mask = (labels == label).astype(np.uint8)
            mask = cv2.dilate(mask, kernel) if by > 0 else cv2.erode(mask, kernel)
            changed[(mask > 0) & (changed == 0)] = label
        rgb = (light * observation.rgb).astype(np.uint8)
        perceived = LABELLED.perceive(replace(observation, rgb=rgb, labels=changed))
        assert "the colour of what is around" not in perceived.message


@BOTH
def test_grain_is_no_noise(observations: list[Observation], perception: Perception) -> None:
    rng = np.random.default_rng(1)
    for observation in observations:
        grain = rng.normal(0.0, 10.0, observation.rgb.shape)
        rgb = np.clip(observation.rgb + grain, 0, 255).astype(np.uint8)
        perceived = perception.perceive(replace(observation, rgb=rgb))
        assert perceived.graph.relations == perception.perceive(observation).graph.relations
        assert perceived.status is GraphStatus.CONFIDENT, perceived.message


def test_fault_13_scattered_labels_lead_to_the_segmentation(
    observations: list[Observation],
) -> None:
    rng = np.random.default_rng(2)
    for observation in observations:
        labels = observation.labels
        assert labels is not None
        some = rng.choice(np.unique(labels[labels > 0]), labels.shape)
        scattered = np.where(labels > 0, some, 0).astype(labels.dtype)
        assert "camera/segmentation" in refusal(replace(observation, labels=scattered), LABELLED)


@BOTH
@pytest.mark.parametrize(("nearer", "side"), [(0.05, "above"), (-0.05, "below")])
def test_fault_13_a_table_that_is_elsewhere_leads_to_depth_and_calibration(
    observations: list[Observation], nearer: float, side: str, perception: Perception
) -> None:
    for observation in observations:
        assert observation.depth is not None
        message = refusal(replace(observation, depth=observation.depth - nearer), perception)
        assert f"mm {side} it" in message
        assert "camera/extrinsics" in message


@BOTH
def test_noise_of_a_depth_camera_moves_no_table(
    observations: list[Observation], perception: Perception
) -> None:
    rng = np.random.default_rng(3)
    for observation in observations:
        assert observation.depth is not None
        depth = observation.depth + rng.normal(0.0, 0.002, observation.depth.shape)
        perceived = perception.perceive(replace(observation, depth=depth))
        assert "table is measured" not in perceived.message


def test_masks_that_lost_pixels_and_gained_specks_are_read_all_the_same(
    observations: list[Observation],
) -> None:
    rng = np.random.default_rng(4)
    for observation in observations:
        labels = observation.labels
        assert labels is not None
        damaged = np.where(rng.random(labels.shape) < 0.5, 0, labels)
        specks = (labels == 0) & (rng.random(labels.shape) < 0.03)
        damaged[specks] = rng.choice(np.unique(labels[labels > 0]), np.count_nonzero(specks))
        perceived = LABELLED.perceive(replace(observation, labels=damaged))
        assert perceived.graph.stacks() == LABELLED.perceive(observation).graph.stacks()


@BOTH
@pytest.mark.parametrize("aside", [-0.01, 0.0, 0.01])
def test_a_block_that_fell_before_a_tower_scatters_no_labels(
    world: World, perception: Perception, aside: float
) -> None:
    world.reset(TOWERS, seed=4)
    put(world, "green_box", (0.055, aside, -0.09))
    perceived = perceive(world, perception=perception)
    assert perceived.status in (GraphStatus.UNSTABLE, GraphStatus.OCCLUDED), perceived.message


@pytest.mark.parametrize("taken", [("red_box", "blue_box"), ("blue_box", "yellow_box")])
def test_two_blocks_under_one_label_are_told_by_colour_and_so_are_the_others(
    world: World, taken: tuple[str, str]
) -> None:
    layout = (("red_box", "blue_box", "yellow_box"), (), ("green_box", "pink_box"))
    world.reset(layout)
    observation, one, other = observe(world), *map(world.label, taken)
    assert observation.labels is not None
    labels = np.where(observation.labels == other, one, observation.labels)

    def merged(_observation: Observation, _volume: Volume | None) -> Segments:
        return Segments.from_labels(labels)

    perception = Perception(PERCEPTION.locator, PERCEPTION.config, merged)
    perceived = perception.perceive(observation)
    assert perceived.status is GraphStatus.BAD_IMAGE
    colors = perceived.message.partition(" covers is ")[2].partition(":")[0].split(" and ")
    assert {f"{color}_box" for color in colors} == {*taken}
    assert set(perceived.graph.names) == {name for stack in layout for name in stack} - {*taken}
    assert not perceived.graph.relations
