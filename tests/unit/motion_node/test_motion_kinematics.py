# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pybullet
import pytest
from collision_oracle import CollisionOracle
from motion_scenes import scene

from motion_node.errors import RobotDescriptionError
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.robots.kinematics import Kinematics


def test_every_link_is_where_pybullet_says(urdf: str) -> None:
    kinematics = Kinematics(urdf, PANDA.arm_joints)
    oracle = CollisionOracle(scene((1, 0, 0)))
    rng = np.random.default_rng(0)
    functions = {
        link: kinematics.pose_function(link) for link in oracle.links if "finger" not in link
    }
    for _ in range(20):
        q = rng.uniform(kinematics.lower, kinematics.upper)
        oracle.set_joints(PANDA.arm_joints, q)
        for link, function in functions.items():
            rotation, position = (np.array(value) for value in function(q))
            state = pybullet.getLinkState(
                oracle.robot,
                oracle.links[link],
                computeForwardKinematics=True,
                physicsClientId=oracle.client,
            )
            expected = np.array(pybullet.getMatrixFromQuaternion(state[5])).reshape(3, 3)
            np.testing.assert_allclose(position.ravel(), state[4], atol=1e-5)
            np.testing.assert_allclose(rotation, expected, atol=1e-5)
            in_numbers = kinematics.pose_at(link, q)
            np.testing.assert_allclose(in_numbers[:3, 3], state[4], atol=1e-5)
            np.testing.assert_allclose(in_numbers[:3, :3], expected, atol=1e-5)
    oracle.close()


def test_prismatic_joints_move_along_their_axis(urdf: str) -> None:
    kinematics = Kinematics(urdf, ("panda_finger_joint1",))
    function = kinematics.pose_function("panda_leftfinger")
    closed, opened = (np.array(function(value)[1]).ravel() for value in (0.0, 0.03))
    assert np.linalg.norm(opened - closed) == pytest.approx(0.03)
    by_numbers = kinematics.pose_at("panda_leftfinger", np.array([0.03]))[:3, 3]
    np.testing.assert_allclose(by_numbers, opened)


@pytest.mark.parametrize("reachable", [True, False])
def test_inverse_kinematics_in_c_and_in_numpy_agree(
    planner: MotionPlanner, monkeypatch: pytest.MonkeyPatch, reachable: bool
) -> None:
    inverse, rng, count = planner.inverse, np.random.default_rng(0), 40
    assert inverse._steps is not None  # a compiler is there wherever the workspace can be built
    far = 1.0 if reachable else 2.0
    positions = rng.uniform((0.35, -0.25, 0.02), (0.55, 0.25, 0.3), (count, 3)) * (far, far, 1.0)
    yaws, near = rng.uniform(-0.5, 0.5, count), planner.model.home
    iterations = 25 if reachable else 8
    mine = inverse.solve(positions, yaws, near, iterations)
    monkeypatch.setattr(inverse, "_steps", None)
    np.testing.assert_allclose(mine, inverse.solve(positions, yaws, near, iterations), atol=1e-4)
    if reachable:
        assert np.abs(inverse.residual(mine, positions)).max() < 1e-5
    assert (mine >= planner.model.lower).all() and (mine <= planner.model.upper).all()


def test_limits_are_those_of_the_description(urdf: str) -> None:
    kinematics = Kinematics(urdf, PANDA.arm_joints)
    assert kinematics.lower[0] == pytest.approx(-2.9671)
    assert kinematics.upper[5] == pytest.approx(3.8223)
    assert kinematics.velocity.tolist() == [2.175] * 4 + [2.61] * 3


@pytest.mark.parametrize(
    ("text", "joints", "sentence"),
    [
        ("<robot", (), "not XML"),
        ("<robot/>", ("a",), "no movable joint 'a'"),
        (
            '<robot><joint name="a" type="fixed"><parent link="x"/><child link="y"/>'
            "</joint></robot>",
            ("a",),
            "no movable joint 'a'",
        ),
        ('<robot><joint name="a" type="revolute"><child link="y"/></joint></robot>', (), "'a'"),
        (
            '<robot><joint name="a" type="revolute"><parent link="x"/><child link="y"/>'
            '<axis xyz="0 zero 1"/></joint></robot>',
            (),
            "'a' is malformed",
        ),
    ],
)
def test_unusable_descriptions_are_refused(
    text: str, joints: tuple[str, ...], sentence: str
) -> None:
    with pytest.raises(RobotDescriptionError, match=sentence):
        Kinematics(text, joints)


def test_an_unknown_link_is_named(urdf: str) -> None:
    with pytest.raises(RobotDescriptionError, match="'panda_elbow'") as caught:
        Kinematics(urdf, PANDA.arm_joints).pose_function("panda_elbow")
    assert caught.value.element == "panda_elbow"


def test_an_arm_without_the_links_that_are_kept_clear_is_refused(urdf: str) -> None:
    with pytest.raises(RobotDescriptionError, match="panda_link6"):
        MotionPlanner(urdf.replace('"panda_link6"', '"elbow"'))
