# SPDX-License-Identifier: Apache-2.0
"""Blocks of all shapes and sizes stand as they are described, and the truth about them is true."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pybullet
import pytest

from scene_graph import COLORS, SHAPES, Relation, object_name, rotation_from_quaternion
from sim_node.ground_truth import true_scene_graph
from sim_node.layouts import LayoutError
from sim_node.scene import load_scene, parse_scene
from sim_node.world import World

TWO_ROWS = load_scene("two_rows")
EDGES = "[0.04, 0.05, 0.06]"
OWN = parse_scene(
    "blocks: {most: 14, shapes: [box, cylinder], named: {red_box: {size: "
    + EDGES
    + ", mass: 0.2, friction: 0.5}, "
    "blue_box: {size: 0.03}, mint_prism: {size: [0.05, 0.04, 0.03]}, "
    "cyan_cylinder: {size: [0.05, 0.05, 0.035]}, grey_sphere: {size: 0.06}}}"
)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World(OWN) as world:
        yield world


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / world.timestep)):
        world.step()


def extents(world: World, name: str) -> np.ndarray:
    """Of what the camera's rays could hit of a block, in its own frame, from the physics [m]."""
    body = world.body(name)
    lower, upper = pybullet.getAABB(body, physicsClientId=world.client)
    return np.subtract(upper, lower)


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("red_box", (0.04, 0.05, 0.06)),
        ("blue_box", (0.03, 0.03, 0.03)),
        ("mint_prism", (0.05, 0.04, 0.03)),
        ("cyan_cylinder", (0.05, 0.05, 0.035)),
        ("grey_sphere", (0.06, 0.06, 0.06)),
        ("green_box", (0.045, 0.045, 0.045)),
    ],
)
def test_a_block_is_as_large_in_physics_picture_and_truth_as_the_scene_says(
    world: World, name: str, size: tuple[float, float, float]
) -> None:
    world.reset(((), (name,), ()), 3, settle_time=1.0)
    item = true_scene_graph(world).object(name)
    assert item.size == size
    assert item.position_world[2] == pytest.approx(size[2] / 2, abs=5e-4)
    # The physics gives boxes around bodies in world, a millimetre wider on each side or so.
    rotation = np.abs(rotation_from_quaternion(item.quaternion_world))
    around = rotation @ size if name.endswith(("box", "prism")) else np.array(size)
    assert extents(world, name) == pytest.approx(around, abs=5e-3)
    camera, frame = world.config.camera, world.render()
    rows, columns = np.nonzero(frame.labels == world.label(name))
    depth = frame.depth[rows, columns].astype(float)
    rays = np.linalg.inv(camera.intrinsics) @ [columns, rows, np.ones(len(rows))]
    seen = (camera.world_from_optical @ [*(rays * depth), np.ones(len(rows))])[:3].T
    assert seen[:, 2].max() == pytest.approx(size[2], abs=2e-3)
    assert seen[:, 2].min() == pytest.approx(0.0, abs=8e-3)


def test_masses_and_friction_are_those_of_the_scene(world: World) -> None:
    world.reset((("red_box",), ("green_box",), ()))
    for name, mass, friction in (("red_box", 0.2, 0.5), ("green_box", 0.08, 0.9)):
        found = pybullet.getDynamicsInfo(world.body(name), -1, physicsClientId=world.client)
        assert found[:2] == (pytest.approx(mass), pytest.approx(friction))


def test_a_prism_is_a_roof_in_the_picture(world: World) -> None:
    """Every pixel of it lies on one of its five faces, by its equation."""
    world.reset(((), ("mint_prism",), ()), 5)
    camera, frame = world.config.camera, world.render()
    rows, columns = np.nonzero(frame.labels == world.label("mint_prism"))
    depth = frame.depth[rows, columns].astype(float)
    rays = np.linalg.inv(camera.intrinsics) @ [columns, rows, np.ones(len(rows))]
    points = (camera.world_from_optical @ [*(rays * depth), np.ones(len(rows))])[:3].T
    position, quaternion = world.block_pose("mint_prism")
    x, y, z = ((points - position) @ rotation_from_quaternion(quaternion)).T
    slope = (0.015 - z) / 0.03 * 0.025 - np.abs(x)  # half the width that is left at a height
    faces = np.stack([slope * 0.03 / np.hypot(0.03, 0.025), 0.02 - np.abs(y), z + 0.015])
    assert len(rows) > 100
    assert np.abs(faces.min(axis=0)).max() < 2e-4


def test_stacks_of_different_heights_stand_and_are_told_truly(world: World) -> None:
    layout = (
        ("red_box", "blue_box", "green_box", "grey_sphere"),
        ("cyan_cylinder", "mint_prism"),
        ("blue_cylinder", "yellow_box"),
    )
    world.reset(layout, 4)
    before = [world.block_pose(name)[0] for name in world.names]
    run(world, 2.0)
    after = [world.block_pose(name)[0] for name in world.names]
    assert np.abs(np.subtract(after, before)).max() < 2e-3
    assert true_scene_graph(world).stacks() == layout


def test_a_block_beside_a_narrow_one_of_its_height_does_not_stand_on_it(world: World) -> None:
    """The blue box's top is 3 cm wide: what touches 2 cm beside its middle is not on it."""
    world.reset((("blue_box", "green_box"), (), ()))
    position, quaternion = world.block_pose("green_box")
    on = Relation("green_box", "up", "blue_box")
    assert on in true_scene_graph(world).relations
    moved = np.add(position, [0.0, 0.02, 0.0])
    pybullet.resetBasePositionAndOrientation(
        world.body("green_box"), moved, quaternion, physicsClientId=world.client
    )
    assert on not in true_scene_graph(world).relations


def test_a_box_that_fell_over_is_as_high_as_it_lies(world: World) -> None:
    world.reset(((), ("red_box",), ()))
    lying = pybullet.getQuaternionFromEuler((np.pi / 2, 0.0, 0.0))
    pybullet.resetBasePositionAndOrientation(
        world.body("red_box"), (0.5, 0.0, 0.025), lying, physicsClientId=world.client
    )
    assert Relation("red_box", "up", "stack1") in true_scene_graph(world).relations


def test_all_names_that_there_are_can_be_put_down_and_seen() -> None:
    """Fourteen at once, of every colour and shape, on two rows of places."""
    scene = parse_scene(
        "blocks: {most: 14, shapes: [box, prism]}\n"
        "places: [[0.6, -0.2], [0.6, 0], [0.6, 0.2], [0.42, -0.2], [0.42, 0], [0.42, 0.2]]\n"
        "cameras: [{position: [1.4, 0.0, 0.8], target: [0.5, 0.0, 0.1]}]"
    )
    colors = iter(COLORS)
    flat = [object_name(next(colors), shape) for shape in SHAPES[:2] * 4]
    tops = [object_name(next(colors), shape) for shape in SHAPES[2:] * 3]
    layout = tuple((*flat[place::6], tops[place]) for place in range(6))
    with World(scene) as world:
        world.reset(layout, 1)
        assert true_scene_graph(world).stacks() == layout
        assert len(world.names) == 14
        assert set(np.unique(world.render().labels)) == set(range(15))


def test_a_block_has_the_same_size_in_every_layout_of_a_seed() -> None:
    scene = load_scene("mixed_sizes")
    sizes = {scene.blocks.block("cyan_box", seed).size for seed in range(50)}
    assert len(sizes) == 50
    assert all(0.03 <= edge <= 0.06 for size in sizes for edge in size)
    assert np.ptp([size[0] for size in sizes]) > 0.02
    with World(scene) as world:
        world.reset((("cyan_box",), ("pink_box", "red_box"), ()), 9)
        one = world.block("cyan_box")
        world.reset((("pink_box",), (), ("green_box", "cyan_box")), 9)
        assert world.block("cyan_box") == one == scene.blocks.block("cyan_box", 9)
        assert world.block("pink_box") != scene.blocks.block("pink_box", 8)


def test_places_in_two_rows_have_bases_of_their_own() -> None:
    layout = (("red_box",), (), ("blue_box",), (), ("green_box", "pink_box"), ())
    with World(TWO_ROWS) as world:
        world.reset(layout, 2)
        graph = true_scene_graph(world)
        assert graph.stacks() == layout
        assert [place.position_world[:2] for place in graph.places] == [
            (0.58, -0.15), (0.58, 0.0), (0.58, 0.15), (0.42, -0.15), (0.42, 0.0), (0.42, 0.15),
        ]  # fmt: skip


@pytest.mark.parametrize(
    ("layout", "reason"),
    [
        ((("mint_prism", "red_box"), (), ()), "red_box cannot stand on mint_prism: it would slide"),
        ((("red_sphere", "red_box"), (), ()), "would roll off"),
        ((("beige_box",), (), ()), "'beige_box' is not COLOR_SHAPE"),
        ((("red_box",), ()), "3 stacks, the layout has 2"),
        (((), (), ()), "0 blocks; 1 to 14"),
        ((tuple(object_name(color, "box") for color in COLORS), (), ()), "0.63 m high"),
        (
            (tuple(f"{c}_box" for c in COLORS), ("red_cylinder",), ()),
            "15 blocks; 1 to 14",
        ),
        ((("red_box",), ("red_box",), ()), "one place only: red_box"),
    ],
)
def test_an_impossible_layout_of_a_scene_leaves_the_world_as_it_was(
    world: World, layout: tuple[tuple[str, ...], ...], reason: str
) -> None:
    there = (("red_box",), ("mint_prism",), ())
    world.reset(there, 3)
    poses = [world.block_pose(name) for name in world.names]
    with pytest.raises(LayoutError, match=reason):
        world.reset(layout, 3)
    assert [world.block_pose(name) for name in world.names] == poses
    assert true_scene_graph(world).stacks() == there
