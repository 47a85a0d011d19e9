# SPDX-License-Identifier: Apache-2.0
"""Segments are the blocks' masks without specks; any function may be the segmenter."""

import numpy as np
import pytest

from perception_node import Observation, Perception, PerceptionConfig, Segments
from perception_node.errors import BadImageError
from perception_node.segment import SEGMENTATION_TOPIC, Volume, given_labels
from perception_node.visual_module.mask_centroid import MaskCentroid
from scene_graph import GraphStatus


def picture() -> np.ndarray:
    """A red square on a blue one, and a green one to the right, on grey."""
    rgb = np.full((128, 128, 3), 180, np.uint8)
    rgb[80:100, 20:40], rgb[60:80, 20:40] = (40, 60, 200), (210, 30, 30)
    rgb[80:100, 90:110] = (30, 150, 40)
    return rgb


def by_color(observation: Observation, _volume: Volume | None) -> Segments:
    """A segmenter that needs no labels: what is colourful, by its strongest channel."""
    rgb = observation.rgb.astype(int)
    colorful = np.ptp(rgb, axis=-1) > 60
    return Segments.from_labels(np.where(colorful, 1 + rgb.argmax(-1), 0))


def test_each_label_is_a_block_in_ascending_order() -> None:
    labels = np.zeros((64, 64), np.uint16)
    labels[:20, :20], labels[40:, 40:] = 900, 7
    segments = Segments.from_labels(labels)
    assert [segment.label for segment in segments] == [7, 900] and len(segments) == 2
    for segment in segments:
        assert np.array_equal(segment.mask, labels == segment.label)
        assert segment.part is segment.mask
    assert np.array_equal(segments.union(), labels > 0)


def test_what_is_left_out_of_the_blocks_has_no_label_any_more() -> None:
    labels = np.zeros((64, 64), np.uint16)
    labels[:20, :20], labels[40:, 40:], labels[40:, :20] = 900, 7, 8
    segments = Segments.from_labels(labels)
    others = segments.without([1])
    assert [segment.label for segment in others] == [7, 900]
    assert np.array_equal(others.label_image, np.where(labels == 8, 0, labels))
    assert segments.without([]) is segments and len(segments) == 3


def test_a_label_of_a_few_pixels_is_a_speck() -> None:
    labels = np.zeros((256, 256), np.uint16)
    labels[3, 3:8] = 77
    segments = Segments.from_labels(labels)
    assert len(segments) == 0 and not segments.union().any()
    assert np.array_equal(segments.label_image, labels)


def test_the_largest_part_leaves_detached_pixels_out_and_bridges_cracks() -> None:
    labels = np.zeros((64, 64), np.uint16)
    labels[10:30, 10:30] = 1
    labels[20, 10:30] = 0
    block = labels == 1
    labels[50:53, 50:53] = 1
    (segment,) = Segments.from_labels(labels)
    assert np.array_equal(segment.part, block)
    assert np.array_equal(segment.mask, labels == 1)


@pytest.mark.parametrize("config", [PerceptionConfig(), PerceptionConfig(SEGMENTATION_TOPIC)])
def test_where_there_is_no_depth_labels_are_asked_for(config: PerceptionConfig) -> None:
    with pytest.raises(BadImageError, match="without instance labels"):
        given_labels(Observation(picture()))
    perceived = Perception(MaskCentroid(), config).perceive(Observation(picture()))
    assert perceived.status is GraphStatus.BAD_IMAGE and "labels" in perceived.message


def test_with_a_segmenter_of_ones_own_a_picture_alone_becomes_a_graph() -> None:
    perceived = Perception(MaskCentroid(), segmenter=by_color).perceive(Observation(picture()))
    assert perceived.status is GraphStatus.CONFIDENT, perceived.message
    assert {str(relation) for relation in perceived.graph.relations} == {
        "red_box up blue_box",
        "blue_box left green_box",
    }
    assert perceived.segments is not None
    assert np.array_equal(perceived.segments.label_image > 0, (picture() != 180).any(-1))


def test_a_segmenter_that_answers_in_another_size_is_refused() -> None:
    def careless(_observation: Observation, _volume: Volume | None) -> Segments:
        return Segments.from_labels(np.ones((64, 128), int))

    perceived = Perception(MaskCentroid(), segmenter=careless).perceive(Observation(picture()))
    assert perceived.status is GraphStatus.BAD_IMAGE
    assert "segmenter" in perceived.message
