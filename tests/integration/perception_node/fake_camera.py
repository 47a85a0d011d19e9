# SPDX-License-Identifier: Apache-2.0
"""A stand-in for the camera: publishes frames as the simulator does, and listens to perception."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import CameraInfo, Image
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.qos import LATCHED, NEWEST

from scene_graph import Stacks
from sim_node.camera import Frame
from sim_node.conversions import camera_messages, extrinsics_message
from sim_node.scene import CameraConfig
from sim_node.scene.cameras import FIRST

#: Scenes that are shown.
TOWERS: Stacks = (("red_box", "blue_box"), ("green_box",), ("yellow_box", "purple_box"))
OTHER: Stacks = ((), ("green_box", "blue_box", "red_box"), ("purple_box", "yellow_box"))

LABELS = "camera/segmentation"
#: The camera info of a frame and its images, in the order in which the simulator makes them.
DEFAULT_CAMERA = CameraConfig()
TOPICS = {
    "camera/camera_info": CameraInfo,
    "camera/image_raw": Image,
    "camera/depth/image_raw": Image,
    LABELS: Image,
}
#: What a camera publishes by itself.
WITHOUT_LABELS = tuple(topic for topic in TOPICS if topic != LABELS)
#: What a camera without depth publishes.
COLOR_ALONE = ("camera/image_raw", "camera/camera_info")


class FakeCamera:
    """A node's publishers of a camera, and the scene graphs that it heard.

    Args:
        topics: what is published of a frame; the labels only where a detector is there, too.
        config: the camera, whose name its topics begin with.
    """

    def __init__(
        self,
        ros_context: Any,
        node: Node,
        images: QoSProfile = NEWEST,
        extrinsics: QoSProfile = LATCHED,
        topics: Collection[str] = WITHOUT_LABELS,
        config: CameraConfig = DEFAULT_CAMERA,
    ) -> None:
        self.node, self._config = node, config
        self.graphs: list[SceneGraph] = []
        self._wait_until = ros_context.wait_until
        self.seconds = 100
        self.publishers = {
            topic: node.create_publisher(
                TOPICS[topic], topic.replace(FIRST, config.name, 1), images
            )
            for topic in topics
        }
        self._extrinsics = node.create_publisher(
            TransformStamped, f"{config.name}/extrinsics", extrinsics
        )
        node.create_subscription(SceneGraph, "scene_graph", self.graphs.append, NEWEST)

    @property
    def stamp(self) -> Time:
        """Of the newest frame."""
        return Time(sec=self.seconds)

    def calibrate(self) -> None:
        """Publishes where the camera is."""
        self._extrinsics.publish(extrinsics_message(self._config, Time()))

    def calibrate_and_show(self, frame: Frame, config: CameraConfig = DEFAULT_CAMERA) -> SceneGraph:
        """The first graph after the extrinsics have arrived."""
        self.calibrate()
        answers: list[SceneGraph] = []

        def arrived() -> bool:
            answers.append(self.show(frame, config))
            return "camera/extrinsics" not in answers[-1].message

        self._wait_until(arrived, what="extrinsics")
        return answers[-1]

    def messages(self, frame: Frame, config: CameraConfig = DEFAULT_CAMERA) -> dict[str, Any]:
        """Everything of a frame by topic, the labels too, with a new stamp."""
        self.seconds += 1
        return dict(zip(TOPICS, camera_messages(frame, config, self.stamp)))

    def publish(self, messages: Mapping[str, Any]) -> None:
        """Publishes those messages that this camera has a topic for."""
        for topic in self.publishers.keys() & messages.keys():
            self.publishers[topic].publish(messages[topic])

    def send(self, messages: Mapping[str, Any]) -> SceneGraph:
        """Publishes messages of the newest stamp, and waits for the graph of it."""
        self.publish(messages)
        self._wait_until(
            lambda: self.graphs and self.graphs[-1].header.stamp.sec == self.seconds,
            what="a graph of the newest frame",
        )
        return self.graphs[-1]

    def show(self, frame: Frame, config: CameraConfig = DEFAULT_CAMERA) -> SceneGraph:
        """The graph of a frame that a camera took."""
        return self.send(self.messages(frame, config))


def camera_before(ros_context: Any, perception: Node, topics: Collection[str]) -> FakeCamera:
    """A camera that perception hears, and that hears perception."""
    node = ros_context.add(Node("fake_camera", context=ros_context.context, namespace="/cell"))
    camera = FakeCamera(ros_context, node, topics=topics)
    ros_context.wait_until(
        lambda: (
            all(publisher.get_subscription_count() for publisher in camera.publishers.values())
            and perception.count_subscribers("scene_graph")
        ),
        what="discovery",
    )
    return camera
