# SPDX-License-Identifier: Apache-2.0
"""Walls stand, trays hold what is in them, clutter can be pushed, and none of it is a block."""

from __future__ import annotations

import numpy as np
import pybullet
import pytest

from sim_node.ground_truth import true_scene_graph
from sim_node.scene import SceneError, load_scene, parse_scene
from sim_node.simulated_arms import PANDA
from sim_node.world import World

LAYOUT = (("red_box", "blue_box"), ("green_box",), ())


def position(world: World, name: str) -> np.ndarray:
    found = pybullet.getBasePositionAndOrientation(
        world.obstacles[name], physicsClientId=world.client
    )
    return np.array(found[0])


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / world.timestep)):
        world.step()


def test_clutter_stays_in_its_tray_and_is_no_block() -> None:
    with World(load_scene("tray")) as world:
        world.reset(LAYOUT, 3)
        before = {name: position(world, name) for name in world.obstacles}
        run(world, 2.0)
        for name, where in before.items():
            assert np.abs(position(world, name) - where).max() < 2e-3, name
        for name in ("bolt", "eraser", "wedge"):
            assert np.abs(position(world, name)[:2] - [0.45, 0.38]).max() < 0.12
            assert position(world, name)[2] > 0.005
        assert true_scene_graph(world).stacks() == LAYOUT
        assert set(np.unique(world.render().labels)) == {0, 1, 2, 3}


def test_what_has_a_mass_can_be_pushed_and_a_wall_cannot() -> None:
    scene = parse_scene(
        "obstacles: [{name: wall, size: [0.2, 0.02, 0.1], position: [0.5, 0.3]},"
        "{name: can, shape: cylinder, size: [0.06, 0.06, 0.1], position: [0.5, -0.3], mass: 0.2}]"
    )
    with World(scene) as world:
        world.reset(LAYOUT, 1)
        wall, can = position(world, "wall"), position(world, "can")
        for _ in range(60):
            for name in ("wall", "can"):
                pybullet.applyExternalForce(
                    world.obstacles[name], -1, (0.0, 4.0, 0.0), position(world, name),
                    pybullet.WORLD_FRAME, physicsClientId=world.client,
                )  # fmt: skip
            world.step()
        np.testing.assert_array_equal(position(world, "wall"), wall)
        assert position(world, "can")[1] > can[1] + 0.02


def test_a_block_that_is_pushed_against_a_wall_stops_there() -> None:
    scene = parse_scene("obstacles: [{name: wall, size: [0.2, 0.02, 0.1], position: [0.5, 0.06]}]")
    with World(scene) as world:
        world.reset(((), ("red_box",), ()), 1)
        for _ in range(240):
            world.push("red_box", (0.0, 2.0, 0.0))
            world.step()
        assert world.block_pose("red_box")[0][1] == pytest.approx(0.05 - 0.0225, abs=2e-3)


def test_a_wall_hides_what_is_behind_it_and_has_its_colour() -> None:
    scene = parse_scene(
        "obstacles: [{name: wall, size: [0.02, 0.12, 0.08], position: [0.6, 0.0],"
        "color: [0.1, 0.2, 0.9]}]"
    )
    with World(scene) as world:
        world.reset((("red_box",), ("green_box",), ()), 1)
        frame = world.render()
        assert (frame.labels == world.label("green_box")).sum() < 100
        assert (frame.labels == world.label("red_box")).sum() > 400
        camera = scene.camera
        column, row, depth = camera.pixels(np.array([[0.61, 0.0, 0.04]]))[0]
        assert frame.depth[round(row), round(column)] == pytest.approx(depth, abs=1e-3)
        red, _, blue = frame.rgb[round(row), round(column)]
        assert blue > 3 * red


@pytest.mark.parametrize(
    ("text", "key", "says"),
    [
        ("obstacles: [{name: shelf, size: [0.4, 0.4, 0.02], position: [0.3, 0.45, 0.5]},"
         "{name: lamp, shape: sphere, size: [0.2, 0.2, 0.2], position: [0.3, 0.0, 0.6]}]",
         "obstacles[1].position", "deep into the arm at home"),
        ("obstacles: [{name: box, position: [0.5, 0.3], mass: 0.1},"
         "{name: can, shape: cylinder, position: [0.52, 0.32], mass: 0.1}]",
         "obstacles[1].position", "deep into box"),
        ("arm: {home: [0, 0, 0]}", "arm.home", "3 positions; panda has 7 joints"),
        ("arm: {home: [0, 0, 0, 0.5, 0, 1.57, 0.78]}", "arm.home", "panda_joint4 at 0.5"),
        ("arm: {home: [0, 1.2, 0, -1.5, 0, 2.7, 0.78]}", "arm.home", "deep into the table"),
        ("arm: {robot: r2d2}", "arm.robot", "'r2d2' is unknown; known: panda"),
    ],
)  # fmt: skip
def test_what_only_the_bodies_show_is_refused_too(text: str, key: str, says: str) -> None:
    with pytest.raises(SceneError) as caught:
        World(parse_scene(text)).close()
    assert caught.value.key == key
    assert says in str(caught.value)


def test_walls_may_meet_in_a_corner() -> None:
    scene = parse_scene(
        "obstacles: [{name: one, size: [0.2, 0.02, 0.1], position: [0.5, 0.3]},"
        "{name: other, size: [0.02, 0.2, 0.1], position: [0.6, 0.3]}]"
    )
    with World(scene) as world:
        assert set(world.obstacles) == {"one", "other"}


def test_the_arm_rests_where_the_scene_says() -> None:
    home = (0.3, -0.6, 0.0, -2.2, 0.0, 1.6, 0.9)
    with World(parse_scene(f"arm: {{robot: panda, home: {list(home)}}}")) as world:
        world.reset(LAYOUT, 1)
        assert world.joint_state()[0][:7] == pytest.approx(home, abs=5e-3)
        assert world.arm.joints == PANDA.joints


@pytest.mark.parametrize("name", ["tray", "mixed_sizes", "shapes"])
def test_what_was_before_a_reset_leaves_no_trace_in_any_scene(name: str) -> None:
    def states(world: World) -> list[np.ndarray]:
        world.reset(LAYOUT, 8)
        run(world, 1.0)
        poses = [np.concatenate(world.block_pose(item)) for item in world.names]
        return [*poses, *(position(world, item) for item in world.obstacles)]

    scene = load_scene(name)
    with World(scene) as fresh, World(scene) as used:
        used.reset((("pink_box",), (), ("red_box",)), 3)
        used.render()
        run(used, 0.3)
        for expected, seen in zip(states(fresh), states(used), strict=True):
            np.testing.assert_array_equal(seen, expected)
