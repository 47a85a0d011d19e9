# SPDX-License-Identifier: Apache-2.0
"""Pictures with light meshes are those with the originals; the physics does not notice them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pybullet
import pytest
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, maximum_filter, minimum_filter
from sim_peer import tiny_picture

from sim_node import world as world_module
from sim_node.camera import Frame
from sim_node.meshes.light_urdf import light_urdf
from sim_node.meshes.wavefront import read_obj
from sim_node.simulated_arms import PANDA
from sim_node.world import World

LAYOUT = (("red_box", "blue_cylinder"), ("green_box", "yellow_box"), ("purple_sphere",))
#: The light arm's surface lies this close to the original's, as the camera sees it [m],
DEPTH_TOLERANCE = 0.004
#: and its outline this close [px],
OUTLINE_TOLERANCE = 2
#: but for this share of its pixels: cracks between shells that the original closes more tightly.
CRACKS = 0.001
#: Bent down before and between the stacks, where the arm hides blocks, and beside them.
POSES = [
    PANDA.home_positions,
    np.array([0.0, 0.35, 0.0, -2.2, 0.0, 2.55, 0.785, 0.02, 0.02]),
    np.array([-0.3, 0.5, 0.1, -1.9, 0.2, 2.4, 0.3, 0.04, 0.04]),
    np.array([0.4, 0.1, -0.4, -2.6, -0.5, 2.2, 1.4, 0.0, 0.0]),
]


@pytest.fixture(scope="module")
def original() -> Iterator[World]:
    """The oracle: a world whose camera sees the arm's own visual meshes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(world_module, "light_urdf", lambda urdf: urdf)
        world = World()
    with world:
        world.reset(LAYOUT, seed=4)
        yield world


@pytest.fixture(scope="module")
def light() -> Iterator[World]:
    with World() as world:
        world.reset(LAYOUT, seed=4)
        yield world


def picture(world: World, positions: NDArray[np.float64]) -> tuple[Frame, NDArray[np.bool_]]:
    """What the camera sees with the arm put there, and which pixels are the arm's."""
    for index, position in zip(world.joint_indices, positions):
        pybullet.resetJointState(world.robot, index, position, 0.0, physicsClientId=world.client)
    frame = tiny_picture(world)
    pybullet.resetBasePositionAndOrientation(
        world.robot, (0.0, 0.0, 100.0), (0.0, 0.0, 0.0, 1.0), physicsClientId=world.client
    )
    without = tiny_picture(world)
    pybullet.resetBasePositionAndOrientation(
        world.robot, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), physicsClientId=world.client
    )
    return frame, frame.depth != without.depth


@pytest.mark.parametrize("positions", POSES)
def test_where_no_arm_is_in_front_every_pixel_is_the_same(
    original: World, light: World, positions: NDArray[np.float64]
) -> None:
    expected, arm = picture(original, positions)
    seen, light_arm = picture(light, positions)
    free = ~(arm | light_arm)
    assert arm.sum() > 3000
    assert (free & (expected.labels > 0)).sum() > 2000
    np.testing.assert_array_equal(seen.rgb[free], expected.rgb[free])
    np.testing.assert_array_equal(seen.depth[free], expected.depth[free])
    np.testing.assert_array_equal(seen.labels[free], expected.labels[free])


@pytest.mark.parametrize("positions", POSES)
def test_the_arm_is_seen_where_it_is(
    original: World, light: World, positions: NDArray[np.float64]
) -> None:
    expected, arm = picture(original, positions)
    seen, light_arm = picture(light, positions)
    outline = binary_dilation(arm, iterations=OUTLINE_TOLERANCE) & binary_dilation(
        ~arm, iterations=OUTLINE_TOLERANCE
    )
    assert ((arm ^ light_arm) & ~outline).sum() <= CRACKS * arm.sum()
    # Where one link is before another a pixel's neighbour may be the one that is seen.
    both = arm & light_arm
    near = minimum_filter(expected.depth, 5) - DEPTH_TOLERANCE
    far = maximum_filter(expected.depth, 5) + DEPTH_TOLERANCE
    wrong = both & ~((near <= seen.depth) & (seen.depth <= far))
    assert wrong.sum() <= CRACKS * arm.sum()
    assert np.median(np.abs(seen.depth - expected.depth)[both]) < 0.1 * DEPTH_TOLERANCE
    assert np.abs(seen.rgb.astype(float) - expected.rgb)[both].mean() < 8.0


def test_bodies_joints_and_collision_shapes_are_the_original_s(
    original: World, light: World
) -> None:
    assert facts(light) == facts(original)


def facts(world: World) -> list[Any]:
    """All that the physics knows of the arm, link by link."""
    ask = {"physicsClientId": world.client}
    count = pybullet.getNumJoints(world.robot, **ask)
    return [
        (
            pybullet.getDynamicsInfo(world.robot, link, **ask),
            pybullet.getCollisionShapeData(world.robot, link, **ask),
            pybullet.getJointInfo(world.robot, link, **ask) if link >= 0 else (),
        )
        for link in range(-1, count)
    ]


def test_the_same_commands_move_arm_and_blocks_bit_by_bit_the_same() -> None:
    def run(world: World) -> NDArray[np.float64]:
        """Lowers the hand over the stack in the middle and swings it aside."""
        world.reset(LAYOUT, seed=4)
        down = np.array([0.0, 0.37, 0.0, -2.39, 0.0, 2.76, 0.79, 0.04, 0.04])
        aside = down + [0.5, *[0.0] * 8]
        ways = [np.linspace(PANDA.home_positions, down, 240), np.linspace(down, aside, 120)]
        states = []
        for target in np.concatenate(ways):
            world.command(target)
            world.step()
            blocks = [np.concatenate(world.block_pose(name)) for name in world.names]
            states.append(np.concatenate([*world.joint_state(), *blocks]))
        return np.array(states)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(world_module, "light_urdf", lambda urdf: urdf)
        with World() as world:
            expected = run(world)
    with World() as world:
        seen = run(world)
    sideways = expected[:, len(PANDA.joints) * 3 + 1 :: 7]
    assert np.ptp(sideways, axis=0).max() > 0.05, "the arm met no block"
    np.testing.assert_array_equal(seen, expected)


def test_the_arm_has_a_tenth_of_the_triangles_and_all_its_links() -> None:
    def triangles(urdf: Path) -> list[int]:
        client = pybullet.connect(pybullet.DIRECT)
        robot = pybullet.loadURDF(str(urdf), physicsClientId=client)
        shapes = pybullet.getVisualShapeData(robot, physicsClientId=client)
        pybullet.disconnect(client)
        return [len(read_obj(Path(shape[4].decode())).faces) for shape in shapes]

    before, after = triangles(PANDA.urdf), triangles(light_urdf(PANDA.urdf))
    assert len(before) == len(after) == 11
    assert sum(before) > 100_000
    assert sum(after) < 0.1 * sum(before)
