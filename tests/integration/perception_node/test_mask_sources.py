# SPDX-License-Identifier: Apache-2.0
"""Where perception_node gets its masks: from colour and depth, or from a detector's labels."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fake_camera import LABELS, OTHER, TOWERS, WITHOUT_LABELS, FakeCamera
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.images import array_from_image, image_from_array
from tamp_runtime.messages.scene_graph import graph_from_message

from perception_node.node import PerceptionNode
from scene_graph import ROW_OF_THREE, Stacks
from sim_node.camera import Frame


def with_labels(messages: dict[str, Any], labels: Any) -> dict[str, Any]:
    """The messages of a frame of which the detector says something else."""
    image = image_from_array(np.asarray(labels, np.uint16), "16UC1", messages[LABELS].header)
    return {**messages, LABELS: image}


def stacks_of(message: SceneGraph) -> Stacks:
    assert message.status == SceneGraph.CONFIDENT, message.message
    return graph_from_message(message).stacks()


# Colour and depth


def test_blocks_are_found_without_a_detector_and_nobody_listens_for_one(
    camera: FakeCamera, perception: PerceptionNode, frames: dict[Stacks, Frame]
) -> None:
    assert LABELS not in camera.publishers
    assert perception.get_parameter("mask_source").value == "rgbd"
    assert stacks_of(camera.calibrate_and_show(frames[TOWERS])) == TOWERS
    assert stacks_of(camera.show(frames[OTHER])) == OTHER
    assert perception.count_subscribers(LABELS) == 0


# Colour alone


def test_colour_alone_becomes_the_same_graph_with_poses(
    color_camera: FakeCamera, perception_of_colors: PerceptionNode, frames: dict[Stacks, Frame]
) -> None:
    assert stacks_of(color_camera.calibrate_and_show(frames[TOWERS])) == TOWERS
    message = color_camera.show(frames[OTHER])
    assert stacks_of(message) == OTHER
    for block in graph_from_message(message).objects:
        assert np.allclose(block.size, 0.045, atol=0.003)
        place = ROW_OF_THREE[1 if block.name in OTHER[1] else 2]
        assert np.allclose(block.position_world[:2], place[:2], atol=0.02)
    for topic in (LABELS, "camera/depth/image_raw"):
        assert perception_of_colors.count_subscribers(topic) == 0


def test_a_dark_picture_is_refused_and_the_next_one_understood(
    color_camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    color_camera.calibrate_and_show(frames[TOWERS])
    dark = color_camera.show(replace(frames[TOWERS], rgb=frames[TOWERS].rgb // 8))
    assert dark.status == SceneGraph.BAD_IMAGE
    assert "too dark to tell colours" in dark.message and list(dark.objects) == []
    assert stacks_of(color_camera.show(frames[TOWERS])) == TOWERS


# A detector


def test_labels_of_a_detector_become_the_same_graph(
    labelling_camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    assert stacks_of(labelling_camera.calibrate_and_show(frames[TOWERS])) == TOWERS
    message = labelling_camera.show(frames[OTHER])
    assert stacks_of(message) == OTHER
    assert {item.label for item in message.objects} == set(np.unique(frames[OTHER].labels)) - {0}


def test_a_block_that_the_detector_overlooks_is_not_counted_as_seen(
    labelling_camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    labelling_camera.calibrate_and_show(frames[TOWERS])
    messages = labelling_camera.messages(frames[TOWERS])
    labels = array_from_image(messages[LABELS], "16UC1")
    overlooked = np.where(labels == labels.max(), 0, labels)
    message = labelling_camera.send(with_labels(messages, overlooked))
    assert message.status == SceneGraph.OCCLUDED
    assert "something that is not a block on a place hides" in message.message


def test_missing_labels_are_told(
    ros_context: Any,
    labelling_camera: FakeCamera,
    frames: dict[Stacks, Frame],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("perception_node.node.SILENCE", 0.1)
    labelling_camera.calibrate()

    def complains() -> bool:
        messages = labelling_camera.messages(frames[TOWERS])
        labelling_camera.publish({topic: messages[topic] for topic in WITHOUT_LABELS})
        return bool(labelling_camera.graphs)

    ros_context.wait_until(complains)
    message = labelling_camera.graphs[-1]
    assert message.status == SceneGraph.BAD_IMAGE
    assert "no camera/segmentation arrives" in message.message


@pytest.mark.parametrize("damage", ["encoding", "size", "step"])
def test_a_bad_label_image_is_answered_and_survived(
    labelling_camera: FakeCamera, frames: dict[Stacks, Frame], damage: str
) -> None:
    labelling_camera.calibrate_and_show(frames[TOWERS])
    messages = labelling_camera.messages(frames[TOWERS])
    if damage == "encoding":
        messages[LABELS].encoding = "8UC1"
    elif damage == "size":
        messages = with_labels(messages, frames[TOWERS].labels[::2])
    else:
        messages[LABELS].step = 7
    message = labelling_camera.send(messages)
    assert message.status == SceneGraph.BAD_IMAGE
    assert "segmentation" in message.message and list(message.objects) == []
    assert labelling_camera.show(frames[TOWERS]).status == SceneGraph.CONFIDENT
