# SPDX-License-Identifier: Apache-2.0
"""What else perception_node offers: pictures for people, goal images, parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fake_camera import LABELS, OTHER, TOWERS, FakeCamera
from rclpy.parameter import Parameter
from ros2_run import Start, finish
from sensor_msgs.msg import Image
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ImageToSceneGraph
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import RELIABLE, SENSOR_DATA
from visualization_msgs.msg import Marker, MarkerArray

from perception_node.node import PerceptionNode
from scene_graph import Stacks
from sim_node.camera import Frame


def test_pictures_and_markers_are_for_those_who_look(
    ros_context: Any, camera: FakeCamera, perception: PerceptionNode, frames: dict[Stacks, Frame]
) -> None:
    pictures: list[Image] = []
    markers: list[MarkerArray] = []
    camera.node.create_subscription(Image, "scene_graph/image", pictures.append, SENSOR_DATA)
    camera.node.create_subscription(MarkerArray, "scene_graph/markers", markers.append, RELIABLE)
    ros_context.wait_until(
        lambda: (
            perception.count_subscribers("scene_graph/image")
            and perception.count_subscribers("scene_graph/markers")
        )
    )
    camera.calibrate()

    def seen() -> bool:
        camera.show(frames[TOWERS])
        return bool(pictures) and any(len(array.markers) > 1 for array in markers)

    ros_context.wait_until(seen)
    assert pictures[-1].encoding == "rgb8" and len(pictures[-1].data) < 500_000
    # Fault 12: a picture is in the frame of the camera that took it.
    assert {picture.header.frame_id for picture in pictures} == {"camera_optical_frame"}
    shown = markers[-1].markers
    assert shown[0].action == Marker.DELETEALL
    assert {marker.text for marker in shown if marker.text} == {n for s in TOWERS for n in s}
    assert sum(marker.type == Marker.CUBE for marker in shown) == 5


def test_a_goal_image_is_interpreted(
    ros_context: Any, camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    client = camera.node.create_client(ImageToSceneGraph, "image_to_scene_graph")
    assert client.wait_for_service(10.0)

    def ask(request: ImageToSceneGraph.Request) -> SceneGraph:
        future = client.call_async(request)
        ros_context.wait_until(future.done)
        return future.result().scene_graph

    messages = camera.messages(frames[OTHER])
    image = messages["camera/image_raw"]
    request = ImageToSceneGraph.Request(image=image, segmentation=messages[LABELS])
    graph = graph_from_message(ask(request))
    assert graph.places == ()  # no camera is known yet: left-relations instead
    camera.calibrate_and_show(frames[TOWERS])
    answer = ask(request)
    assert answer.status == SceneGraph.CONFIDENT
    assert graph_from_message(answer).stacks() == OTHER
    answer = ask(ImageToSceneGraph.Request(image=image))
    assert answer.status == SceneGraph.BAD_IMAGE
    assert "encoding" in answer.message


def test_parameters_are_checked_and_take_effect(
    camera: FakeCamera, perception: PerceptionNode, frames: dict[Stacks, Frame]
) -> None:
    assert camera.calibrate_and_show(frames[TOWERS]).status == SceneGraph.CONFIDENT
    for name, value in (
        ("min_confidence", 1.5),
        ("stack_positions", [0.5, 0.0]),
        ("stack_positions", [0.5, 0.0, 0.0, 0.5, 0.0, 0.0]),
        ("weights", "/elsewhere"),
        ("mask_source", "segmentation_topic"),
    ):
        result = perception.set_parameters([Parameter(name, value=value)])[0]
        assert not result.successful and result.reason
    assert perception.set_parameters([Parameter("min_confidence", value=1.0)])[0].successful
    assert camera.show(frames[TOWERS]).status == SceneGraph.LOW_CONFIDENCE
    two_places = [0.5, -0.08, 0.0, 0.5, 0.08, 0.0]
    assert perception.set_parameters([Parameter("stack_positions", value=two_places)])[0].successful
    message = camera.show(frames[TOWERS])
    assert message.status == SceneGraph.UNSTABLE
    assert "3 stacks are seen but there are 2 places" in message.message


def test_a_source_of_masks_that_does_not_exist_is_refused_with_those_that_do(start: Start) -> None:
    ended = finish(
        start("perception_node", "perception_node", "--ros-args", "-p", "mask_source:=detector")
    )
    assert ended.code == 2
    assert "mask_source is 'detector'; there are rgbd, rgb, segmentation_topic" in ended.stderr


def test_bad_weights_are_refused_with_a_sentence(start: Start, tmp_path: Path) -> None:
    path = tmp_path / "weights.safetensors"
    ended = finish(
        start("perception_node", "perception_node", "--ros-args", "-p", f"weights:={path}")
    )
    assert ended.code == 2
    assert f"weights file {path}" in ended.stderr and "make train-visual" in ended.stderr
