# SPDX-License-Identifier: Apache-2.0
"""Cameras as people have them: their encodings, lenses, sizes and frames."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fake_camera import OTHER, TOWERS, FakeCamera
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.images import array_from_image, image_from_array
from tamp_runtime.messages.scene_graph import graph_from_message

from perception_node.node import PerceptionNode
from sim_node.camera import Frame
from sim_node.conversions import camera_messages, extrinsics_message
from sim_node.scene import CameraConfig, SceneConfig
from sim_node.world import World

IMAGE, DEPTH, INFO = "camera/image_raw", "camera/depth/image_raw", "camera/camera_info"

CAMERAS = {
    "barrel": CameraConfig(width=640, height=480, distortion=(-0.28, 0.09, 0.001, -0.0005, 0.0)),
    "small": CameraConfig(width=320, height=240),
    "large": CameraConfig(width=1280, height=720),
}


@pytest.fixture(scope="module", params=CAMERAS)
def view(request: pytest.FixtureRequest) -> tuple[CameraConfig, Frame]:
    """A camera and its picture of TOWERS."""
    config = CAMERAS[request.param]
    with World(SceneConfig(cameras=(config,))) as world:
        world.reset(TOWERS)
        return config, world.render()


def test_whatever_lens_and_size_the_same_stacks_are_seen(
    camera: FakeCamera, view: tuple[CameraConfig, Frame]
) -> None:
    config, frame = view
    message = camera.calibrate_and_show(frame, config)
    assert message.status == SceneGraph.CONFIDENT, message.message
    graph = graph_from_message(message)
    assert graph.stacks() == TOWERS
    for item in graph.objects:
        level = next(stack.index(item.name) for stack in TOWERS if item.name in stack)
        place = next(index for index, stack in enumerate(TOWERS) if item.name in stack)
        expected = (0.5, (-0.15, 0.0, 0.15)[place], 0.0225 + 0.045 * level)
        assert item.position_world == pytest.approx(expected, abs=0.003), item.name


def reversed_channels(messages: dict[str, Any]) -> None:
    rgb = array_from_image(messages[IMAGE], "rgb8")
    messages[IMAGE] = image_from_array(rgb[:, :, ::-1], "bgr8", messages[IMAGE].header)


def with_opacity(messages: dict[str, Any]) -> None:
    rgb = array_from_image(messages[IMAGE], "rgb8")
    four = np.dstack([rgb, np.full(rgb.shape[:2], 255, np.uint8)])
    messages[IMAGE] = image_from_array(four, "rgba8", messages[IMAGE].header)


def in_millimetres(messages: dict[str, Any]) -> None:
    depth = array_from_image(messages[DEPTH], "32FC1")
    millimetres = np.nan_to_num(1000.0 * depth).round().astype(np.uint16)
    messages[DEPTH] = image_from_array(millimetres, "16UC1", messages[DEPTH].header)


@pytest.mark.parametrize("change", [reversed_channels, with_opacity, in_millimetres])
def test_encodings_of_drivers_are_understood(
    camera: FakeCamera, frames: dict[Any, Frame], change: Any
) -> None:
    camera.calibrate_and_show(frames[OTHER])
    messages = camera.messages(frames[TOWERS])
    change(messages)
    message = camera.send(messages)
    assert message.status == SceneGraph.CONFIDENT, message.message
    assert graph_from_message(message).stacks() == TOWERS


def test_depth_that_comes_a_little_later_than_color_is_paired_where_it_may(
    ros_context: Any, frames: dict[Any, Frame]
) -> None:
    tolerance = Parameter("pairing_tolerance", value=0.02)
    perception = PerceptionNode(
        context=ros_context.context, namespace="/cell", parameter_overrides=[tolerance]
    )
    ros_context.add(perception)
    node = ros_context.add(Node("fake_camera", context=ros_context.context, namespace="/cell"))
    camera = FakeCamera(ros_context, node)

    def confident() -> bool:
        camera.calibrate()
        messages = camera.messages(frames[OTHER])
        header = messages[DEPTH].header
        messages[DEPTH].header = replace_stamp(header, 15_000_000)
        camera.publish(messages)
        return any(graph.status == SceneGraph.CONFIDENT for graph in camera.graphs)

    ros_context.wait_until(confident, what="a confident graph")
    assert all(graph.header.stamp.nanosec == 0 for graph in camera.graphs)


def replace_stamp(header: Any, later: int) -> Any:
    changed = type(header)(frame_id=header.frame_id)
    changed.stamp.sec, changed.stamp.nanosec = header.stamp.sec, header.stamp.nanosec + later
    return changed


def test_pictures_of_another_camera_than_the_calibrated_one_are_refused(
    camera: FakeCamera, frames: dict[Any, Frame]
) -> None:
    camera.calibrate_and_show(frames[TOWERS])
    messages = camera.messages(frames[TOWERS])
    other = replace(CameraConfig(), name="wrist")
    messages[INFO] = camera_messages(frames[TOWERS], other, camera.stamp)[0]
    message = camera.send(messages)
    assert message.status == SceneGraph.BAD_IMAGE
    assert "'camera_optical_frame'" in message.message
    assert "'wrist_optical_frame'" in message.message


def test_without_extrinsics_the_frames_of_tf_static_lead_to_the_camera(
    camera: FakeCamera, perception: PerceptionNode, frames: dict[Any, Frame]
) -> None:
    # The PyPI packages have no tf2_msgs: what its message holds is handed over by hand.
    whole = extrinsics_message(CameraConfig(), camera.stamp)
    mount = TransformStamped(header=whole.header, child_frame_id="mount")
    mount.transform.rotation.w = 1.0
    whole.header.frame_id = "mount"
    mount.header.frame_id = "world"
    perception._on_frames(type("TFMessage", (), {"transforms": [mount, whole]}))
    message = camera.show(frames[TOWERS])
    assert message.status == SceneGraph.CONFIDENT, message.message
    assert message.header.frame_id == "world"
    assert graph_from_message(message).stacks() == TOWERS
