# SPDX-License-Identifier: Apache-2.0
"""Perception hears of the arm, and refuses pictures that show it where it cannot be."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time
from fake_camera import TOWERS, FakeCamera
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.qos import LATCHED, SENSOR_DATA

from scene_graph import Stacks
from sim_node.frame import Frame
from sim_node.simulated_arms import PANDA
from sim_node.urdf import robot_description


def mirrored(frame: Frame) -> Frame:
    return Frame(frame.rgb[:, ::-1], frame.depth[:, ::-1], frame.labels[:, ::-1])


def test_mirrored_pictures_are_refused_once_the_arm_is_known(
    ros_context: Any, camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    frame = frames[TOWERS]
    assert camera.calibrate_and_show(mirrored(frame)).status == SceneGraph.CONFIDENT
    node = camera.node
    node.create_publisher(String, "robot_description", LATCHED).publish(
        String(data=robot_description())
    )
    joint_states = node.create_publisher(JointState, "joint_states", SENSOR_DATA)

    def seen_beside_a_resting_arm(shown: Frame) -> SceneGraph:
        state = JointState(name=PANDA.joints, position=PANDA.home_positions.tolist())
        state.header.stamp = Time(sec=camera.seconds + 1)
        joint_states.publish(state)
        return camera.show(shown)

    answers: list[SceneGraph] = []

    def refused() -> bool:
        answers.append(seen_beside_a_resting_arm(mirrored(frame)))
        return "mirrored camera" in answers[-1].message

    ros_context.wait_until(refused, what="a refusal")
    assert answers[-1].status == SceneGraph.BAD_IMAGE
    assert not answers[-1].objects
    # A state may be lost, and then nobody knows of the arm: the right picture is understood anyway.
    assert seen_beside_a_resting_arm(frame).status == SceneGraph.CONFIDENT
