# SPDX-License-Identifier: Apache-2.0
"""What the simulator publishes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from tamp_runtime.qos import LATCHED, SENSOR_DATA

from scene_graph import SceneGraph

from .camera_topics import CameraTopics
from .conversions import WORLD_FRAME, joint_state_message
from .scene import CameraConfig
from .sensor import SensorConfig
from .urdf import robot_description
from .world import World


class SimTopics:
    """The publishers of :class:`~sim_node.node.SimNode`.

    Args:
        node: it gets the publishers.
        cameras: of the scene.
        sensor: what is wrong with them.
    """

    def __init__(self, node: Node, cameras: Sequence[CameraConfig], sensor: SensorConfig) -> None:
        self._node = node
        create = node.create_publisher
        self._cameras = tuple(
            CameraTopics(node, sensor, config, number) for number, config in enumerate(cameras)
        )
        self._joint_states = create(JointState, "joint_states", SENSOR_DATA)
        self._clock = create(Clock, "clock", SENSOR_DATA)
        self._description = create(String, "robot_description", LATCHED)
        self._ground_truth = create(SceneGraphMsg, "sim/ground_truth", LATCHED)

    def publish_descriptions(self, world: World, mesh_uris: str, stamp: Time) -> None:
        """What does not change: where the cameras are, and what the arm is like."""
        transforms = [camera.publish_extrinsics(stamp) for camera in self._cameras]
        self._description.publish(String(data=robot_description(world.arm, mesh_uris)))
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:  # not among the PyPI packages
            return
        self._tf_static = self._node.create_publisher(TFMessage, "tf_static", LATCHED)
        self._tf_static.publish(TFMessage(transforms=transforms))

    def move_camera(self, number: int, camera: CameraConfig, stamp: Time) -> None:
        """Publishes where a camera is now, by its number."""
        self._cameras[number].move(camera, stamp)

    def publish_state(self, world: World, stamp: Time) -> None:
        """The time, the arm's joints, and pictures that were on their way until now."""
        self._clock.publish(Clock(clock=stamp))
        self._joint_states.publish(
            joint_state_message(world.arm.joints, *world.joint_state(), stamp)
        )
        for camera in self._cameras:
            camera.deliver(world.time)

    def publish_truth(self, truth: SceneGraph, stamp: Time) -> None:
        """For evaluation and tests only."""
        header = Header(stamp=stamp, frame_id=WORLD_FRAME)
        self._ground_truth.publish(graph_to_message(truth, header))

    def publish_pictures(self, world: World, stamp: Time) -> None:
        """What the cameras see; drawn only if somebody wants it."""
        for number, camera in enumerate(self._cameras):
            camera.take(partial(world.render, number), stamp, world.time)

    def configure(self, sensor: SensorConfig) -> None:
        """What is wrong with the cameras from now on."""
        for camera in self._cameras:
            camera.configure(sensor)

    def restart_pictures(self, seed: int) -> None:
        """Begins their errors anew, for a scene of this seed."""
        for camera in self._cameras:
            camera.restart(seed)
