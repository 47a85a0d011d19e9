# SPDX-License-Identifier: Apache-2.0
"""``make fit-name-sets``: the threshold of sets of colours, by split conformal prediction.

Takes the scenes with paint between two colours by seeds from 100 to 999; ``make eval-perception``
measures the coverage by seeds from 1000. Writes ``weights/name_sets.json`` of perception_node.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import torch
from perception.scenes import FIRST_SEED, Drawn, between_colors
from perception.views import view_of
from results_file import source_commit
from tqdm import tqdm

from perception_node import Perception, load_weights
from perception_node.light import explain_colors
from perception_node.name_sets import PARAMETERS, conformal_threshold, in_doubt
from perception_node.names import color_before, mean_colors
from scene_graph import COLORS, GraphStatus
from sim_node import ColorConfig, SensorConfig, sense, true_scene_graph

#: Seeds of the scenes, before those of the benchmarks.
SEEDS = range(100, 1000)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--coverage", type=float, default=0.95, help="share of scenes, at least")
    parser.add_argument("--n", type=int, default=len(SEEDS), help="scenes")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()
    seeds = SEEDS[: options.n]
    chunks = [seeds[first : first + 25] for first in range(0, len(seeds), 25)]
    found: list[float | None] = []
    with ProcessPoolExecutor(
        options.jobs, initializer=torch.set_num_threads, initargs=(1,)
    ) as pool:
        for part in tqdm(pool.map(_scores, chunks), total=len(chunks)):
            found += part
    scores = [score for score in found if score is not None]
    threshold = conformal_threshold(scores, options.coverage)
    content = {
        "command": f"make fit-name-sets COVERAGE={options.coverage:g} N={options.n}",
        "commit": source_commit(),
        "scenes": len(found),
        "scenes that can be read": len(scores),
        "confident and wrong": sum(math.isinf(score) for score in scores),
        "coverage": options.coverage,
        "threshold": round(threshold, 3),
    }
    print(json.dumps(content, indent=1))
    if math.isinf(threshold):
        print("nothing is written: no threshold reaches this coverage")
        return 1
    PARAMETERS.write_text(json.dumps(content, indent=1) + "\n")
    return 0


def _scores(seeds: Iterable[int]) -> list[float | None]:
    """In a process of its own: how badly the right colours of scenes fit, see ``name_sets``."""
    draw, perception = between_colors(), Perception(load_weights())
    return [_score(draw(seed - FIRST_SEED), perception) for seed in seeds]


def _score(drawn: Drawn, perception: Perception) -> float | None:
    """[ΔE]; None where neither a graph nor a set of them is published, whatever the threshold."""
    with drawn.world() as world:
        world.reset(drawn.layout, drawn.seed)
        exact, truth = world.render(), true_scene_graph(world)
        colors_of = {world.label(name): world.block(name).color for name in world.names}
        camera = world.config.camera
    assert drawn.light is not None
    sensor = SensorConfig(color=ColorConfig(exposure=drawn.light[0], cast=drawn.light[1]))
    frame = sense(exact, sensor, (drawn.seed, 0, 0))
    seen = perception.perceive(view_of(camera, frame).observation(frame.rgb, None, frame.depth))
    if seen.status is GraphStatus.CONFIDENT:
        return 0.0 if seen.graph.relations == truth.relations else math.inf
    if seen.segments is None or len(seen.segments) != len(colors_of):
        return None
    parts = [segment.part for segment in seen.segments]
    colors, table = mean_colors(frame.rgb, parts), color_before(frame.rgb, parts)
    fit = explain_colors(colors, table)
    doubtful = in_doubt(fit, colors, table)
    if doubtful is None:
        return None
    worst = 0.0
    for index, part in enumerate(parts):
        true = colors_of[int(np.bincount(exact.labels[part]).argmax())]
        if doubtful[index]:
            worst = max(worst, float(fit.gaps[index][list(COLORS).index(true)]))
        elif fit.names[index] != true:
            return math.inf
    return worst


if __name__ == "__main__":
    raise SystemExit(main())
