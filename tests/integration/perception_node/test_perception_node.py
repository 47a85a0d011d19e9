# SPDX-License-Identifier: Apache-2.0
"""perception_node among fake neighbours: rendered pictures in, scene graphs out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from fake_camera import OTHER, TOPICS, TOWERS, WITHOUT_LABELS, FakeCamera
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.images import array_from_image, image_from_array
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import RELIABLE

from perception_node.node import PerceptionNode
from scene_graph import Stacks, up_relations
from sim_node.camera import Frame

IMAGE, DEPTH = "camera/image_raw", "camera/depth/image_raw"


def test_a_frame_becomes_a_confident_graph_of_its_time(
    camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    camera.calibrate_and_show(frames[OTHER])
    for layout in (TOWERS, OTHER, TOWERS):
        message = camera.show(frames[layout])
        assert message.status == SceneGraph.CONFIDENT, message.message
        assert message.message == ""
        assert message.header.frame_id == "world"
        assert message.header.stamp == camera.stamp
        graph = graph_from_message(message)
        assert graph.relations == up_relations(layout)
        assert graph.stacks() == layout
        assert 0.6 < message.confidence <= 1.0
        assert 0.0 < message.processing_seconds < 5.0
        assert [item.name for item in message.objects] == sorted(graph.names)
        assert [round(base.position.y, 3) for base in message.bases] == [-0.15, 0.0, 0.15]


def test_it_waits_for_the_extrinsics_and_says_so(
    camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    message = camera.show(frames[TOWERS])
    assert message.status == SceneGraph.BAD_IMAGE
    assert "camera/extrinsics" in message.message
    assert camera.calibrate_and_show(frames[TOWERS]).status == SceneGraph.CONFIDENT


def test_colours_that_froze_are_told_until_they_change(
    camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    camera.calibrate_and_show(frames[TOWERS])
    frozen = replace(frames[OTHER], rgb=frames[TOWERS].rgb)
    message = camera.show(frozen)
    assert message.status == SceneGraph.BAD_IMAGE
    assert "camera/image_raw has been the same picture" in message.message
    assert camera.show(frames[OTHER]).status == SceneGraph.CONFIDENT


@pytest.mark.parametrize("damage", ["encoding", "size", "step", "depth", "distortion"])
def test_a_bad_image_is_answered_and_survived(
    camera: FakeCamera, frames: dict[Stacks, Frame], damage: str
) -> None:
    camera.calibrate_and_show(frames[TOWERS])
    messages = camera.messages(frames[TOWERS])
    if damage == "encoding":
        messages[IMAGE].encoding = "yuv422"
    elif damage == "size":
        small = array_from_image(messages[DEPTH], "32FC1")[::2]
        messages[DEPTH] = image_from_array(small, "32FC1", messages[DEPTH].header)
    elif damage == "step":
        messages[DEPTH].step = 7
    elif damage == "depth":
        unknown = np.full((256, 256), np.nan, np.float32)
        messages[DEPTH] = image_from_array(unknown, "32FC1", messages[DEPTH].header)
    else:
        messages["camera/camera_info"].d = [0.1]
    message = camera.send(messages)
    assert message.status == SceneGraph.BAD_IMAGE
    assert message.message and list(message.objects) == []
    assert camera.show(frames[TOWERS]).status == SceneGraph.CONFIDENT


def test_a_stream_that_never_comes_is_named(
    ros_context: Any,
    camera: FakeCamera,
    frames: dict[Stacks, Frame],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("perception_node.node.SILENCE", 0.1)
    camera.calibrate()

    def complains() -> bool:
        messages = camera.messages(frames[TOWERS])
        del messages[DEPTH]
        camera.publish(messages)
        return bool(camera.graphs)

    ros_context.wait_until(complains)
    assert camera.graphs[-1].status == SceneGraph.BAD_IMAGE
    assert f"no {DEPTH} arrives" in camera.graphs[-1].message


def test_fault_13_constant_stamps_are_told(
    ros_context: Any,
    camera: FakeCamera,
    frames: dict[Stacks, Frame],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("perception_node.node.SILENCE", 0.1)
    camera.calibrate_and_show(frames[TOWERS])
    same = camera.messages(frames[TOWERS])

    def complains() -> bool:
        camera.publish(same)
        newest = camera.graphs[-1]
        return newest.status == SceneGraph.BAD_IMAGE and all(
            text in newest.message for text in ("the stamps of ", "do not advance", *WITHOUT_LABELS)
        )

    ros_context.wait_until(complains)


def test_fault_8_a_best_effort_camera_whose_extrinsics_are_volatile_is_heard(
    ros_context: Any, perception: PerceptionNode, frames: dict[Stacks, Frame]
) -> None:
    node = ros_context.add(Node("fake_camera", context=ros_context.context, namespace="/cell"))
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    camera = FakeCamera(ros_context, node, images=best_effort, extrinsics=RELIABLE)

    def confident() -> bool:
        camera.calibrate()
        camera.publish(camera.messages(frames[OTHER]))
        return any(graph.status == SceneGraph.CONFIDENT for graph in camera.graphs)

    ros_context.wait_until(confident, what="a confident graph")
    assert perception.count_subscribers("camera/image_raw") == 2


def test_fault_8_no_frame_is_interpreted_twice_where_a_second_camera_is_best_effort(
    ros_context: Any, camera: FakeCamera, perception: PerceptionNode, frames: dict[Stacks, Frame]
) -> None:
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    for topic in WITHOUT_LABELS:
        camera.node.create_publisher(TOPICS[topic], topic, best_effort)
    ros_context.wait_until(
        lambda: all(perception.count_subscribers(topic) == 2 for topic in WITHOUT_LABELS),
        what="a second subscription of each topic",
    )
    camera.calibrate_and_show(frames[TOWERS])
    for _ in range(5):
        camera.show(frames[TOWERS])
    stamps = [graph.header.stamp.sec for graph in camera.graphs]
    assert stamps == sorted(set(stamps))


def test_fault_6_two_perceptions_in_one_namespace_are_noticed(
    ros_context: Any, perception: PerceptionNode
) -> None:
    listener = ros_context.add(Node("listener", context=ros_context.context, namespace="/cell"))
    newest: dict[str, DiagnosticStatus] = {}
    listener.create_subscription(
        DiagnosticArray,
        "diagnostics",
        lambda array: newest.update({status.hardware_id: status for status in array.status}),
        RELIABLE,
    )
    ros_context.wait_until(lambda: newest, what=f"a sign of life of {perception.get_name()}")
    assert [status.level for status in newest.values()] == [DiagnosticStatus.OK]
    ros_context.add(PerceptionNode(context=ros_context.context, namespace="/cell"))
    ros_context.wait_until(
        lambda: (
            ["two of perception_node" in status.message for status in list(newest.values())]
            == [True, True]
        ),
        what="both notice the other",
    )


def test_of_many_frames_the_newest_counts(camera: FakeCamera, frames: dict[Stacks, Frame]) -> None:
    camera.calibrate_and_show(frames[TOWERS])
    for _ in range(8):
        camera.publish(camera.messages(frames[TOWERS]))
    message = camera.show(frames[OTHER])
    assert graph_from_message(message).stacks() == OTHER
    stamps = [graph.header.stamp.sec for graph in camera.graphs]
    assert stamps == sorted(set(stamps))
