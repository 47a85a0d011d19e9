# SPDX-License-Identifier: Apache-2.0
"""The model that MuJoCo gets is the arm and the scene that pybullet has."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator

import numpy as np
import pybullet
import pytest
from replay.arm_links import arm_links, bodies_in
from replay.model import mjcf, pair_friction
from scipy.spatial.transform import Rotation

from sim_node.world import World

LAYOUT = (("red_box", "green_cylinder"), ("blue_sphere",), ())


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as made:
        made.reset(LAYOUT, 1)
        yield made


@pytest.fixture(scope="module")
def model(world: World) -> ElementTree.Element:
    text = mjcf(arm_links(world), bodies_in(world), world.arm.finger_joints)
    return ElementTree.fromstring(text)


def numbers(element: ElementTree.Element, key: str) -> np.ndarray:
    return np.array([float(word) for word in element.attrib[key].split()])


def placed(element: ElementTree.Element) -> np.ndarray:
    pose = np.eye(4)
    real, *imaginary = numbers(element, "quat")
    pose[:3, :3] = Rotation.from_quat([*imaginary, real]).as_matrix()
    pose[:3, 3] = numbers(element, "pos")
    return pose


def test_links_are_where_pybullet_has_them(world: World, model: ElementTree.Element) -> None:
    rng = np.random.default_rng(0)
    home = world.joint_state()[0]
    q = dict(zip(world.arm.joints, rng.uniform(world.lower, world.upper)))
    found: dict[str, np.ndarray] = {}

    def walk(element: ElementTree.Element, pose: np.ndarray) -> None:
        pose = pose @ placed(element)
        if (joint := element.find("joint")) is not None:
            moved, axis = np.eye(4), numbers(joint, "axis")
            value = q[joint.attrib["name"]]
            if joint.attrib["type"] == "hinge":
                moved[:3, :3] = Rotation.from_rotvec(value * axis).as_matrix()
            else:
                moved[:3, 3] = value * axis
            pose = pose @ moved
        found[element.attrib["name"]] = pose
        for child in element.findall("body"):
            walk(child, pose)

    for body in model.findall("worldbody/body"):
        if body.find("freejoint") is None and body.attrib["name"].startswith("link:"):
            walk(body, np.eye(4))
    try:
        for index, name in zip(world.joint_indices, world.arm.joints):
            pybullet.resetJointState(world.robot, index, q[name], physicsClientId=world.client)
        for index in range(pybullet.getNumJoints(world.robot, physicsClientId=world.client)):
            info = pybullet.getJointInfo(world.robot, index, physicsClientId=world.client)
            state = pybullet.getLinkState(
                world.robot, index, computeForwardKinematics=True, physicsClientId=world.client
            )
            pose = found[f"link:{info[12].decode()}"]
            assert pose[:3, 3] == pytest.approx(state[4], abs=1e-5)
            turn = Rotation.from_quat(state[5]).as_matrix()
            assert pose[:3, :3] == pytest.approx(turn, abs=1e-5)
    finally:
        for index, value in zip(world.joint_indices, home):
            pybullet.resetJointState(world.robot, index, value, physicsClientId=world.client)


def test_motors_do_what_the_urdf_allows(world: World, model: ElementTree.Element) -> None:
    limits = {motor.attrib["joint"]: numbers(motor, "ctrlrange") for motor in model.iter("motor")}
    assert set(limits) == set(world.arm.joints)
    for name, effort in zip(world.arm.joints, world.max_effort):
        assert limits[name] == pytest.approx([-effort, effort])


def test_blocks_have_their_shape_mass_and_pose(world: World, model: ElementTree.Element) -> None:
    half = 0.0225
    for name, shape, size in (
        ("red_box", "box", [half] * 3),
        ("green_cylinder", "cylinder", [half] * 2),
        ("blue_sphere", "sphere", [half]),
    ):
        body = model.find(f"worldbody/body[@name='body:{name}']")
        assert body is not None
        geom = body.find("geom")
        assert geom is not None
        assert body.find("freejoint") is not None
        assert geom.attrib["type"] == shape
        assert numbers(geom, "size") == pytest.approx(size)
        assert float(geom.attrib["mass"]) == 0.08
        assert numbers(body, "pos") == pytest.approx(world.block_pose(name)[0])


def test_nothing_that_moves_passes_through_a_block(model: ElementTree.Element) -> None:
    pairs = {frozenset((pair.attrib["geom1"], pair.attrib["geom2"])) for pair in model.iter("pair")}
    solid = {geom.attrib["name"] for geom in model.iter("geom")}
    for name in ("body:red_box", "body:green_cylinder", "body:blue_sphere"):
        for other in solid - {name}:
            assert frozenset((name, other)) in pairs, other


def test_friction_of_a_pair_is_bullets(model: ElementTree.Element) -> None:
    found = {
        (pair.attrib["geom1"], pair.attrib["geom2"]): numbers(pair, "friction")
        for pair in model.iter("pair")
    }
    block_on_block = found["body:red_box", "body:green_cylinder"]
    assert block_on_block[:3] == pytest.approx([0.81, 0.81, 2 * 0.9 * 0.003])
    in_the_hand = found["body:red_box", "link:panda_leftfinger"]
    assert in_the_hand[:3] == pytest.approx([1.08, 1.08, 0.003 * 1.2 + 0.01 * 0.9])
    first, second = (0.7, 0.01, 0.002), (1.2, 0.003, 0.0)
    assert pair_friction(first, second) == pair_friction(second, first)


def test_the_model_is_one_text_without_files(model: ElementTree.Element) -> None:
    assert not [element for element in model.iter() if "file" in element.attrib]
    assert all(len(numbers(mesh, "vertex")) >= 12 for mesh in model.iter("mesh"))
