# SPDX-License-Identifier: Apache-2.0
"""What perception makes of one picture, beside the truth."""

from __future__ import annotations

import functools
import itertools
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception.arm import arm_problem, joint_states
from perception.color_clusters import find_by_color
from perception.damages import Shot
from perception.earlier import earlier_state, on_the_way, seen_frozen
from perception.found_truth import on_found_places, place_errors
from perception.hidden_truth import is_partly_right
from perception.readings import relations_of
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
from scene_graph import GraphStatus, Relation, SceneGraph, SceneObject
from sim_node import World, sense, true_scene_graph
from sim_node.scene.cameras import FIRST

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
    joints = joint_states(world)
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
        other = view_of(camera, taken).observation(taken.rgb, None, taken.depth)
        if not arm_problem(world, camera.name, other, joints):
            others[camera.name] = other
    if item.damage is not None:
        rng = np.random.default_rng([drawn.seed, 13])
        earlier = functools.partial(earlier_state, world, drawn, item.as_high)
        observation = item.damage(observation, Shot(exact.labels, earlier, rng))
    problem = arm_problem(world, FIRST, observation, joints)
    answer, seen = answer_to(drawn.seed, observation, truth, item, locator, others)
    if item.after:
        way = on_the_way(world, drawn, item.as_high)
        if seen_frozen(earlier(), way, observation):
            problem = FROZEN_COLORS
    if problem:
        status = GraphStatus.BAD_IMAGE.name
        answer = replace(answer, confident=False, status=status, message=problem, readings=0)
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
