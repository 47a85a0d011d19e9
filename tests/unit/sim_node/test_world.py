# SPDX-License-Identifier: Apache-2.0
"""The world obeys physics: towers stand, pushed towers fall, nothing is glued."""

from collections.abc import Iterator

import numpy as np
import pybullet
import pytest

from scene_graph import Relation, up_relations
from sim_node.ground_truth import true_scene_graph
from sim_node.layouts import LayoutError, random_layout
from sim_node.world import World


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / world.timestep)):
        world.step()


@pytest.mark.parametrize("seed", range(4))
def test_a_reset_scene_stands_still_and_is_what_was_asked_for(world: World, seed: int) -> None:
    layout = random_layout(seed, 7)
    world.reset(layout, seed)
    before = [world.block_pose(name)[0] for name in world.names]
    run(world, 2.0)
    after = [world.block_pose(name)[0] for name in world.names]
    assert np.abs(np.subtract(after, before)).max() < 5e-4
    assert true_scene_graph(world).relations == up_relations(layout)


def test_an_impossible_layout_leaves_the_scene_alone(world: World) -> None:
    world.reset((("red_box",), (), ("blue_box",)))
    with pytest.raises(LayoutError):
        world.reset((("red_box", "red_box"), (), ()))
    assert world.names == ("red_box", "blue_box")


def test_a_pushed_block_falls_and_then_stands_on_nothing_or_the_table(world: World) -> None:
    world.reset((("red_box", "blue_box", "green_box"), (), ()))
    for _ in range(30):
        world.push("green_box", (0.0, 6.0, 0.0))
        world.step()
    run(world, 1.0)
    relations = true_scene_graph(world).relations
    assert Relation("green_box", "up", "blue_box") not in relations
    assert world.block_pose("green_box")[0][2] < 0.06


def test_nothing_but_the_hand_s_own_gear_is_a_constraint(world: World) -> None:
    world.reset(random_layout(0, 5))
    count = pybullet.getNumConstraints(physicsClientId=world.client)
    infos = [
        pybullet.getConstraintInfo(
            pybullet.getConstraintUniqueId(index, physicsClientId=world.client),
            physicsClientId=world.client,
        )
        for index in range(count)
    ]
    assert [(info[0], info[2]) for info in infos] == [(world.robot, world.robot)]


@pytest.mark.parametrize("shape", ["box", "cylinder", "sphere"])
def test_every_shape_rests_on_the_table_and_is_seen(world: World, shape: str) -> None:
    name = f"red_{shape}"
    world.reset(((), (name,), ()))
    assert world.block_pose(name)[0][2] == pytest.approx(0.0225, abs=1e-3)
    frame = world.render()
    pixels = frame.labels == world.label(name)
    assert pixels.sum() > 200
    red, green, blue = frame.rgb[pixels].mean(axis=0)
    assert red > 2 * green and red > 2 * blue


def test_every_pixel_of_a_block_lies_on_its_surface(world: World) -> None:
    """Depth, labels and intrinsics belong together to a tenth of a millimetre."""
    world.reset((("red_box", "purple_box"), ("green_box",), ("blue_box",)), 3)
    frame = world.render()
    camera = world.config.camera
    for name in world.names:
        rows, columns = np.nonzero(frame.labels == world.label(name))
        depth = frame.depth[rows, columns].astype(float)
        rays = np.linalg.inv(camera.intrinsics) @ [columns, rows, np.ones(len(rows))]
        points = (camera.world_from_optical @ [*(rays * depth), np.ones(len(rows))])[:3].T
        position, quaternion = world.block_pose(name)
        rotation = np.reshape(pybullet.getMatrixFromQuaternion(quaternion), (3, 3))
        inside = 0.0225 - np.abs((points - position) @ rotation)
        assert np.abs(inside.min(axis=1)).max() < 1e-4


def test_depth_and_labels_agree_with_the_geometry(world: World) -> None:
    world.reset(((), ("green_box",), ()))
    frame = world.render()
    camera = world.config.camera
    position = np.array([*world.block_pose("green_box")[0], 1.0])
    x, y, z = (np.linalg.inv(camera.world_from_optical) @ position)[:3]
    column, row = (camera.intrinsics @ [x / z, y / z, 1.0])[:2]
    assert frame.labels[round(row), round(column)] == world.label("green_box")
    # The front face is half a block nearer than the centre, seen slightly from above.
    assert frame.depth[round(row), round(column)] == pytest.approx(z - 0.0225, abs=0.004)


def test_the_arm_at_home_hides_no_block(world: World) -> None:
    """A tower of seven is seen as large as the same blocks without the arm would be."""
    layout = (("red_box", "green_box", "blue_box", "yellow_box", "purple_box", "orange_box",
               "cyan_box"), (), ())  # fmt: skip
    world.reset(layout)
    frame = world.render()
    counts = [int((frame.labels == world.label(name)).sum()) for name in layout[0]]
    assert min(counts) > 350


def test_what_was_before_a_reset_leaves_no_trace() -> None:
    """The same layout, seed and commands give the same physics bit by bit."""
    layout = random_layout(8, 6)

    def run(world: World) -> list[np.ndarray]:
        """Knocks the tower in the middle over with the hand."""
        world.reset(layout, 8)
        down = np.array([0.0, 0.37, 0.0, -2.39, 0.0, 2.76, 0.79, 0.04, 0.04])
        states = []
        for share in np.linspace(0.0, 1.0, 240):
            world.command((1.0 - share) * world.arm.home_positions + share * down)
            world.step()
            poses = [np.concatenate(world.block_pose(name)) for name in world.names]
            states += [*world.joint_state()[:2], *poses]
        return states

    with World() as fresh, World() as used:
        used.reset(random_layout(3, 7), 3)
        used.command(np.array([0.3, 0.5, 0.1, -1.9, 0.2, 2.4, 0.3, 0.0, 0.0]))
        for _ in range(137):
            used.step()
        used.render()
        for expected, seen in zip(run(fresh), run(used), strict=True):
            np.testing.assert_array_equal(seen, expected)
        assert [used.label(name) for name in used.names] == [
            fresh.label(name) for name in fresh.names
        ]
