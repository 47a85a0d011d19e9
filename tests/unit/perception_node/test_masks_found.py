# SPDX-License-Identifier: Apache-2.0
"""Blocks are found in colour and depth alone; the simulator's own labels are the oracle."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from seen_worlds import TOWERS, camera_of, move_hand, observe, put

from perception_node import Observation
from perception_node.alignment import aligned
from perception_node.errors import BadImageError
from perception_node.segment import Segments, Volume
from perception_node.segment.rgbd import find_in_rgbd
from scene_graph import ROW_OF_THREE
from sim_node.camera import Frame
from sim_node.generators import generate_layout
from sim_node.layouts import random_layout
from sim_node.scene import load_scene, parse_scene
from sim_node.sensor import ColorConfig, DepthConfig, SensorConfig, sense
from sim_node.world import World

VOLUME = Volume.over(np.array(ROW_OF_THREE), 0.36)
CAMERAS = {
    "exact": SensorConfig(),
    "noise of depth": SensorConfig(depth=DepthConfig(noise=0.0015)),
    "drop-outs": SensorConfig(depth=DepthConfig(edge_dropout=0.5, dropout=0.03, no_depth="nan")),
    "all of it": SensorConfig(
        depth=DepthConfig(noise=0.0015, noise_correlation=1.0, edge_dropout=0.5, dropout=0.03),
        color=ColorConfig(noise=5.0),
    ),
    "a third of the light": SensorConfig(color=ColorConfig(exposure=0.33)),
}


def find(world: World, frame: Frame, volume: Volume | None = VOLUME) -> Segments:
    observation = replace(observe(world, frame), labels=None)
    if volume is not None and (box := volume.seen_by(camera_of(world))) is not None:
        observation = aligned(observation, box)
    return find_in_rgbd(observation, volume)


def overlaps(labels: NDArray[np.uint16], found: Segments) -> list[float]:
    """For each true block the IoU of what was found best."""
    best = []
    for label in np.unique(labels[labels > 0]):
        true = labels == label
        shares = [
            np.count_nonzero(true & segment.mask) / np.count_nonzero(true | segment.mask)
            for segment in found
        ]
        best.append(max(shares, default=0.0))
    return best


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
@pytest.mark.parametrize("seed", range(700, 708))
def test_every_block_of_a_random_scene_is_found(
    world: World, seed: int, camera: SensorConfig
) -> None:
    layout = random_layout(seed, 3 + seed % 5)
    world.reset(layout, seed)
    frame = world.render()
    found = find(world, sense(frame, camera, (seed, 0, 0)))
    assert min(overlaps(frame.labels, found)) >= 0.85
    if camera.is_exact:
        assert len(found) == sum(map(len, layout))


@pytest.mark.parametrize("name", ["mixed_sizes", "five_places", "two_cameras"])
def test_blocks_of_other_scenes_are_found_as_well(name: str) -> None:
    scene = load_scene(name)
    volume = Volume.over(np.array(scene.stack_positions), 0.36)
    with World(scene) as world:
        for seed in range(700, 704):
            layout = generate_layout(scene, "uniform", seed, 6)
            world.reset(layout, seed)
            frame = world.render()
            found = find(world, frame, volume)
            assert len(found) == 6 and min(overlaps(frame.labels, found)) >= 0.85


LIT_ALIKE = """
places: [[0.5185, -0.2006], [0.5545, -0.0266]]
blocks:
  named:
    red_cylinder: {size: [0.0335, 0.0335, 0.0659]}
    orange_cylinder: {size: [0.037, 0.037, 0.0403]}
    yellow_box: {size: [0.0502, 0.0325, 0.0639]}
cameras:
  - {position: [1.4425, -0.3711, 0.4], target: [0.5513, -0.0423, 0.155], vertical_fov: 0.52}
yaw_jitter: 0.785
"""


def test_a_block_is_one_whose_lid_is_as_bright_as_its_front() -> None:
    volume = Volume.over(np.array([(0.5185, -0.2006, 0.0), (0.5545, -0.0266, 0.0)]), 0.36)
    with World(parse_scene(LIT_ALIKE)) as world:
        world.reset((("orange_cylinder", "red_cylinder"), ("yellow_box",)), 5_000_034)
        frame = world.render()
        found = find(world, frame, volume)
    assert len(found) == 3
    assert min(overlaps(frame.labels, found)) >= 0.85


@pytest.mark.parametrize("position", [(0.5, 0.0, 0.15), (0.5, -0.15, 0.3), (0.6, 0.1, 0.2)])
def test_the_arm_is_no_block(world: World, position: tuple[float, float, float]) -> None:
    world.reset(TOWERS)
    move_hand(world, position)
    frame = world.render()
    for segment in find(world, frame):
        assert np.mean(frame.labels[segment.mask] > 0) > 0.9


def test_two_blocks_of_different_colours_that_touch_are_two(world: World) -> None:
    world.reset((("red_box",), ("blue_box",), ()))
    red, blue = (np.array(world.block_pose(name)[0]) for name in ("red_box", "blue_box"))
    put(world, "red_box", (0.0, 0.0, 0.0))
    put(world, "blue_box", tuple(red - blue + (0.0, 0.045, 0.0)))
    frame = world.render()
    found = find(world, frame)
    assert len(found) == 2 and min(overlaps(frame.labels, found)) >= 0.85


def test_an_empty_table_has_none(world: World) -> None:
    world.reset((("red_box",), (), ()))
    put(world, "red_box", (-3.0, 0.0, 5.0))
    frame = world.render()
    assert not frame.labels.any()
    assert len(find(world, frame)) == 0


def test_a_camera_that_looks_elsewhere_finds_none(world: World) -> None:
    world.reset(TOWERS)
    camera = camera_of(world)
    away = camera.world_from_optical.copy()
    away[:3, [0, 2]] *= -1.0
    observation = replace(observe(world), camera=replace(camera, world_from_optical=away))
    assert len(find_in_rgbd(observation, VOLUME)) == 0


@pytest.mark.parametrize("missing", ["depth", "camera"])
def test_without_depth_or_camera_the_sentence_says_what_to_do(world: World, missing: str) -> None:
    world.reset(TOWERS)
    observation: Observation = replace(observe(world), **{missing: None})
    with pytest.raises(BadImageError, match="without depth and camera; publish both, or set mask"):
        find_in_rgbd(observation, VOLUME)


def test_where_the_places_are_unknown_the_sentence_says_what_to_do(world: World) -> None:
    world.reset(TOWERS)
    with pytest.raises(BadImageError, match="the places are unknown; set stack_positions, or"):
        find(world, world.render(), None)


@pytest.mark.parametrize("name", [name for stack in TOWERS for name in stack])
def test_a_block_that_depth_does_not_show_is_not_overlooked(world: World, name: str) -> None:
    world.reset(TOWERS)
    frame = world.render()
    mine = frame.labels == world.label(name)
    with pytest.raises(BadImageError, match="has no depth, so it is not known whether it is a bl"):
        find(world, replace(frame, depth=np.where(mine, 0.0, frame.depth)))
