# SPDX-License-Identifier: Apache-2.0
"""sim_node alone: its topics, its services, and that a bad trajectory moves nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import String
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.images import array_from_image
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sim_node.node import SimNode
from sim_node.simulated_arms import PANDA

HOME = PANDA.home_positions
MOVED = np.array([0.1, *[0.0] * 8])
JOINTS = PANDA.joints

TOPICS: dict[str, tuple[type, Any]] = {
    "camera/image_raw": (Image, NEWEST),
    "camera/depth/image_raw": (Image, NEWEST),
    "camera/segmentation": (Image, NEWEST),
    "camera/camera_info": (CameraInfo, NEWEST),
    "camera/depth/camera_info": (CameraInfo, NEWEST),
    "camera/extrinsics": (TransformStamped, LATCHED),
    "joint_states": (JointState, SENSOR_DATA),
    "robot_description": (String, LATCHED),
    "sim/ground_truth": (SceneGraph, LATCHED),
    "clock": (Clock, SENSOR_DATA),
}


class Neighbour(Node):
    """Keeps the newest message and the count of every topic."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("neighbour", **kwargs)
        self.newest: dict[str, Any] = {}
        self.counts = dict.fromkeys(TOPICS, 0)
        for topic, (kind, profile) in TOPICS.items():
            self.create_subscription(kind, topic, self._keeper(topic), profile)
        self.trajectory = self.create_publisher(JointTrajectory, "joint_trajectory", RELIABLE)
        self.reset = self.create_client(ResetScene, "sim/reset")

    def _keeper(self, topic: str) -> Any:
        def keep(message: Any) -> None:
            self.newest[topic] = message
            self.counts[topic] += 1

        return keep

    def position(self) -> np.ndarray:
        state = self.newest["joint_states"]
        return np.array([state.position[state.name.index(name)] for name in JOINTS])


@pytest.fixture
def neighbour(ros_context: Any) -> Neighbour:
    ros_context.add(
        SimNode(
            context=ros_context.context,
            parameter_overrides=[
                Parameter("layout", value=["red_box,blue_box", "", "green_box"]),
                Parameter("real_time_factor", value=0.0),
            ],
        )
    )
    node = ros_context.add(Neighbour(context=ros_context.context))
    ros_context.wait_until(lambda: len(node.newest) == len(TOPICS), what="every topic")
    ros_context.wait_until(lambda: node.trajectory.get_subscription_count() == 1)
    return node


def call_reset(ros_context: Any, node: Neighbour, **request: Any) -> ResetScene.Response:
    assert node.reset.wait_for_service(timeout_sec=10.0)
    future = node.reset.call_async(ResetScene.Request(**request))
    ros_context.wait_until(future.done, what="sim/reset")
    return future.result()


def trajectory(points: list[tuple[float, np.ndarray]], **fields: Any) -> JointTrajectory:
    return JointTrajectory(
        joint_names=fields.get("names", list(JOINTS)),
        points=[
            JointTrajectoryPoint(
                positions=position.tolist(),
                velocities=[fields["velocity"]] * 9 if "velocity" in fields else [],
                time_from_start=Duration(sec=int(time), nanosec=round(1e9 * (time % 1))),
            )
            for time, position in points
        ],
    )


def test_pictures_have_one_stamp_and_the_agreed_shapes(
    ros_context: Any, neighbour: Neighbour
) -> None:
    names = ("camera/image_raw", "camera/depth/image_raw", "camera/segmentation")
    infos = ("camera/camera_info", "camera/depth/camera_info")

    def one_stamp() -> bool:
        headers = [neighbour.newest[name].header for name in (*names, *infos)]
        return len({(header.stamp.sec, header.stamp.nanosec) for header in headers}) == 1

    ros_context.wait_until(one_stamp)
    rgb, depth, labels = (neighbour.newest[name] for name in names)
    assert array_from_image(rgb, "rgb8").shape == (256, 256, 3)
    assert 0.5 < np.median(array_from_image(depth, "32FC1")) < 3.0
    assert set(np.unique(array_from_image(labels, "16UC1"))) == {0, 1, 2, 3}
    assert neighbour.newest["camera/camera_info"].k[0] > 100.0
    assert neighbour.newest["camera/extrinsics"].header.frame_id == "world"


def test_fault_8_the_depth_image_has_a_camera_info_of_its_own(neighbour: Neighbour) -> None:
    color, depth = (neighbour.newest[f"camera/{name}camera_info"] for name in ("", "depth/"))
    assert (depth.width, depth.height) == (color.width, color.height) == (256, 256)
    assert (list(depth.k), depth.header.frame_id) == (list(color.k), color.header.frame_id)


def test_ground_truth_is_the_layout_that_was_asked_for(neighbour: Neighbour) -> None:
    truth = graph_from_message(neighbour.newest["sim/ground_truth"])
    assert truth.stacks() == (("red_box", "blue_box"), (), ("green_box",))


def test_the_description_is_a_urdf_of_the_joints(neighbour: Neighbour) -> None:
    text = neighbour.newest["robot_description"].data
    assert all(f'name="{joint}"' in text for joint in JOINTS)


def test_reset_takes_a_seed_or_a_layout_and_refuses_nonsense(
    ros_context: Any, neighbour: Neighbour
) -> None:
    random = call_reset(ros_context, neighbour, seed=3, blocks=7)
    assert random.success
    assert sum(len(stack.split(",")) for stack in random.layout if stack) == 7
    explicit = call_reset(ros_context, neighbour, layout=["", "pink_box,cyan_box", ""])
    assert explicit.layout == ["", "pink_box,cyan_box", ""]
    refused = call_reset(ros_context, neighbour, layout=["red_box,red_box", "", ""])
    assert not refused.success
    assert "one place only" in refused.message
    refused = call_reset(ros_context, neighbour, seed=1, blocks=12)
    assert not refused.success
    assert "a random scene has 3 to 7" in refused.message
    count = neighbour.counts["sim/ground_truth"]
    ros_context.wait_until(lambda: neighbour.counts["sim/ground_truth"] > count + 1)
    truth = graph_from_message(neighbour.newest["sim/ground_truth"])
    assert truth.stacks() == ((), ("pink_box", "cyan_box"), ())


def test_fault_9_a_refusal_says_why_and_what_is_on_the_table(
    ros_context: Any, neighbour: Neighbour
) -> None:
    there = ["red_box,blue_box", "", "green_box"]
    for blocks in (0, 1, 2, 8):
        refused = call_reset(ros_context, neighbour, seed=3, blocks=blocks)
        assert not refused.success
        assert f"{blocks} blocks asked for; a random scene has 3 to 7" in refused.message
        assert "the scene is unchanged" in refused.message
        assert refused.layout == there
    assert call_reset(ros_context, neighbour, layout=["", "", "red_box"]).success
    refused = call_reset(ros_context, neighbour, layout=["teapot", "", ""])
    assert (refused.success, refused.layout) == (False, ["", "", "red_box"])


def test_it_follows_a_trajectory_to_its_end(ros_context: Any, neighbour: Neighbour) -> None:
    goal = HOME + [0.4, 0.2, 0.0, 0.0, 0.0, 0.0, 0.3, -0.01, -0.01]
    neighbour.trajectory.publish(trajectory([(0.0, HOME), (1.0, goal)]))
    ros_context.wait_until(
        lambda: np.abs(neighbour.position() - goal).max() < 0.005, what="the goal"
    )


@pytest.mark.parametrize(
    "bad",
    [
        trajectory([(0.0, HOME), (1.0, np.full(9, np.nan))]),
        trajectory([(0.0, HOME), (0.0, HOME)]),
        trajectory([(0.0, HOME + 0.3), (1.0, HOME)]),
        trajectory([(0.0, HOME), (0.01, HOME + [0.5, *[0.0] * 8])]),
        trajectory([(0.0, HOME[:4])], names=list(JOINTS)[:4]),
        trajectory([(0.0, HOME[:4])]),
        trajectory([(0.0, HOME)], names=[f"joint{i}" for i in range(9)]),
        trajectory([(0.0, HOME), (2.0, HOME + MOVED), (1.0, HOME + 2 * MOVED)]),
        trajectory([(0.0, HOME), (1.0, HOME)], names=[]),
        trajectory([(0.0, HOME), (1.0, HOME)], names=[JOINTS[0]] * 9),
        trajectory([(1.0, np.zeros(0))]),
        trajectory([(0.0, HOME), (1.0, HOME + 2.0)]),
        trajectory([(0.0, HOME), (1.0, HOME)], velocity=1e308),
    ],
    ids=[
        *("nan", "time", "far start", "too fast", "missing joints", "too few values", "unknown"),
        *("times go back", "no names", "one joint nine times", "empty points", "out of range"),
        "overflow",
    ],
)
def test_a_bad_trajectory_moves_nothing_and_the_next_good_one_is_followed(
    ros_context: Any, neighbour: Neighbour, bad: JointTrajectory
) -> None:
    neighbour.trajectory.publish(bad)
    count = neighbour.counts["joint_states"]
    ros_context.wait_until(lambda: neighbour.counts["joint_states"] > count + 60)
    assert neighbour.position() == pytest.approx(HOME, abs=2e-3)
    test_it_follows_a_trajectory_to_its_end(ros_context, neighbour)
