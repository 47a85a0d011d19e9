# SPDX-License-Identifier: Apache-2.0
"""Messages to plans and joint positions, trajectories to messages."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import scene
from sensor_msgs.msg import JointState
from simulated_arm import BESIDE, SWITCHES, two_moves
from std_msgs.msg import Header
from tamp_interfaces.msg import Move as MoveMessage
from tamp_interfaces.msg import SymbolicPlan
from tamp_runtime.messages.scene_graph import graph_to_message

from motion_node.conversions import joint_positions, plan_from_message, trajectory_to_message
from motion_node.errors import InvalidPlanError, JointStateError
from motion_node.robots import PANDA
from scene_graph import Move

ARM = replace(PANDA, arm_joints=("shoulder", "elbow"), home=(0.0, 0.0), acceleration=(8.0, 8.0))
LEFT, RIGHT = ARM.gripper.finger_joints


def plan_message() -> SymbolicPlan:
    return SymbolicPlan(
        plan_id="a",
        initial=graph_to_message(scene((2, 1, 0)), Header()),
        moves=[
            MoveMessage(source=0, target=2, object_name="green_box"),
            MoveMessage(source=1, target=2),
        ],
    )


def test_a_plan_is_read() -> None:
    plan = plan_from_message(plan_message())
    assert (plan.plan_id, plan.moves) == ("a", (Move(0, 2), Move(1, 2)))
    assert plan.object_names == ("green_box", "")
    assert plan.graph.stacks() == scene((2, 1, 0)).stacks()


def test_scenes_that_make_no_sense_are_refused() -> None:
    twice, nameless = plan_message(), plan_message()
    twice.initial.objects = [*twice.initial.objects, twice.initial.objects[0]]
    nameless.initial.relations[0].predicate = "touches"
    for message, sentence in ((twice, "not unique"), (nameless, "touches")):
        with pytest.raises(InvalidPlanError, match=sentence):
            plan_from_message(message)


def test_a_trajectory_names_all_joints_and_starts_at_once() -> None:
    trajectory = two_moves()
    message = trajectory_to_message(trajectory, ARM)
    assert list(message.joint_names) == ["shoulder", "elbow", LEFT, RIGHT]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (0, 0)
    times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points]
    np.testing.assert_allclose(times, trajectory.times, atol=1e-8)
    taken = int(np.argmin(np.abs(trajectory.times - trajectory.intervals[1].start)))
    np.testing.assert_allclose(message.points[taken].positions, [*SWITCHES[0], BESIDE, BESIDE])
    moving = message.points[3]
    np.testing.assert_allclose(moving.velocities[:2], trajectory.velocities.arm[3])
    assert list(moving.velocities[2:]) == [0.0, 0.0]


def test_joint_states_are_read_by_name() -> None:
    message = JointState(
        name=[RIGHT, "elbow", "head", LEFT, "shoulder"], position=[0.2, 2.0, 9.0, 0.1, 1.0]
    )
    positions = joint_positions(message, ARM)
    assert positions.arm.tolist() == [1.0, 2.0]
    assert positions.fingers.tolist() == [0.1, 0.2]


@pytest.mark.parametrize(
    ("names", "values", "sentence"),
    [
        (["shoulder", "elbow", LEFT], [1.0, 2.0, 0.1], f"without {RIGHT}"),
        (["shoulder", "elbow", LEFT, RIGHT], [1.0, 2.0, 0.1], "with 4 names and 3 positions"),
        (
            ["shoulder", "elbow", LEFT, RIGHT],
            [1.0, float("nan"), 0.1, 0.1],
            "without finite positions of elbow",
        ),
        ([], [], "without shoulder, elbow"),
    ],
)
def test_fault_13_joint_states_that_lack_something_say_what(
    names: list[str], values: list[float], sentence: str
) -> None:
    with pytest.raises(JointStateError, match=f"joint_states arrive {sentence}"):
        joint_positions(JointState(name=names, position=values), ARM)
