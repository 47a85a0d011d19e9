# SPDX-License-Identifier: Apache-2.0
"""A picture that contradicts a resting arm is refused; nothing else is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from perception_scenes import Solid, cast, looking_camera
from scipy.spatial.transform import Rotation
from seen_worlds import observe

from perception_node import BadImageError, Observation, PinholeCamera
from perception_node.arm import ArmShape, ArmSight, JointHistory
from perception_node.arm.sight import MIRRORED
from perception_node.errors import RobotDescriptionError
from sim_node import Frame, World, robot_description

#: A post with a beam on top that turns about it; the root stands in the origin.
POST = """<robot name="post">
  <link name="base"><collision><origin xyz="0 0 0.15"/>
    <geometry><box size="0.08 0.08 0.3"/></geometry></collision></link>
  <link name="beam"><visual><origin xyz="0.15 0 0"/>
    <geometry><box size="0.3 0.06 0.06"/></geometry></visual></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="beam"/>
    <origin xyz="0 0 0.33"/><axis xyz="0 0 1"/></joint></robot>"""
#: The wall behind what a camera sees [m].
WALL = 3.0
CAMERA = looking_camera()


def post_and_beam(yaw: float) -> list[Solid]:
    """What POST describes, in words of the ray caster."""
    middle = (0.15 * float(np.cos(yaw)), 0.15 * float(np.sin(yaw)), 0.33)
    return [
        Solid("box", (0.0, 0.0, 0.15), (0.04, 0.04, 0.15)),
        Solid("box", middle, (0.15, 0.03, 0.03), yaw),
    ]


def picture(solids: list[Solid], wall: bool = True) -> Observation:
    depth, _ = cast(solids, CAMERA)
    depth = np.where(depth > 0.0, np.minimum(depth, WALL), WALL if wall else 0.0)
    return Observation(np.zeros((*depth.shape, 3), np.uint8), None, depth, CAMERA)


def mirrored(seen: Observation) -> Observation:
    assert seen.depth is not None
    return replace(seen, rgb=seen.rgb[:, ::-1], depth=np.ascontiguousarray(seen.depth[:, ::-1]))


def problem(sight: ArmSight, seen: Observation, frame: str = "world", **joints: float) -> str:
    try:
        sight.check("camera", seen, joints, frame)
    except BadImageError as error:
        return str(error)
    return ""


@pytest.fixture(scope="module")
def post() -> ArmSight:
    return ArmSight(ArmShape(POST))


@pytest.fixture(scope="module")
def panda() -> ArmSight:
    return ArmSight(ArmShape(robot_description()))


@pytest.mark.parametrize("yaw", [0.0, 0.7, -1.6, 3.0])
def test_the_surface_is_predicted_where_a_ray_caster_sees_it(yaw: float) -> None:
    arm = ArmShape(POST).seen_by(CAMERA, {"turn": yaw})
    depth, labels = cast(post_and_beam(yaw), CAMERA)
    grid = np.ix_(arm.rows, arm.columns)
    there = labels[grid] > 0
    known = np.isfinite(arm.depth)
    assert np.count_nonzero(known) > 1000
    # Edges are of a pixel: which side of it a ray passes is a matter of rounding.
    assert np.count_nonzero(known != there) <= 0.01 * np.count_nonzero(there)
    both = known & there
    assert np.quantile(np.abs(arm.depth - depth[grid])[both], 0.95) < 0.001
    outside = labels.copy()
    outside[np.ix_(np.arange(arm.rows[0], arm.rows[-1] + 1), arm.columns)] = 0
    assert not outside[:, arm.columns].any()
    assert (arm.columns + arm.columns[::-1] == CAMERA.width - 1).all()


def test_a_mirrored_picture_is_refused_with_a_sentence(post: ArmSight) -> None:
    seen = picture(post_and_beam(1.2))
    assert problem(post, seen, turn=1.2) == ""
    assert problem(post, mirrored(seen), turn=1.2) == MIRRORED
    nothing_behind = picture(post_and_beam(1.2), wall=False)
    assert problem(post, mirrored(nothing_behind), turn=1.2) == MIRRORED


def test_an_arm_that_is_its_own_mirror_image_tells_nothing(post: ArmSight) -> None:
    assert problem(post, mirrored(picture(post_and_beam(0.0))), turn=0.0) == ""


def test_an_arm_that_is_seen_through_is_refused(post: ArmSight) -> None:
    aside = [
        replace(solid, centre=tuple(np.add(solid.centre, (0.0, 0.35, 0.0))))
        for solid in post_and_beam(0.3)
    ]
    assert "seen through" in problem(post, picture(aside), turn=0.3)


@pytest.mark.parametrize("offset", [-0.05, 0.05, 0.08])
def test_depth_that_is_off_by_centimetres_is_not_called_mirrored(
    panda: ArmSight, arm_world: World, offset: float
) -> None:
    joints: dict[str, Any] = dict(zip(arm_world.arm.joints, arm_world.joint_state()[0]))
    seen = observe(arm_world)
    assert seen.depth is not None
    off = np.where(seen.depth > 0.0, seen.depth + offset, 0.0)
    assert problem(panda, replace(seen, depth=off), **joints) != MIRRORED


@pytest.mark.parametrize("turn", [40.0, 90.0, 180.0])
def test_nothing_is_said_of_an_arm_outside_the_picture(post: ArmSight, turn: float) -> None:
    seen = picture(post_and_beam(1.2))
    pose = CAMERA.world_from_optical.copy()
    pose[:3, :3] = pose[:3, :3] @ Rotation.from_euler("y", turn, degrees=True).as_matrix()
    away = replace(CAMERA, world_from_optical=pose)
    assert problem(post, replace(seen, camera=away), turn=1.2) == ""


@settings(max_examples=40)
@given(
    yaw=st.floats(-3.1, 3.1),
    edges=st.tuples(*[st.integers(0, CAMERA.width)] * 4),
    hidden=st.sampled_from([0.0, np.nan, 0.4]),
)
def test_a_right_picture_is_never_refused_whatever_hides_the_arm(
    post: ArmSight, yaw: float, edges: tuple[int, int, int, int], hidden: float
) -> None:
    seen = picture(post_and_beam(yaw))
    assert seen.depth is not None
    top, bottom = sorted(edges[:2])
    left, right = sorted(edges[2:])
    seen.depth[top:bottom, left:right] = hidden  # lost, or a thing right before the camera
    assert problem(post, seen, turn=yaw) == ""


def test_nothing_is_said_without_depth_joints_or_in_another_frame(post: ArmSight) -> None:
    seen = mirrored(picture(post_and_beam(1.2)))
    assert problem(post, replace(seen, depth=None), turn=1.2) == ""
    assert problem(post, replace(seen, camera=None), turn=1.2) == ""
    assert problem(post, seen, another_joint=1.2) == ""
    assert problem(post, seen, turn=float("nan")) == ""
    assert problem(post, seen, frame="map", turn=1.2) == ""
    assert problem(post, seen, frame="base", turn=1.2) == MIRRORED


def noisy(frame: Frame, rng: np.random.Generator) -> NDArray[np.float32]:
    lost = rng.random(frame.depth.shape) < 0.05
    noise = 0.0015 * frame.depth**2 * rng.standard_normal(frame.depth.shape)
    return np.where(lost, 0.0, frame.depth + noise).astype(np.float32)


@pytest.fixture(scope="module")
def arm_world() -> Iterator[World]:
    with World() as world:
        world.reset((("red_box", "blue_box", "green_box"), (), ("yellow_box", "purple_box")))
        yield world


@pytest.mark.parametrize("turn", [None, 0, 1, 2, 3])
def test_the_simulated_arm_tells_a_mirrored_picture(
    arm_world: World, panda: ArmSight, turn: int | None
) -> None:
    positions = arm_world.arm.home_positions
    rng = np.random.default_rng(turn)
    if turn is not None:
        positions[:4] += rng.uniform(-0.6, 0.6, 4)
    for index, value in zip(arm_world.joint_indices, positions):
        pybullet.resetJointState(arm_world.robot, index, value, physicsClientId=arm_world.client)
    joints: dict[str, Any] = dict(zip(arm_world.arm.joints, positions))
    frame = arm_world.render()
    seen = replace(observe(arm_world, frame), depth=noisy(frame, rng))
    assert problem(panda, seen, **joints) == ""
    assert problem(panda, mirrored(seen), **joints) == MIRRORED


def test_a_camera_that_moved_sees_the_simulated_arm_elsewhere(
    arm_world: World, panda: ArmSight
) -> None:
    arm_world.reset((("red_box",), (), ()))
    joints: dict[str, Any] = dict(zip(arm_world.arm.joints, arm_world.joint_state()[0]))
    seen = observe(arm_world)
    assert seen.camera is not None and seen.depth is not None
    seen = replace(seen, depth=np.where(seen.depth > 0.0, seen.depth, WALL))
    assert problem(panda, seen, **joints) == ""
    pose = seen.camera.world_from_optical.copy()
    pose[:3, 3] += 0.25 * pose[:3, 0]
    moved = PinholeCamera(seen.camera.intrinsics, pose, seen.camera.width, seen.camera.height)
    assert "calibrate the camera" in problem(panda, replace(seen, camera=moved), **joints)


@pytest.mark.parametrize(
    "description",
    [
        "no xml",
        "<robot name='empty'><link name='base'/></robot>",
        POST.replace(
            '<box size="0.08 0.08 0.3"/>', '<mesh filename="package://no/a.stl"/>'
        ).replace('<box size="0.3 0.06 0.06"/>', '<mesh filename="b.step"/>'),
        POST.replace('<child link="beam"/>', '<child link="nowhere"/>'),
    ],
)
def test_descriptions_without_a_shape_are_refused(description: str) -> None:
    with pytest.raises(RobotDescriptionError):
        ArmShape(description)


def test_a_mesh_on_this_machine_is_seen_as_a_box_of_its_size_is(tmp_path: Path) -> None:
    corners = [(x, y, z) for x in (-0.15, 0.15) for y in (-0.03, 0.03) for z in (-0.03, 0.03)]
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    for face in faces:
        a, b, c, d = face.split()
        lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    mesh = tmp_path / "beam.obj"
    mesh.write_text("\n".join(lines) + "\n")
    as_mesh = ArmShape(
        POST.replace('<box size="0.3 0.06 0.06"/>', f'<mesh filename="file://{mesh}"/>')
    )
    one, other = (shape.seen_by(CAMERA, {"turn": 0.9}).depth for shape in (as_mesh, ArmShape(POST)))
    assert one.shape == other.shape
    assert np.count_nonzero(np.isfinite(one) != np.isfinite(other)) < 20
    assert np.nanquantile(np.abs(one - other), 0.98) < 0.001


def test_a_joint_that_mimics_another_one_follows_it() -> None:
    both = POST.replace(
        "</robot>",
        '<link name="tip"/><joint name="tip_turn" type="continuous"><parent link="beam"/>'
        '<child link="tip"/><axis xyz="0 0 1"/>'
        '<mimic joint="turn" multiplier="-2" offset="0.1"/></joint></robot>',
    )
    shape = ArmShape(both)
    assert shape.posed({"turn": 0.5}) == {"turn": 0.5, "tip_turn": pytest.approx(-0.9)}
    assert shape.posed({"turn": 0.5, "tip_turn": 0.3}) == {"turn": 0.5, "tip_turn": 0.3}
    assert shape.posed({"tip_turn": 0.3}) is None


SECOND = 10**9


def states(history: JointHistory, *told: tuple[float, float]) -> JointHistory:
    for seconds, position in told:
        history.add(round(seconds * SECOND), ("turn",), (position,))
    return history


def at_rest(history: JointHistory, seconds: float) -> float | None:
    positions = history.at_rest(round(seconds * SECOND))
    return None if positions is None else positions["turn"]


def test_joints_rest_where_no_state_around_the_picture_differs() -> None:
    resting = states(JointHistory(), *((1.0 + 0.02 * step, 0.5) for step in range(50)))
    assert at_rest(resting, 1.5) == 0.5
    assert at_rest(resting, 2.1) == 0.5
    assert at_rest(resting, 2.2) is None  # nothing is known of then
    assert at_rest(resting, 0.5) is None
    assert at_rest(JointHistory(), 1.0) is None


def test_joints_that_moved_shortly_before_or_after_a_picture_do_not_rest() -> None:
    moving = [(1.0 + 0.02 * step, 0.5 + max(0, step - 50) * 0.01) for step in range(100)]
    history = states(JointHistory(), *moving, *((3.0 + 0.02 * step, 1.0) for step in range(50)))
    assert at_rest(history, 1.5) == 0.5
    assert at_rest(history, 1.9) is None
    assert at_rest(history, 2.5) is None
    assert at_rest(history, 3.1) is None
    assert at_rest(history, 3.5) == 1.0


def test_a_clock_that_goes_back_begins_another_life() -> None:
    history = states(JointHistory(), (5.0, 0.1), (5.1, 0.1), (1.0, 0.9))
    assert at_rest(history, 5.0) is None
    assert at_rest(history, 1.0) == 0.9


def test_states_without_a_stamp_or_of_other_joints_tell_nothing() -> None:
    history = JointHistory()
    history.add(0, ("turn",), (0.5,))
    assert history.at_rest(0) is None
    history.add(SECOND, ("turn",), (0.5,))
    history.add(SECOND + SECOND // 10, ("finger",), (0.5,))
    assert history.at_rest(SECOND) is None
