# SPDX-License-Identifier: Apache-2.0
"""What perception made of a set of pictures, counted."""

from __future__ import annotations

import functools
import itertools
import re
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from results_file import Row, wilson_interval

from perception.color_clusters import find_by_color
from perception.damages import Shot
from perception.earlier import earlier_state, on_the_way, seen_frozen
from perception.found_truth import on_found_places, place_errors
from perception.hidden_truth import is_partly_right
from perception.readings import reading_rows, relations_of
from perception.scenes import Drawn
from perception.sets import PictureSet
from perception.views import view_of
from perception_node import (
    MaskCentroid,
    Observation,
    Perceived,
    Perception,
    PerceptionConfig,
    Segmenter,
)
from perception_node.continuity import FROZEN_COLORS
from perception_node.joined_views import JoinedViews
from perception_node.segment import RGB
from perception_node.visual_module.coordinates import Locator
from scene_graph import UNKNOWN, GraphStatus, Relation, SceneGraph, SceneObject
from sim_node import World, sense, true_scene_graph
from sim_node.scene.cameras import FIRST

#: Every set is held to no more than this share of graphs that are accepted and wrong.
ACCEPTED_WRONG = 0.001
#: What finds coordinates in place of the visual module, by the name of its row.
BASELINES: Final[Mapping[str, Locator]] = {
    "mask centroid": MaskCentroid(),
    "largest part's centroid": MaskCentroid(largest_part_only=True),
}
#: What finds blocks in colour in place of the network.
SEGMENTERS: Final[Mapping[str, Segmenter]] = {"clusters of colours": find_by_color}


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
        named: of each block its true colour and shape, and those seen, empty where it was not.
        probability, evidence: of :class:`Perceived`.
        baselines: whether the graph is right with each of :data:`BASELINES`.
        hides: whether it says that blocks hide others.
        readings: how many graphs it may be, if it is accepted or in doubt about some names.
        covered: whether the right one is among them.
        place_errors: of places that were found in a confident graph, where stacks stand [mm].
    """

    seed: int
    right: bool
    confident: bool
    status: str
    message: str
    iou: tuple[float, ...]
    seconds: float
    errors: tuple[tuple[float, float, float], ...] = ()
    named: tuple[tuple[str, str, str, str], ...] = ()
    baselines: tuple[bool, ...] = ()
    probability: float = 0.0
    evidence: tuple[float, ...] = ()
    hides: bool = False
    readings: int = 0
    covered: bool = False
    place_errors: tuple[float, ...] = ()


def answer_of(drawn: Drawn, item: PictureSet, locator: Locator, world: World) -> Answer:
    """What perception says of one picture.

    Args:
        world: of its scene.
    """
    world.reset(drawn.layout, drawn.seed)
    exact, truth = world.render(), true_scene_graph(world)
    sensor = item.sensor
    if drawn.light is not None:
        color = replace(sensor.color, exposure=drawn.light[0], cast=drawn.light[1])
        sensor = replace(sensor, color=color)
    frame = sense(exact, sensor, (drawn.seed, 0, 0))
    true_blocks = _true_blocks(world) if item.names or item.shapes else {}
    view = view_of(world.config.camera, frame)
    alone = item.mask_source == RGB
    observation = view.observation(
        frame.rgb, None if alone else frame.labels, None if alone else frame.depth
    )
    others = {}
    for number, camera in list(enumerate(world.config.cameras))[1 : item.cameras]:
        taken = sense(world.render(number), sensor, (drawn.seed, number, 0))
        others[camera.name] = view_of(camera, taken).observation(taken.rgb, None, taken.depth)
    if item.damage is not None:
        rng = np.random.default_rng([drawn.seed, 13])
        earlier = functools.partial(earlier_state, world, drawn)
        observation = item.damage(observation, Shot(exact.labels, earlier, rng))
    answer, seen = answer_to(drawn.seed, observation, truth, item, locator, others)
    if item.after and seen_frozen(earlier(), on_the_way(world, drawn), observation):
        status = GraphStatus.BAD_IMAGE.name
        answer = replace(answer, confident=False, status=status, message=FROZEN_COLORS, readings=0)
    if answer.hides:
        right = is_partly_right(seen.graph, truth, frame, world.config.camera)
        answer = replace(answer, right=right)
    return replace(answer, named=_named(seen, exact.labels, true_blocks))


def answer_to(
    seed: int,
    observation: Observation,
    truth: SceneGraph,
    item: PictureSet,
    locator: Locator,
    others: Mapping[str, Observation] | None = None,
) -> tuple[Answer, Perceived]:
    """What perception says of a picture, wherever it comes from.

    Blocks by name are left out, and where blocks hide others whether that is right.

    Args:
        others: what other cameras see, by their names.
    """
    config = PerceptionConfig(
        mask_source=item.mask_source,
        stack_positions=tuple(place.position_world for place in truth.places),
    )
    right: frozenset[Relation] | None = truth.relations
    if item.found is not None:
        search = replace(config.search, count=item.found)
        config = replace(config, stack_positions=(), search=search)
    perception = Perception(locator, config)
    joined = JoinedViews(perception, FIRST)
    start = time.perf_counter()
    if others:
        seen = joined.perceive({FIRST: observation, **others})
    elif item.found is None:
        seen = perception.perceive(observation)
    else:
        _, seen = perception.find_places(observation)
    seconds = time.perf_counter() - start
    if item.found is not None:
        right = on_found_places(truth, seen.graph)
    baselines = [
        other.perceive(observation).graph.relations
        for other in _baselines(item, perception).values()
    ]
    hides = seen.status is GraphStatus.HIDDEN
    confident = hides or seen.status is GraphStatus.CONFIDENT
    doubtful = seen.status is GraphStatus.DOUBTFUL
    readings = relations_of(seen.graph) if doubtful else [seen.graph.relations]
    answer = Answer(
        seed,
        seen.graph.relations == right,
        confident,
        seen.status.name,
        seen.message,
        tuple(float(block.confidence) for block in seen.graph.objects if block.label),
        seconds,
        _errors(seen.graph, truth) if confident and item.damage is None else (),
        baselines=tuple(other == truth.relations for other in baselines),
        probability=seen.probability,
        evidence=seen.evidence,
        hides=hides,
        readings=len(readings) if confident or doubtful else 0,
        covered=right in readings,
        place_errors=place_errors(truth, seen.graph)
        if confident and item.found is not None
        else (),
    )
    return answer, seen


def _baselines(item: PictureSet, ours: Perception) -> dict[str, Perception]:
    """What is compared with ours on a set, by name."""
    if not item.baselines:
        return {}
    if item.mask_source == RGB:
        return {
            name: Perception(ours.locator, ours.config, segmenter)
            for name, segmenter in SEGMENTERS.items()
        }
    return {name: Perception(locator, ours.config) for name, locator in BASELINES.items()}


def answers_of(item: PictureSet, locator: Locator, numbers: Iterable[int]) -> Iterator[Answer]:
    """What perception says of some pictures of a set; each world is built once for those in a row
    that have it."""
    drawn = [item.draw(number) for number in numbers]
    for _, group in itertools.groupby(drawn, lambda entry: entry.scene):
        entries = list(group)
        with entries[0].world() as world:
            yield from (answer_of(entry, item, locator, world) for entry in entries)


def _true_blocks(world: World) -> dict[int, tuple[str, str]]:
    """Colour and shape of each block by its label."""
    blocks = {world.label(name): world.block(name) for name in world.names}
    return {label: (block.color, block.shape) for label, block in blocks.items()}


def _named(
    seen: Perceived, labels: NDArray[np.uint16], blocks: Mapping[int, tuple[str, str]]
) -> tuple[tuple[str, str, str, str], ...]:
    """What each block is, and what the object is called that has most of its pixels."""
    found = {}
    for item in seen.graph.objects if seen.segments is not None else ():
        assert seen.segments is not None
        inside = labels[seen.segments.label_image == item.label]
        if len(inside):  # what lies is not among the segments
            found[int(np.bincount(inside).argmax())] = (item.color, item.shape)
    return tuple((*block, *found.get(label, ("", ""))) for label, block in blocks.items())


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
    refused = sum(not answer.confident for answer in answers)
    published = [(answer.readings, answer.covered) for answer in answers]
    rows = [
        Row(item.what, "graph right", right / n, "", n, wilson_interval(right, n),
            None if item.graph is None else f">= {item.graph}", item.thesis[0], item.note),
        *_baseline_rows(item, answers, right / n),
        Row(item.what, "accepted and right", accepted / n, "", n, wilson_interval(accepted, n),
            f">= {item.accepted}" if item.graph is not None else None),
        Row(item.what, "accepted and wrong", wrong / n, "", n, wilson_interval(wrong, n),
            f"<= {ACCEPTED_WRONG}"),
        Row(item.what, "refused with a sentence",
            sum(not answer.confident and bool(answer.message) for answer in answers)
            / max(1, refused), "", refused, None, "== 1.0" if refused else None),
        *_name_rows(item, answers),
        *reading_rows(item.what, published if item.between else []),
        Row(item.what, "IoU, mean", float(np.mean(iou)) if iou else 0.0, "", len(iou), None,
            None if item.iou is None else f">= {item.iou}", item.thesis[1]),
        Row(item.what, "picture to graph, median", float(np.median(seconds)), "ms", n,
            (float(seconds.min()), float(seconds.max()))),
    ]  # fmt: skip
    if item.cameras:
        whole = sum(answer.right and answer.status == "CONFIDENT" for answer in answers)
        rows.append(
            Row(item.what, "right, and nothing hidden", whole / n, "", n, wilson_interval(whole, n))
        )
    if hiding := sum(answer.hides for answer in answers):
        rows.append(Row(item.what, "of these with hidden places", hiding / n, "", n))
    if off := [error for answer in answers for error in answer.place_errors]:
        rows += [
            _error_row(item, "error of places, median", float(np.median(off)), None, n),
            _error_row(item, "error of places, 99th percentile", float(np.percentile(off, 99)),
                       None, n),
        ]  # fmt: skip
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


def _baseline_rows(item: PictureSet, answers: Sequence[Answer], ours: float) -> list[Row]:
    if not item.baselines:
        return []
    n = len(answers)
    alone = item.mask_source == RGB
    names = tuple(SEGMENTERS if alone else BASELINES)
    rights = [sum(answer.baselines[index] for answer in answers) for index in range(len(names))]
    best = max(rights) / n
    above = names[0] if alone else "the better centroid"
    return [
        *(Row(item.what, f"graph right, {name}", right / n, "", n, wilson_interval(right, n))
          for name, right in zip(names, rights)),
        Row(item.what, f"graph right, above {above} by", ours - best, "", n),
    ]  # fmt: skip


def _name_rows(item: PictureSet, answers: Sequence[Answer]) -> list[Row]:
    blocks = [(answer.confident, *block) for answer in answers for block in answer.named]
    n, rows = len(blocks), []
    if item.names is not None:
        wrong = sum(
            confident and seen not in ("", UNKNOWN, color)
            for confident, color, _, seen, _ in blocks
        )
        unnamed = sum(seen in ("", UNKNOWN) for _, _, _, seen, _ in blocks)
        rows += [
            Row(item.what, "colours wrong with confidence", wrong / n, "", n,
                wilson_interval(wrong, n), f"<= {item.names[0]}"),
            Row(item.what, "colours not named", unnamed / n, "", n,
                wilson_interval(unnamed, n), f"<= {item.names[1]}"),
        ]  # fmt: skip
    if item.shapes is not None:
        right = sum(shape == seen for _, _, shape, _, seen in blocks)
        rows.append(
            Row(item.what, "shapes right", right / n, "", n, wilson_interval(right, n),
                f">= {item.shapes}", 0.97)
        )  # fmt: skip
    return rows


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


#: Graphs are sorted by their probability into so many groups of equal size.
_GROUPS: Final = 10


def confidence_rows(seen: Sequence[tuple[PictureSet, Answer]]) -> list[Row]:
    """How well the probability of a graph is calibrated, and what it is good for."""
    told = [(item, answer) for item, answer in seen if item.told and answer.evidence]
    if not told:
        return []
    stated = np.array([answer.probability for _, answer in told])
    right = np.array([answer.right for _, answer in told])
    error = calibration_error(stated, right)
    what, n = "probability of a graph, all sets whose damage can be seen", len(told)
    rows = [Row(what, "calibration error", error, "", n, required="<= 0.02")]
    wrong = stated[~right & np.array([item.damage is None for item, _ in told])]
    threshold = float(wrong.max(initial=0.0))
    ours = [answer for item, answer in told if item.name in ("six", "seven")]
    if ours:
        rejected = sum(answer.probability <= threshold for answer in ours) / len(ours)
        rows.append(
            Row("D_sim, 6 and 7 objects", "rejected at 0 wrong accepted in any undamaged set",
                rejected, "", len(ours), required="<= 0.02", thesis=0.047,
                note=f"{len(wrong)} wrong graphs")
        )  # fmt: skip
    return rows


def calibration_error(stated: NDArray[np.float64], right: NDArray[np.bool_]) -> float:
    """Mean distance of stated probabilities from how often it is so, in groups of equal size.

    Args:
        stated, right: shape (N,).
    """
    order = np.argsort(stated, kind="stable")
    groups = [group for group in np.array_split(order, _GROUPS) if len(group)]
    off = [len(group) * abs(stated[group].mean() - right[group].mean()) for group in groups]
    return float(sum(off) / len(stated))
