# SPDX-License-Identifier: Apache-2.0
"""What the simulator publishes."""

from __future__ import annotations

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
from .urdf import robot_description
from .world import World


class SimTopics:
    """The publishers of :class:`~sim_node.node.SimNode`."""

    def __init__(self, node: Node) -> None:
        self._node = node
        create = node.create_publisher
        self._images = (
            create(Image, "camera/image_raw", NEWEST),
            create(Image, "camera/depth/image_raw", NEWEST),
            create(Image, "camera/segmentation", NEWEST),
            create(CameraInfo, "camera/camera_info", NEWEST),
            create(CameraInfo, "camera/depth/camera_info", NEWEST),
        )
        self._extrinsics = create(TransformStamped, "camera/extrinsics", LATCHED)
        self._joint_states = create(JointState, "joint_states", SENSOR_DATA)
        self._clock = create(Clock, "clock", SENSOR_DATA)
        self._description = create(String, "robot_description", LATCHED)
        self._ground_truth = create(SceneGraphMsg, "sim/ground_truth", LATCHED)

    def publish_descriptions(self, world: World, mesh_uris: str, stamp: Time) -> None:
        """What does not change: where the camera is, and what the arm is like."""
        extrinsics = extrinsics_message(world.config.camera, stamp)
        self._extrinsics.publish(extrinsics)
        self._description.publish(String(data=robot_description(world.arm, mesh_uris)))
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:  # not among the PyPI packages
            return
        self._tf_static = self._node.create_publisher(TFMessage, "tf_static", LATCHED)
        self._tf_static.publish(TFMessage(transforms=[extrinsics]))

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
        """What the camera sees; drawn only if somebody wants it."""
        if not any(topic.get_subscription_count() for topic in self._images):
            return
        messages = camera_messages(world.render(), world.config.camera, stamp)
        for topic, message in zip(self._images, messages):
            topic.publish(message)
