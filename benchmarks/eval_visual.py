# SPDX-License-Identifier: Apache-2.0
"""``make eval-visual``: how often the scene graph is right on states that were never trained on.

Renders random states of 6 and 7 blocks (seeds from 1000), interprets each picture with the visual
module G and with the mask centroid in its place, and compares the whole graph, every relation with
bases, with the simulator's truth. The masks are then damaged in three ways and all is done again;
then the camera is turned about the scene. Writes ``benchmarks/results/visual.json``; ``QUICK=1``
uses 60 states of 6 blocks.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from results_file import Row, print_rows, quick, wilson_interval, write_result
from tqdm import tqdm

from perception_node import (
    DEFAULT_WEIGHTS,
    Locator,
    MaskCentroid,
    Observation,
    Perceived,
    Perception,
    PinholeCamera,
    Segments,
    load_weights,
)
from scene_graph import GraphStatus, Relation, format_stacks, up_relations
from sim_node.layouts import random_layout
from sim_node.scene import CameraConfig, SceneConfig
from sim_node.world import World

FIRST_SEED = 1000
#: Table 5.1, D_sim: accuracy and IoU by number of objects.
THESIS = {6: (0.867, 0.739), 7: (0.884, 0.714)}

#: Table 5.1: accuracy and IoU by the camera's turn [degrees].
VIEWS = {2: (0.882, 0.584), 10: (0.881, 0.561), 15: (0.843, 0.529)}
GOAL_IMAGE = "goal image, no depth"

Labels = NDArray[np.uint16]


@dataclass
class Tally:
    """What one method made of one set of pictures."""

    right: list[bool] = field(default_factory=list)
    confident: list[bool] = field(default_factory=list)
    wrong_and_confident: int = 0
    iou: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    position_errors: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)

    def add(self, perceived: Perceived, truth: frozenset[Relation], what: str) -> None:
        right = perceived.graph.relations == truth
        confident = perceived.status is GraphStatus.CONFIDENT
        self.right.append(right)
        self.confident.append(confident)
        self.wrong_and_confident += confident and not right
        self.iou += [item.confidence for item in perceived.graph.objects]
        if not right:
            self.failures.append(f"{what}: {perceived.status.name} {perceived.message}")


def eroded(labels: Labels, _: np.random.Generator) -> Labels:
    """Every mask loses two pixels all around."""
    result = np.zeros_like(labels)
    for label in np.unique(labels[labels > 0]):
        mask = cv2.erode((labels == label).astype(np.uint8), np.ones((5, 5), np.uint8))
        result[mask > 0] = label
    return result


def speckled(labels: Labels, rng: np.random.Generator) -> Labels:
    """Half of the pixels of every mask are lost, and three in a hundred elsewhere get a label."""
    found = np.unique(labels[labels > 0])
    result = np.where(rng.random(labels.shape) < 0.5, 0, labels)
    specks = (labels == 0) & (rng.random(labels.shape) < 0.03)
    result[specks] = rng.choice(found, np.count_nonzero(specks))
    return result.astype(np.uint16)


def half_lost(labels: Labels, rng: np.random.Generator) -> Labels:
    """Of every mask up to half is lost on one side."""
    result = labels.copy()
    for label in np.unique(labels[labels > 0]):
        rows, columns = np.nonzero(labels == label)
        along = [rows, -rows, columns, -columns][rng.integers(4)]
        lost = along < along.min() + rng.uniform(0.0, 0.5) * np.ptp(along)
        result[rows[lost], columns[lost]] = 0
    return result


DAMAGE: dict[str, Callable[[Labels, np.random.Generator], Labels]] = {
    "masks eroded by 2 px": eroded,
    "masks speckled": speckled,
    "masks half lost": half_lost,
}


Tallies = dict[tuple[str, str], Tally]


def masks_as_they_are(observation: Observation, _volume: object) -> Segments:
    """The given labels, damages and all: what is measured here is what is made of masks."""
    assert observation.labels is not None
    return Segments.from_labels(observation.labels)


def evaluate(
    world: World,
    blocks: int,
    count: int,
    methods: dict[str, Perception],
    damages: dict[str, Callable[[Labels, np.random.Generator], Labels]],
) -> Tallies:
    """Tallies by (damage or "", method), for ``count`` random states."""
    config = world.config.camera
    camera = PinholeCamera(
        config.intrinsics, config.world_from_optical, config.width, config.height
    )
    tallies: Tallies = {}
    for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc=f"{blocks} blocks"):
        layout = random_layout(seed, blocks)
        world.reset(layout, seed)
        frame, truth = world.render(), up_relations(layout)
        variants = {"": frame.labels}
        for name, damage in damages.items():
            variants[name] = damage(frame.labels, np.random.default_rng(seed))
        for name, labels in variants.items():
            for method, perception in methods.items():
                tally = tallies.setdefault((name, method), Tally())
                observation = Observation(frame.rgb, labels, frame.depth, camera)
                start = time.perf_counter()
                perceived = perception.perceive(observation)
                tally.seconds.append(time.perf_counter() - start)
                tally.add(perceived, truth, f"seed {seed} {format_stacks(layout)}")
                if not name:
                    tally.position_errors += position_errors(world, perceived)
        tally = tallies.setdefault((GOAL_IMAGE, "G"), Tally())
        perceived = methods["G"].perceive(Observation(frame.rgb, frame.labels, None, camera))
        tally.add(perceived, truth, f"seed {seed} {format_stacks(layout)}")
    return tallies


def position_errors(world: World, perceived: Perceived) -> list[float]:
    """Distances of the measured from the true centres of the blocks named rightly [m]."""
    found = perceived.graph.objects
    return [
        float(np.linalg.norm(np.subtract(item.position_world, world.block_pose(item.name)[0])))
        for item in found
        if item.name in world.names
    ]


def turned_camera(degrees: float) -> CameraConfig:
    """The simulator's camera, turned about the upright axis through what it looks at."""
    camera = CameraConfig()
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    target = np.array(camera.target_world)
    offset = np.array(camera.position_world) - target
    x, y = turn @ offset[:2] + target[:2]
    return replace(camera, position_world=(float(x), float(y), camera.position_world[2]))


def view_rows(count: int, perception: Perception) -> list[Row]:
    """Accuracy and IoU from other camera views, whose extrinsics are known (Table 5.1)."""
    rows = []
    for degrees, (accuracy, iou) in VIEWS.items():
        with World(replace(SceneConfig(), cameras=(turned_camera(degrees),))) as world:
            tally = evaluate(world, 6, count, {"G": perception}, {})["", "G"]
        name, n, right = f"6 objects, camera view +{degrees}°", len(tally.right), sum(tally.right)
        rows += [
            Row(
                name,
                "scene graph accuracy, G",
                right / n,
                "",
                n,
                wilson_interval(right, n),
                thesis=accuracy,
            ),
            Row(name, "IoU, mean", float(np.mean(tally.iou)), "", len(tally.iou), thesis=iou),
            Row(name, "wrong graphs published as confident", tally.wrong_and_confident, "", n),
        ]
    return rows


def rows_of(blocks: int, tallies: Tallies) -> list[Row]:
    """The rows of one number of blocks."""
    rows = []
    for (damage, method), tally in tallies.items():
        plain = not damage and method == "G"
        name = f"{blocks} objects, 3 stacks" + (f", {damage}" if damage else "")
        n, successes = len(tally.right), sum(tally.right)
        rows.append(
            Row(
                set=name,
                metric=f"scene graph accuracy, {method}",
                value=successes / n,
                unit="",
                n=n,
                spread=wilson_interval(successes, n),
                required=">= 0.98" if plain and blocks == 6 else None,
                thesis=THESIS[blocks][0] if plain else None,
            )
        )
        if method == "G":
            rows.append(
                Row(name, "wrong graphs published as confident", tally.wrong_and_confident, "", n)
            )
        if not plain:
            continue
        rejected = n - sum(tally.confident)
        spread = (float(np.min(tally.iou)), float(np.max(tally.iou)))
        errors = 1000.0 * np.array(tally.position_errors)
        milliseconds = 1000.0 * np.array(tally.seconds)
        rows += [
            Row(name, "right graphs not confident", float(rejected), "", n),
            Row(
                name,
                "IoU, mean",
                float(np.mean(tally.iou)),
                "",
                len(tally.iou),
                spread,
                thesis=THESIS[blocks][1],
            ),
            Row(
                name,
                "position error of block centres, median",
                float(np.median(errors)),
                "mm",
                len(errors),
                (float(errors.min()), float(errors.max())),
            ),
            Row(
                name,
                "image to graph, median",
                float(np.median(milliseconds)),
                "ms",
                n,
                (float(milliseconds.min()), float(milliseconds.max())),
                required="<= 100",
            ),
        ]
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, help="states of 6 blocks; 7 blocks: two fifths of it")
    parser.add_argument("--weights", type=Path, default=DEFAULT_WEIGHTS)
    options = parser.parse_args()
    count = options.n or (60 if quick() else 500)
    torch.set_num_threads(1)
    locators: dict[str, Locator] = {
        "G": load_weights(options.weights),
        "mask centroid": MaskCentroid(),
        "centroid of the largest part": MaskCentroid(largest_part_only=True),
    }
    methods = {
        name: Perception(locator, segmenter=masks_as_they_are) for name, locator in locators.items()
    }
    start = time.perf_counter()
    rows: list[Row] = []
    failures: dict[str, list[str]] = {}
    with World() as world:
        for blocks, states in ((6, count), (7, max(1, 2 * count // 5))):
            tallies = evaluate(world, blocks, states, methods, DAMAGE)
            rows += rows_of(blocks, tallies)
            for (damage, method), tally in tallies.items():
                if tally.failures:
                    failures[f"{blocks} blocks, {damage or 'undamaged'}, {method}"] = (
                        tally.failures[:20]
                    )
    rows += view_rows(max(1, 2 * count // 5), methods["G"])
    print_rows(rows)
    details = {"weights": str(options.weights.name), "failures": failures}
    path = write_result("visual", "make eval-visual", rows, time.perf_counter() - start, details)
    print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
