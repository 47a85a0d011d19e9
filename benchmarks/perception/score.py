# SPDX-License-Identifier: Apache-2.0
"""What perception made of a set of pictures, counted."""

from __future__ import annotations

import re
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import yaml
from results_file import Row, wilson_interval

from perception.hidden_truth import is_partly_right
from perception.scenes import Drawn
from perception.sets import PictureSet
from perception.views import view_of
from perception_node import Perception, PerceptionConfig
from perception_node.visual_module.coordinates import Locator
from scene_graph import GraphStatus, SceneGraph, SceneObject
from sim_node import World, parse_scene, sense, true_scene_graph

#: Every set is held to no more than this share of graphs that are accepted and wrong.
ACCEPTED_WRONG = 0.001


@dataclass(frozen=True)
class Answer:
    """What was made of one picture.

    Attributes:
        right, confident: of the graph; one that says what blocks hide is right if that is so.
        status: its name.
        message: why it was refused.
        iou: of its blocks.
        seconds: that it took.
        errors: for each block that was named rightly in a confident graph: of the centre [mm], of
            the size [mm], of yaw [degrees], and of the centre in stated standard deviations.
        hides: whether it says that blocks hide others.
    """

    seed: int
    right: bool
    confident: bool
    status: str
    message: str
    iou: tuple[float, ...]
    seconds: float
    errors: tuple[tuple[float, float, float], ...] = ()
    hides: bool = False


def answer_of(
    drawn: Drawn, item: PictureSet, locator: Locator, world: World | None = None
) -> Answer:
    """What perception says of one picture.

    Args:
        world: to draw it in, where its scene is that of the plain world; None: one of its own.
    """
    if world is None:
        config = None if drawn.scene is None else parse_scene(yaml.safe_dump(dict(drawn.scene)))
        with World(config) as own:
            return answer_of(drawn, item, locator, own)
    world.reset(drawn.layout, drawn.seed)
    frame = sense(world.render(), item.sensor, (drawn.seed, 0, 0))
    truth = true_scene_graph(world)
    feet = tuple(place.position_world for place in truth.places)
    perception = Perception(
        locator, PerceptionConfig(mask_source=item.mask_source, stack_positions=feet)
    )
    view = view_of(world.config.camera, frame)
    start = time.perf_counter()
    seen = perception.perceive(view.observation(frame.rgb, frame.labels, frame.depth))
    seconds = time.perf_counter() - start
    hides = seen.status is GraphStatus.HIDDEN
    confident = hides or seen.status is GraphStatus.CONFIDENT
    right = seen.graph.relations == truth.relations
    if hides:
        right = is_partly_right(seen.graph, truth, frame, world.config.camera)
    return Answer(
        drawn.seed,
        right,
        confident,
        seen.status.name,
        seen.message,
        tuple(float(block.confidence) for block in seen.graph.objects if block.label),
        seconds,
        _errors(seen.graph, truth) if confident else (),
        hides,
    )


def _errors(seen: SceneGraph, truth: SceneGraph) -> tuple[tuple[float, float, float], ...]:
    true = {block.name: block for block in truth.objects}
    return tuple(_error(block, true[block.name]) for block in seen.objects if block.name in true)


def _error(seen: SceneObject, true: SceneObject) -> tuple[float, float, float]:
    """Of the centre [mm], of the size [mm], of yaw [degrees], for boxes up to a quarter turn."""
    centre = 1000.0 * float(np.linalg.norm(np.subtract(seen.position_world, true.position_world)))
    turn = _yaw(seen) - _yaw(true)
    quarters = round(turn / (np.pi / 2))
    size = np.array(seen.size)
    if quarters % 2:
        size[:2] = size[1::-1]
    yaw = abs(float(np.degrees(turn - quarters * np.pi / 2))) if seen.shape == "box" else 0.0
    return centre, 1000.0 * float(np.abs(size - true.size).max()), yaw


def _yaw(block: SceneObject) -> float:
    _, _, z, w = block.quaternion_world
    return float(2.0 * np.arctan2(z, w))


def rows_of(item: PictureSet, answers: Sequence[Answer]) -> list[Row]:
    """The rows of one set."""
    n = len(answers)
    right = sum(answer.right for answer in answers)
    accepted = sum(answer.right and answer.confident for answer in answers)
    wrong = sum(answer.confident and not answer.right for answer in answers)
    seconds = 1000.0 * np.array([answer.seconds for answer in answers])
    iou = [value for answer in answers for value in answer.iou]
    rows = [
        Row(item.what, "graph right", right / n, "", n, wilson_interval(right, n),
            None if item.graph is None else f">= {item.graph}", item.thesis[0]),
        Row(item.what, "accepted and right", accepted / n, "", n, wilson_interval(accepted, n),
            f">= {item.accepted}" if item.graph is not None else None),
        Row(item.what, "accepted and wrong", wrong / n, "", n, wilson_interval(wrong, n),
            f"<= {ACCEPTED_WRONG}"),
        Row(item.what, "IoU, mean", float(np.mean(iou)) if iou else 0.0, "", len(iou), None,
            None if item.iou is None else f">= {item.iou}", item.thesis[1]),
        Row(item.what, "picture to graph, median", float(np.median(seconds)), "ms", n,
            (float(seconds.min()), float(seconds.max()))),
    ]  # fmt: skip
    if hiding := sum(answer.hides for answer in answers):
        rows.append(Row(item.what, "of these with hidden places", hiding / n, "", n))
    errors = np.array([error for answer in answers for error in answer.errors])
    if not len(errors):
        return rows
    centre, _, yaw = errors.T
    worst = np.percentile(errors, 99, axis=0)
    centre_bound, size_bound = item.sizes or (None, None)
    median_bound, far_bound, yaw_bound = item.poses or (None, None, None)
    far = far_bound if centre_bound is None else centre_bound
    return [
        *rows,
        _error_row(item, "error of centres, median", float(np.median(centre)), median_bound, n),
        _error_row(item, "error of centres, 99th percentile", float(worst[0]), far, n),
        _error_row(item, "error of sizes, 99th percentile", float(worst[1]), size_bound, n),
        _error_row(item, "error of yaw, median", float(np.median(yaw)), yaw_bound, n, "°"),
    ]


def _error_row(
    item: PictureSet, metric: str, value: float, bound: float | None, n: int, unit: str = "mm"
) -> Row:
    required = None if bound is None else f"<= {bound:g}"
    return Row(item.what, metric, value, unit, n, required=required, note="of accepted graphs")


def refusals(answers: Sequence[Answer]) -> dict[str, int]:
    """How often what was said of graphs that were refused, without names and numbers."""
    return dict(
        Counter(
            f"{answer.status}: {_without_particulars(answer.message)}"
            for answer in answers
            if not answer.confident
        ).most_common()
    )


def _without_particulars(sentence: str) -> str:
    sentence = re.sub(r"\b\w+_(box|cylinder|sphere)(_\d+)?\b", "BLOCK", sentence)
    return re.sub(r"-?\d+(\.\d+)?", "N", sentence)
