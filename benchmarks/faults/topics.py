# SPDX-License-Identifier: Apache-2.0
"""The topics between the nodes that a relay can stand in, and who hears them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Final

from geometry_msgs.msg import TransformStamped
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from tamp_interfaces.msg import MotionStatus, SceneGraph, SymbolicPlan
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA, STATUS
from trajectory_msgs.msg import JointTrajectory

IMAGE: Final = "camera/image_raw"
DEPTH: Final = "camera/depth/image_raw"
LABELS: Final = "camera/segmentation"
INFO: Final = "camera/camera_info"
EXTRINSICS: Final = "camera/extrinsics"
TRAJECTORY: Final = "joint_trajectory"
GRIPPER: Final = "gripper_trajectory"
JOINTS: Final = "joint_states"
STATUSES: Final = "motion_status"
PLAN: Final = "symbolic_plan"
GRAPH: Final = "scene_graph"
CLOCK: Final = "clock"
GROUND_TRUTH: Final = "sim/ground_truth"

CAMERA: Final = (IMAGE, DEPTH, LABELS, INFO)


@dataclass(frozen=True)
class Topic:
    """A topic with those who hear it through the relay.

    Attributes:
        group: topics of one group get their relays together, so that the graph is started anew
            only a few times in a campaign.
        lasting: a message holds until the next one, so that a fault begins with the last one.
    """

    name: str
    kind: Any
    qos: QoSProfile
    listeners: tuple[str, ...]
    group: str
    lasting: bool = False

    @property
    def relayed(self) -> str:
        """The name under which the listeners hear it."""
        return f"faulty/{self.name}"


TOPICS: Final = {
    topic.name: topic
    for topic in (
        Topic(IMAGE, Image, NEWEST, ("perception_node",), "camera"),
        Topic(DEPTH, Image, NEWEST, ("perception_node",), "camera"),
        Topic(LABELS, Image, NEWEST, ("perception_node",), "camera"),
        Topic(INFO, CameraInfo, NEWEST, ("perception_node",), "camera"),
        Topic(EXTRINSICS, TransformStamped, LATCHED, ("perception_node",), "camera", lasting=True),
        Topic(TRAJECTORY, JointTrajectory, RELIABLE, ("sim_node",), "arm"),
        Topic(GRIPPER, JointTrajectory, RELIABLE, ("sim_node",), "gripper"),
        Topic(JOINTS, JointState, SENSOR_DATA, ("motion_node",), "arm"),
        Topic(STATUSES, MotionStatus, STATUS, ("planner_node",), "messages"),
        Topic(PLAN, SymbolicPlan, LATCHED, ("motion_node",), "messages"),
        Topic(GRAPH, SceneGraph, NEWEST, ("planner_node",), "messages"),
        Topic(CLOCK, Clock, SENSOR_DATA, ("perception_node", "planner_node", "motion_node"), CLOCK),
    )
}


def groups_of(topics: Collection[str]) -> frozenset[str]:
    """The groups of relays that some topics need."""
    return frozenset(TOPICS[topic].group for topic in topics)


def topics_of(groups: Collection[str]) -> tuple[Topic, ...]:
    """The topics of some groups."""
    return tuple(topic for topic in TOPICS.values() if topic.group in groups)


def remappings(topics: Collection[Topic]) -> dict[str, dict[str, str]]:
    """By node, the rules that put relays before it."""
    rules: dict[str, dict[str, str]] = {}
    for topic in topics:
        for node in topic.listeners:
            # Simulated time is heard on /clock whatever the namespace.
            absolute = "/" if topic.name == CLOCK else ""
            rules.setdefault(node, {})[absolute + topic.name] = absolute + topic.relayed
    return rules
