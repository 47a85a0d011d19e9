# SPDX-License-Identifier: Apache-2.0
"""What perception makes of scenes that differ from the usual one, as far as it goes today."""

from __future__ import annotations

import pytest
from seen_worlds import camera_of

from perception_node import Observation, Perception, PerceptionConfig, load_weights
from scene_graph import GraphStatus
from sim_node.generators import generate_layout
from sim_node.scene import SceneConfig, load_scene, parse_scene
from sim_node.world import World

WEIGHTS = load_weights()
SCENES = {
    "five places": load_scene("five_places"),
    "a wall": load_scene("wall"),
    "another light": load_scene("two_cameras"),
    "sizes from 4 to 5 cm": parse_scene("blocks: {size: [0.04, 0.05]}"),
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_scenes_near_to_the_usual_one_are_read_truly_and_confidently(scene: SceneConfig) -> None:
    config = PerceptionConfig(stack_positions=scene.stack_positions)
    perception = Perception(WEIGHTS, config)
    with World(scene) as world:
        for seed in range(3):
            layout = generate_layout(scene, "uniform", seed, 6)
            world.reset(layout, seed)
            frame = world.render()
            seen = perception.perceive(
                Observation(frame.rgb, frame.labels, frame.depth, camera_of(world))
            )
            assert seen.status is GraphStatus.CONFIDENT, seen.message
            assert seen.graph.stacks() == layout
            for item in seen.graph.objects:
                assert item.size == pytest.approx(world.block(item.name).size, abs=5e-3)
                where, _ = world.block_pose(item.name)
                assert item.position_world == pytest.approx(where, abs=4e-3)
