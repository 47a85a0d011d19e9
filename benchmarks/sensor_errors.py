# SPDX-License-Identifier: Apache-2.0
"""How perception answers each kind of error of the camera: a table on the screen, for developing.

``tools/in_workspace python benchmarks/sensor_errors.py`` renders 20 scenes of 3 to 7 blocks (seeds
below 1000), damages each picture by ``sim_node.sensor``, interprets it with masks from each source,
and prints by error how many graphs were confident and right, confident and wrong, or refused, with
the sentence given most often. ``--only depth`` picks errors by what their names contain, and
``--masks rgbd`` a source; errors of labels are tried only where labels are heard.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from collections.abc import Mapping
from typing import Final

import numpy as np

from perception_node import (
    DEFAULT_WEIGHTS,
    Observation,
    Perception,
    PerceptionConfig,
    PinholeCamera,
    load_weights,
)
from perception_node.segment import SEGMENTATION_TOPIC, SEGMENTERS
from scene_graph import GraphStatus, SceneGraph
from sim_node import (
    ColorConfig,
    DepthConfig,
    Frame,
    SegmentationConfig,
    SensorConfig,
    World,
    random_layout,
    sense,
    true_scene_graph,
)
from sim_node.sensor.config import MILLIMETRES
from sim_node.sensor.depth import millimetres
from sim_node.sensor.segmentation import ERRORS

#: About what an RGB-D camera does that measures disparities over a short base line.
RGBD: Final = DepthConfig(
    noise=0.002,
    noise_correlation=1.0,
    edge_dropout=0.5,
    edge_width=2,
    dropout=0.01,
    step=0.001,
    encoding=MILLIMETRES,
)
DEPTHS: Final[Mapping[str, DepthConfig]] = {
    **{f"depth noise {sigma}": DepthConfig(noise=sigma) for sigma in (0.001, 0.002, 0.005, 0.01)},
    "depth noise 0.002, correlated 2 px": DepthConfig(noise=0.002, noise_correlation=2.0),
    "depth edge_dropout 0.5, width 2": DepthConfig(edge_dropout=0.5),
    "depth edge_dropout 1, width 1": DepthConfig(edge_dropout=1.0, edge_width=1),
    "depth edge_dropout 1, width 3": DepthConfig(edge_dropout=1.0, edge_width=3),
    **{f"depth dropout {share}": DepthConfig(dropout=share) for share in (0.01, 0.1, 0.3)},
    **{f"depth step {step}": DepthConfig(step=step) for step in (0.001, 0.003, 0.01)},
    "depth step 0.001, fixed": DepthConfig(step=0.001, step_grows=False),
    "depth no_depth nan": DepthConfig(no_depth="nan"),
    **{f"depth shift {right:g} px": DepthConfig(shift=(right, 0.0)) for right in (1.0, 2.0)},
    "depth in millimetres, read as metres": DepthConfig(encoding=MILLIMETRES),
    "depth as of an RGB-D camera": RGBD,
}
COLORS: Final[Mapping[str, ColorConfig]] = {
    **{f"color noise {sigma:g}": ColorConfig(noise=sigma) for sigma in (3.0, 10.0, 25.0)},
    **{f"color exposure {gain}": ColorConfig(exposure=gain) for gain in (0.2, 0.5, 1.5, 2.5)},
    **{f"color blur {sigma}": ColorConfig(blur=sigma) for sigma in (0.5, 1.0)},
    **{f"color jpeg {quality}": ColorConfig(jpeg_quality=quality) for quality in (95, 80)},
    "color cast warm": ColorConfig(cast=(1.15, 1.0, 0.75)),
    "color cast cold": ColorConfig(cast=(0.8, 1.0, 1.2)),
    "color cast strong": ColorConfig(cast=(1.4, 1.0, 0.5)),
}
STRENGTHS: Final[Mapping[str, tuple[int, ...]]] = {"speckled": (1, 5, 20), "shifted": (1, 2, 5)}
CONFIGS: Final[Mapping[str, SensorConfig]] = {
    "none": SensorConfig(),
    **{name: SensorConfig(depth=depth) for name, depth in DEPTHS.items()},
    **{name: SensorConfig(color=color) for name, color in COLORS.items()},
    **{
        f"segmentation {kind} {strength}": SensorConfig(
            segmentation=SegmentationConfig(kind, strength)
        )
        for kind in ERRORS
        for strength in STRENGTHS.get(kind, (1, 2))
    },
    "varied: RGB-D depth, boundary 1": SensorConfig(
        depth=RGBD, segmentation=SegmentationConfig("boundary", 1)
    ),
}
SCENES: Final = 20
FEWEST, MOST = 3, 7


def answer(perception: Perception, frame: Frame, config: SensorConfig, world: World) -> tuple:
    """The verdict, and the graph."""
    camera = world.config.camera
    depth = frame.depth
    if config.depth.encoding == MILLIMETRES:
        depth = (millimetres(depth) / 1000.0).astype(np.float32)
    pinhole = PinholeCamera(
        camera.intrinsics, camera.world_from_optical, camera.width, camera.height
    )
    seen = perception.perceive(Observation(frame.rgb, frame.labels, depth, pinhole))
    return seen.status, seen.message, seen.graph


def without_particulars(sentence: str) -> str:
    """A sentence without its names and numbers, to count it with others of its kind."""
    sentence = re.sub(r"\b\w+_(box|cylinder|sphere)(_\d+)?\b", "BLOCK", sentence)
    return re.sub(r"-?\d+(\.\d+)?", "N", sentence)


def report(name: str, source: str, answers: list[tuple[GraphStatus, str, bool]]) -> str:
    """One row of the table."""
    confident = [right for status, _, right in answers if status is GraphStatus.CONFIDENT]
    refused = [status for status, _, _ in answers if status is not GraphStatus.CONFIDENT]
    statuses = ", ".join(f"{n} {status.name}" for status, n in Counter(refused).most_common())
    sentences = Counter(without_particulars(text) for _, text, _ in answers if text)
    often = "; ".join(f"{n}x {text}" for text, n in sentences.most_common(2))
    right = sum(confident)
    return f"| {name} | {source} | {right} | {len(confident) - right} | {statuses} | {often} |"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="errors whose names contain this")
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--masks", action="append", choices=list(SEGMENTERS), help="from where")
    options = parser.parse_args()
    module = load_weights(DEFAULT_WEIGHTS)
    perceptions = {
        source: Perception(module, PerceptionConfig(mask_source=source))
        for source in options.masks or SEGMENTERS
    }
    configs = {name: config for name, config in CONFIGS.items() if options.only in name}
    answers: dict[tuple[str, str], list[tuple[GraphStatus, str, bool]]] = {
        (name, source): []
        for name, config in configs.items()
        for source in perceptions
        if source == SEGMENTATION_TOPIC or config.segmentation.is_exact
    }
    with World() as world:
        for seed in range(options.scenes):
            world.reset(random_layout(seed, FEWEST + seed % (MOST - FEWEST + 1)), seed)
            exact, truth = world.render(), true_scene_graph(world)
            for (name, source), rows in answers.items():
                config = configs[name]
                frame = sense(exact, config, (seed, 0, 0))
                status, message, graph = answer(perceptions[source], frame, config, world)
                rows.append((status, message, same(graph, truth)))
    print("| error | masks | right | wrong | refused | sentences |\n|---|---|---|---|---|---|")
    for (name, source), rows in answers.items():
        print(report(name, source, rows))
    return 0


def same(graph: SceneGraph, truth: SceneGraph) -> bool:
    """Whether all relations, the bases' and names included, are those of the truth."""
    return graph.relations == truth.relations


if __name__ == "__main__":
    raise SystemExit(main())
