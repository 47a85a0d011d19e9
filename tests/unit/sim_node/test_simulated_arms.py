# SPDX-License-Identifier: Apache-2.0
"""The simulator's arms are those that the motion planner plans for, and what their URDFs say."""

from __future__ import annotations

import numpy as np
import pybullet
import pytest

from motion_node.robots import ARMS
from sim_node.parameters import PARAMETERS
from sim_node.simulated_arms import SIMULATED_ARMS, SimulatedArm
from sim_node.world import World


@pytest.mark.parametrize("name", sorted(SIMULATED_ARMS))
def test_motion_node_knows_the_same_joints_and_the_same_home(name: str) -> None:
    model, planned = SIMULATED_ARMS[name], ARMS[name]
    assert model.arm_joints == planned.arm_joints
    assert model.finger_joints == planned.gripper.finger_joints
    assert model.home == planned.home
    assert model.fingers_open == planned.gripper.finger_travel


@pytest.mark.parametrize("name", sorted(SIMULATED_ARMS))
def test_a_world_starts_at_home_with_open_fingers(name: str) -> None:
    model = SIMULATED_ARMS[name]
    with World(arm=model) as world:
        world.reset((("red_box",), (), ()))
        positions = dict(zip(model.joints, world.joint_state()[0]))
        by_pybullet = [
            pybullet.getJointInfo(world.robot, index, physicsClientId=world.client)[1].decode()
            for index in world.joint_indices
        ]
    assert by_pybullet == list(model.joints)
    arm = [positions[joint] for joint in model.arm_joints]
    assert arm == pytest.approx(model.home, abs=2e-3)
    fingers = [positions[joint] for joint in model.finger_joints]
    assert fingers == pytest.approx([model.fingers_open] * 2, abs=1e-3)


def test_values_of_all_joints_stand_in_the_order_of_the_joints() -> None:
    model = SimulatedArm(
        name="small",
        description=next(iter(SIMULATED_ARMS.values())).urdf,
        arm_joints=("a", "b", "c"),
        finger_joints=("left", "right"),
        home=(0.1, 0.2, 0.3),
        fingers_open=0.05,
        arm_gain=0.6,
        finger_gain=0.3,
        arm_start_tolerance=0.2,
        finger_start_tolerance=0.01,
    )
    assert model.joints == ("a", "b", "c", "left", "right")
    np.testing.assert_array_equal(model.home_positions, [0.1, 0.2, 0.3, 0.05, 0.05])
    np.testing.assert_array_equal(model.gains, [0.6, 0.6, 0.6, 0.3, 0.3])
    np.testing.assert_array_equal(model.start_tolerance, [0.2, 0.2, 0.2, 0.01, 0.01])


def test_an_unknown_robot_is_refused_with_the_known_ones() -> None:
    (spec,) = (spec for spec in PARAMETERS if spec.name == "robot")
    assert spec.read_only
    assert spec.problem(spec.default) == ""
    assert spec.problem("r2d2") == "robot = 'r2d2' is not a known arm; known: kuka_iiwa, panda"
