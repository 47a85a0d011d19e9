# SPDX-License-Identifier: Apache-2.0
"""What the simulator publishes."""

from __future__ import annotations

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import Header, String
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from tamp_runtime.qos import LATCHED, NEWEST, SENSOR_DATA

from scene_graph import SceneGraph

from .conversions import WORLD_FRAME, camera_messages, extrinsics_message, joint_state_message
from .scene import CameraConfig
from .urdf import robot_description
from .world import World


class CameraTopics:
    """The publishers of one camera, ``NAME/image_raw`` and the others."""

    def __init__(self, node: Node, config: CameraConfig) -> None:
        self.config = config
        create, name = node.create_publisher, config.name
        self.images = (
            create(Image, f"{name}/image_raw", NEWEST),
            create(Image, f"{name}/depth/image_raw", NEWEST),
            create(Image, f"{name}/segmentation", NEWEST),
            create(CameraInfo, f"{name}/camera_info", NEWEST),
            create(CameraInfo, f"{name}/depth/camera_info", NEWEST),
        )
        self.extrinsics = create(TransformStamped, f"{name}/extrinsics", LATCHED)


class SimTopics:
    """The publishers of :class:`~sim_node.node.SimNode`."""

    def __init__(self, node: Node, cameras: Sequence[CameraConfig]) -> None:
        self._node = node
        create = node.create_publisher
        self._cameras = tuple(CameraTopics(node, config) for config in cameras)
        self._joint_states = create(JointState, "joint_states", SENSOR_DATA)
        self._clock = create(Clock, "clock", SENSOR_DATA)
        self._description = create(String, "robot_description", LATCHED)
        self._ground_truth = create(SceneGraphMsg, "sim/ground_truth", LATCHED)

    def publish_descriptions(self, world: World, mesh_uris: str, stamp: Time) -> None:
        """What does not change: where the cameras are, and what the arm is like."""
        transforms = []
        for camera in self._cameras:
            transforms.append(extrinsics_message(camera.config, stamp))
            camera.extrinsics.publish(transforms[-1])
        self._description.publish(String(data=robot_description(world.arm, mesh_uris)))
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:  # not among the PyPI packages
            return
        self._tf_static = self._node.create_publisher(TFMessage, "tf_static", LATCHED)
        self._tf_static.publish(TFMessage(transforms=transforms))

    def publish_state(self, world: World, stamp: Time) -> None:
        """The time, and the arm's joints."""
        self._clock.publish(Clock(clock=stamp))
        self._joint_states.publish(
            joint_state_message(world.arm.joints, *world.joint_state(), stamp)
        )

    def publish_truth(self, truth: SceneGraph, stamp: Time) -> None:
        """For evaluation and tests only."""
        header = Header(stamp=stamp, frame_id=WORLD_FRAME)
        self._ground_truth.publish(graph_to_message(truth, header))

    def publish_picture(self, world: World, stamp: Time) -> None:
        """What the cameras see; drawn only if somebody wants it."""
        for number, camera in enumerate(self._cameras):
            if any(topic.get_subscription_count() for topic in camera.images):
                messages = camera_messages(world.render(number), camera.config, stamp)
                for topic, message in zip(camera.images, messages):
                    topic.publish(message)
