# SPDX-License-Identifier: Apache-2.0
"""The topics that tell of the arm, up to whether a picture contradicts it."""

from __future__ import annotations

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.qos import LATCHED, SENSOR_DATA
from tamp_runtime.stream_thread import StreamThread

from ..camera_topics import CameraTopics
from ..errors import RobotDescriptionError
from ..frame_pairing import StampedSet
from ..observation import Observation
from .rest import JointHistory
from .shape import ArmShape
from .sight import ArmSight


class ArmTopics:
    """The subscriptions to robot_description and joint_states, made before the node is spun.

    As long as one of them is not published, nothing is checked.

    Args:
        node: it gets the subscriptions.
        world_frame: in whose origin the arm's root stands.
    """

    def __init__(self, node: Node, world_frame: str) -> None:
        self._node, self._world_frame = node, world_frame
        self._history = JointHistory()
        self._description = ""
        self._sight: ArmSight | None = None
        self._joint_states = StreamThread.subscribe(
            node, JointState, "joint_states", self._on_joint_state, SENSOR_DATA
        )
        node.create_subscription(
            String,
            "robot_description",
            self._on_description,
            LATCHED,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def stop(self) -> None:
        """Before the node is destroyed."""
        self._joint_states.stop()

    def check(self, camera: CameraTopics, frame: StampedSet, observation: Observation) -> None:
        """Raises BadImageError where a frame surely contradicts an arm that rested then."""
        sight = self._sight
        positions = self._history.at_rest(frame.stamp) if sight is not None else None
        if sight is not None and positions is not None:
            sight.check(camera.name, observation, positions, camera.calibration.pose_frame)

    def _on_joint_state(self, message: JointState) -> None:
        self._history.add(nanoseconds(message.header.stamp), message.name, message.position)

    def _on_description(self, message: String) -> None:
        if message.data == self._description:
            return
        self._description, self._sight = message.data, None
        try:
            self._sight = ArmSight(ArmShape(message.data), self._world_frame)
        except RobotDescriptionError as error:
            self._node.get_logger().warning(
                f"robot_description cannot be used to check the camera: {error}"
            )
