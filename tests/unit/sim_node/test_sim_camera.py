# SPDX-License-Identifier: Apache-2.0
"""The camera's pictures are those of the physics, and look as pybullet's own renderer has them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pybullet
import pytest
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from sim_peer import edges, exact_ray_cast, ray_cast, tiny_picture

from sim_node.camera import Frame
from sim_node.layouts import random_layout
from sim_node.rendering import surfaces
from sim_node.scene import CameraConfig, SceneConfig, SceneError
from sim_node.world import World

LAYOUT = (("red_box", "blue_cylinder"), ("green_box", "yellow_box"), ("purple_sphere",))


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


def without_arm(world: World) -> None:
    pybullet.resetBasePositionAndOrientation(
        world.robot, (0.0, 0.0, 100.0), (0.0, 0.0, 0.0, 1.0), physicsClientId=world.client
    )


CAMERAS = [
    CameraConfig(),
    CameraConfig(width=320, height=240, position_world=(1.2, 0.6, 0.7)),
    CameraConfig(position_world=(0.52, 0.01, 1.1), target_world=(0.5, 0.0, 0.0)),
]


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("layout", [LAYOUT, random_layout(5, 7)])
def test_labels_and_depth_are_what_rays_hit(camera: CameraConfig, layout: tuple) -> None:
    with World(SceneConfig(cameras=(camera,))) as world:
        world.reset(layout, 3)
        without_arm(world)
        frame = world.render()
        labels, depth = exact_ray_cast(world, step=2)
        by_physics, physical_depth = ray_cast(world, step=2)
    seen, seen_depth = frame.labels[::2, ::2], frame.depth[::2, ::2]
    assert (labels > 0).sum() > 250
    assert (seen == labels).mean() > 0.999
    smooth = (seen == labels) & ~edges(depth) & (depth > 0.0)
    assert smooth.mean() > 0.4
    assert np.abs(seen_depth - depth)[smooth].max() < 2e-4
    # The oracle's equations are those of the physics, as far as its own rays can tell.
    assert (by_physics == labels).mean() > 0.995
    assert np.abs(physical_depth - depth)[smooth & (by_physics == labels)].max() < 3e-3


def test_it_looks_as_pybullet_draws_it(world: World) -> None:
    # Its cylinders have the normals of something rounder; ours are the physics'.
    world.reset((("red_box", "cyan_box"), ("green_box", "yellow_box"), ("purple_sphere",)), 3)
    frame, expected = world.render(), tiny_picture(world)
    inner = ~binary_dilation(edges(expected.depth), iterations=1)
    difference = np.abs(frame.rgb.astype(int) - expected.rgb)[inner]
    blocks = (frame.labels > 0)[inner]
    assert blocks.sum() > 1000
    assert difference[blocks].mean() < 2.0
    assert difference.mean() < 2.0


ARMS = [
    np.array([0.0, 0.35, 0.0, -2.2, 0.0, 2.55, 0.785, 0.02, 0.02]),
    np.array([-0.3, 0.5, 0.1, -1.9, 0.2, 2.4, 0.3, 0.04, 0.04]),
    np.array([0.4, 0.1, -0.4, -2.6, -0.5, 2.2, 1.4, 0.0, 0.0]),
]


@pytest.mark.parametrize("positions", ARMS)
def test_the_arm_is_where_pybullet_draws_it(world: World, positions: NDArray[np.float64]) -> None:
    world.reset(LAYOUT, 3)
    for index, position in zip(world.joint_indices, positions):
        pybullet.resetJointState(world.robot, index, position, 0.0, physicsClientId=world.client)
    frame, expected = world.render(), tiny_picture(world)
    inner = ~edges(expected.depth) & ~binary_dilation(frame.labels > 0, iterations=2)
    difference = np.abs(frame.depth - expected.depth)[inner]
    assert (difference > 1e-3).mean() < 1e-3
    assert np.abs(frame.rgb.astype(int) - expected.rgb)[inner].mean() < 1.0


def test_what_is_behind_the_camera_is_cut_off() -> None:
    """The table reaches behind a camera that stands above it."""
    camera = CameraConfig(position_world=(0.2, 0.0, 0.3), target_world=(0.5, 0.0, 0.05))
    with World(SceneConfig(cameras=(camera,))) as world:
        world.reset(((), ("red_box",), ()))
        without_arm(world)
        frame = world.render()
        labels, depth = exact_ray_cast(world, step=2)
    assert (frame.labels[::2, ::2] == labels).mean() > 0.999
    hit = (depth > 0.0) & ~edges(depth)
    assert np.abs(frame.depth[::2, ::2] - depth)[hit].max() < 2e-4


def test_a_block_that_takes_the_number_of_one_that_is_gone_has_its_own_looks(world: World) -> None:
    world.reset((("red_box",), (), ()))
    world.render()
    world.reset((("blue_sphere",), (), ()))
    frame = world.render()
    red, _, blue = frame.rgb[frame.labels == world.label("blue_sphere")].mean(axis=0)
    assert blue > 2 * red


def picture(world: World, seed: int) -> Frame:
    """After a reset, with the arm where the seed has it."""
    world.reset(random_layout(seed, 5), seed)
    for index, position in zip(world.joint_indices, ARMS[seed % len(ARMS)]):
        pybullet.resetJointState(world.robot, index, position, 0.0, physicsClientId=world.client)
    return world.render()


def test_what_was_before_a_reset_is_not_in_the_pictures_after_it(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are those of a new world that makes all surfaces anew, bit by bit."""
    after_resets = [picture(world, seed) for seed in range(6)]
    monkeypatch.setattr(surfaces, "_surface", surfaces._surface.__wrapped__)
    for seed, frame in enumerate(after_resets):
        with World() as new:
            expected = picture(new, seed)
        assert (frame.rgb == expected.rgb).all()
        assert (frame.depth == expected.depth).all()
        assert (frame.labels == expected.labels).all()


def test_bodies_that_look_as_others_did_get_the_surfaces_of_those(world: World) -> None:
    pictures = [picture(world, seed) for seed in (3, 3)]
    made = surfaces._surface.cache_info()
    pictures.append(picture(world, 3))
    assert made.maxsize is not None  # worlds of ever new blocks fill no memory
    assert surfaces._surface.cache_info().currsize == made.currsize
    assert surfaces._surface.cache_info().misses == made.misses
    assert all((pictures[0].rgb == other.rgb).all() for other in pictures[1:])


def test_a_camera_that_was_moved_sees_what_one_that_was_always_there_sees() -> None:
    here, there = CAMERAS[0], CAMERAS[1]
    there = replace(here, position_world=there.position_world, target_world=there.target_world)
    with World(SceneConfig(cameras=(there,))) as world:
        world.reset(LAYOUT, 3)
        expected = world.render()
    with World(SceneConfig(cameras=(here,))) as world:
        world.reset(LAYOUT, 3)
        with pytest.raises(SceneError):  # no place is seen from there
            world.move_camera(0, (0.5, 0.0, 0.5), (0.5, 0.0, 1.5))
        world.move_camera(0, there.position_world, there.target_world)
        moved = world.render()
        world.reset(LAYOUT, 3)  # after which it is still there
        for seen in (moved, world.render()):
            np.testing.assert_array_equal(seen.rgb, expected.rgb)
            np.testing.assert_array_equal(seen.depth, expected.depth)
