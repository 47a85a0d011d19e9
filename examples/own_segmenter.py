# SPDX-License-Identifier: Apache-2.0
"""A segmenter of your own: blocks found by saturated colour alone.

Anything with this signature can be given to ``Perception``; in the project itself a segmenter is a
file in perception_node/segment/. This one is ten lines long and knows saturated blocks before a
grey table only.

    python examples/own_segmenter.py
"""

from __future__ import annotations

import cv2
import numpy as np

from perception_node import (
    DEFAULT_WEIGHTS,
    Observation,
    Perception,
    PinholeCamera,
    Segments,
    Volume,
    load_weights,
)
from sim_node import World, random_layout, true_scene_graph


def segment_by_colour(observation: Observation, _volume: Volume | None) -> Segments:
    """One segment for each connected region of one hue, wherever that is."""
    hue, saturation, _ = cv2.split(cv2.cvtColor(observation.rgb, cv2.COLOR_RGB2HSV))
    labels = np.zeros(hue.shape, np.uint16)
    coloured = saturation > 110
    for low in range(0, 180, 6):
        near = np.abs((hue.astype(int) - low + 90) % 180 - 90) <= 3
        count, parts = cv2.connectedComponents((coloured & near).astype(np.uint8))
        for part in range(1, count):
            if np.count_nonzero(parts == part) > 60:
                labels[parts == part] = labels.max() + 1
    return Segments.from_labels(labels)


def main(seed: int = 3) -> None:
    with World() as world:
        world.reset(random_layout(seed, blocks=4), seed)
        frame, config, truth = world.render(), world.config.camera, true_scene_graph(world)
    camera = PinholeCamera(
        config.intrinsics, config.world_from_optical, config.width, config.height
    )
    perception = Perception(load_weights(DEFAULT_WEIGHTS), segmenter=segment_by_colour)
    seen = perception.perceive(Observation(frame.rgb, None, frame.depth, camera))
    print(seen.status.name, seen.message)
    print("seen", sorted(map(str, seen.graph.relations)))
    print("truth", sorted(map(str, truth.relations)))


if __name__ == "__main__":
    main()
