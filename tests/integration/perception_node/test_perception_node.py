# SPDX-License-Identifier: Apache-2.0
"""perception_node among fake neighbours: rendered pictures in, scene graphs out."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from ros2_run import PROCESS_TIMEOUT, Start, finish
from sensor_msgs.msg import CameraInfo, Image
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ImageToSceneGraph
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA
from visualization_msgs.msg import Marker, MarkerArray

from perception_node.node import PerceptionNode
from scene_graph import GraphStatus, Stacks, up_relations
from sim_node.camera import Frame
from sim_node.conversions import camera_messages, extrinsics_message
from sim_node.scene import CameraConfig
from sim_node.world import World

EXECUTABLE = ("perception_node", "perception_node")

TOWERS: Stacks = (("red_box", "blue_box"), ("green_box",), ("yellow_box", "purple_box"))
OTHER: Stacks = ((), ("green_box", "blue_box", "red_box"), ("purple_box", "yellow_box"))


@pytest.fixture(scope="module")
def frames() -> dict[Stacks, Frame]:
    rendered = {}
    with World() as world:
        for layout in (TOWERS, OTHER):
            world.reset(layout)
            rendered[layout] = world.render()
    return rendered


@dataclass
class FakeCamera:
    """Publishes frames as the simulator does, and listens to perception."""

    node: Node
    graphs: list[SceneGraph] = field(default_factory=list)
    seconds: int = 100

    def __post_init__(self) -> None:
        topics = ("camera/image_raw", "camera/depth/image_raw", "camera/segmentation")
        self.publishers = [self.node.create_publisher(Image, topic, NEWEST) for topic in topics]
        self.publishers.append(self.node.create_publisher(CameraInfo, "camera/camera_info", NEWEST))
        self.extrinsics = self.node.create_publisher(TransformStamped, "camera/extrinsics", LATCHED)
        self.node.create_subscription(SceneGraph, "scene_graph", self.graphs.append, NEWEST)

    def calibrate(self) -> None:
        self.extrinsics.publish(extrinsics_message(CameraConfig(), Time()))

    def calibrate_and_show(self, frame: Frame) -> SceneGraph:
        """The first graph after the extrinsics have arrived."""
        self.calibrate()
        deadline = time.monotonic() + 20.0
        while "camera/extrinsics" in (message := self.show(frame)).message:
            assert time.monotonic() < deadline, "the extrinsics do not arrive"
        return message

    def messages(self, frame: Frame) -> list[Any]:
        """Colour, depth, segmentation and camera info with a new stamp."""
        self.seconds += 1
        return list(camera_messages(frame, CameraConfig(), Time(sec=self.seconds)))

    def send(self, messages: list[Any]) -> None:
        for publisher, message in zip(self.publishers, messages):
            publisher.publish(message)

    def wait_for_graph(self, timeout: float = 20.0) -> SceneGraph:
        """The graph of the newest stamp."""
        deadline = time.monotonic() + timeout
        while not (self.graphs and self.graphs[-1].header.stamp.sec == self.seconds):
            assert time.monotonic() < deadline, "no graph of the newest frame"
            time.sleep(0.01)
        return self.graphs[-1]

    def show(self, frame: Frame) -> SceneGraph:
        self.send(self.messages(frame))
        return self.wait_for_graph()


@pytest.fixture
def perception(ros_context: Any) -> PerceptionNode:
    return ros_context.add(PerceptionNode(context=ros_context.context))


@pytest.fixture
def camera(ros_context: Any, perception: PerceptionNode) -> Iterator[FakeCamera]:
    camera = FakeCamera(ros_context.add(Node("fake_camera", context=ros_context.context)))
    ros_context.wait_until(
        lambda: (
            all(p.get_subscription_count() for p in camera.publishers)
            and perception.count_subscribers("scene_graph")
        ),
        what="discovery",
    )
    yield camera


def test_a_frame_becomes_a_confident_graph_of_its_time(
    camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    camera.calibrate_and_show(frames[OTHER])
    for layout in (TOWERS, OTHER, TOWERS):
        message = camera.show(frames[layout])
        assert message.status == SceneGraph.CONFIDENT, message.message
        assert message.message == ""
        assert message.header.frame_id == "world"
        assert message.header.stamp == Time(sec=camera.seconds)
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


@pytest.mark.parametrize("damage", ["encoding", "size", "step", "depth", "distortion"])
def test_a_bad_image_is_answered_and_survived(
    camera: FakeCamera, frames: dict[Stacks, Frame], damage: str
) -> None:
    camera.calibrate_and_show(frames[TOWERS])
    messages = camera.messages(frames[TOWERS])
    if damage == "encoding":
        messages[0].encoding = "bgr8"
    elif damage == "size":
        small = camera_messages(
            Frame(*(image[::2] for image in vars(frames[TOWERS]).values())),
            CameraConfig(),
            messages[0].header.stamp,
        )
        messages[2] = small[2]
    elif damage == "step":
        messages[2].step = 7
    elif damage == "depth":
        frame = replace(frames[TOWERS], depth=np.full((256, 256), np.nan, np.float32))
        messages[1] = camera_messages(frame, CameraConfig(), messages[0].header.stamp)[1]
    else:
        messages[3].d = [0.1, 0.0, 0.0, 0.0, 0.0]
    camera.send(messages)
    message = camera.wait_for_graph()
    assert message.status == SceneGraph.BAD_IMAGE
    assert message.message and list(message.objects) == []
    assert camera.show(frames[TOWERS]).status == SceneGraph.CONFIDENT


def test_a_stream_that_never_comes_is_named(
    camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    camera.calibrate()
    deadline = time.monotonic() + 20.0
    while not camera.graphs:
        for index, message in enumerate(camera.messages(frames[TOWERS])):
            if index != 2:
                camera.publishers[index].publish(message)
        time.sleep(0.1)
        assert time.monotonic() < deadline
    assert camera.graphs[-1].status == SceneGraph.BAD_IMAGE
    assert "no camera/segmentation arrives" in camera.graphs[-1].message


def test_of_many_frames_the_newest_counts(camera: FakeCamera, frames: dict[Stacks, Frame]) -> None:
    camera.calibrate_and_show(frames[TOWERS])
    for _ in range(8):
        camera.send(camera.messages(frames[TOWERS]))
    camera.send(camera.messages(frames[OTHER]))
    message = camera.wait_for_graph()
    assert graph_from_message(message).stacks() == OTHER
    stamps = [graph.header.stamp.sec for graph in camera.graphs]
    assert stamps == sorted(set(stamps))


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

    image, _, segmentation, _ = camera.messages(frames[OTHER])
    request = ImageToSceneGraph.Request(image=image, segmentation=segmentation)
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
    ):
        result = perception.set_parameters([Parameter(name, value=value)])[0]
        assert not result.successful and result.reason
    assert perception.set_parameters([Parameter("min_confidence", value=1.0)])[0].successful
    assert camera.show(frames[TOWERS]).status == SceneGraph.LOW_CONFIDENCE
    two_places = [0.5, -0.15, 0.0, 0.5, 0.0, 0.0]
    assert perception.set_parameters([Parameter("stack_positions", value=two_places)])[0].successful
    message = camera.show(frames[TOWERS])
    assert message.status == SceneGraph.UNSTABLE
    assert "3 stacks are seen but there are 2 places" in message.message


def test_the_verdicts_have_the_numbers_of_the_interface() -> None:
    for status in GraphStatus:
        assert getattr(SceneGraph, status.name) == status.value


def test_as_a_process_it_stops_on_sigint_without_a_trace(
    ros_context: Any, start: Start, frames: dict[Stacks, Frame]
) -> None:
    node = Node("fake_camera", context=ros_context.context, namespace="/cell")
    camera = FakeCamera(ros_context.add(node))
    process = start(*EXECUTABLE, "--ros-args", "-r", "__ns:=/cell", "-p", "threads:=2")
    ros_context.wait_until(lambda: all(p.get_subscription_count() for p in camera.publishers))
    camera.calibrate()
    deadline = time.monotonic() + PROCESS_TIMEOUT
    while not any(graph.status == SceneGraph.CONFIDENT for graph in camera.graphs):
        camera.send(camera.messages(frames[TOWERS]))
        time.sleep(0.2)
        assert time.monotonic() < deadline
    process.send_signal(signal.SIGINT)
    code, _, stderr = finish(process)
    assert code == 0
    assert "Exception" not in stderr


@pytest.mark.parametrize("kind", ["missing", "foreign"])
def test_bad_weights_are_refused_with_a_sentence(start: Start, tmp_path: Path, kind: str) -> None:
    path = tmp_path / "weights.safetensors"
    if kind == "foreign":
        path.write_bytes(b"\x80\x04 a pickle perhaps")
    code, _, stderr = finish(start(*EXECUTABLE, "--ros-args", "-p", f"weights:={path}"))
    assert code == 2
    assert f"weights file {path}" in stderr and "make train-visual" in stderr
