# SPDX-License-Identifier: Apache-2.0
"""A picture in, a scene graph out.

    python examples/perceive_a_picture.py                          # renders one, with its depth
    python examples/perceive_a_picture.py scene.png labels.png     # yours, with its masks

With depth and a calibrated camera the blocks are found, and have poses. Without them the masks have
to be given, and the relations are left-relations.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from perception_node import (
    DEFAULT_WEIGHTS,
    Observation,
    Perception,
    PinholeCamera,
    draw_scene_graph,
    load_weights,
)
from sim_node import World, random_layout


def from_files(image: str, labels: str) -> Observation:
    """8-bit RGB, and instance labels as a one-channel image of the same size, 0 = none."""
    rgb = np.asarray(Image.open(image).convert("RGB"))
    return Observation(rgb, np.asarray(Image.open(labels)).astype(np.uint16))


def from_simulator(seed: int = 3) -> Observation:
    """What the simulated camera sees: colour and depth, and where the camera is."""
    with World() as world:
        world.reset(random_layout(seed, blocks=5), seed)
        frame, config = world.render(), world.config.camera
    camera = PinholeCamera(
        config.intrinsics, config.world_from_optical, config.width, config.height
    )
    return Observation(frame.rgb, depth=frame.depth, camera=camera)


def main(arguments: list[str], out: Path = Path("runs")) -> None:
    observation = from_files(*arguments) if arguments else from_simulator()
    seen = Perception(load_weights(DEFAULT_WEIGHTS)).perceive(observation)
    print(seen.status.name, seen.message)
    for relation in sorted(seen.graph.relations):
        print(" ", relation)
    picture = draw_scene_graph(observation.rgb, seen)
    out.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(out / "scene_graph.png")
    print("drawn into", out / "scene_graph.png")


if __name__ == "__main__":
    main(sys.argv[1:])
