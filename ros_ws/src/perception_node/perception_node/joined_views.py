# SPDX-License-Identifier: Apache-2.0
"""One graph of what several cameras see of one moment.

Each view is understood by itself. Blocks of two views that are measured at one spot are one block,
whose measurements are joined (:mod:`.sightings`) before anything is concluded from them. What one
camera does not see another one may: a point is free if any camera sees through it. A block that one
camera sees where another one sees through is a contradiction, which is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from scene_graph import GraphStatus, SceneGraph, SceneObject

from .blocks import Blocks, centres
from .blocks.pose import pose_blocks
from .camera import PinholeCamera
from .errors import ContradictionError, PerceptionError, with_topics_of
from .graph import build_graph
from .hiding import find_hidden
from .names import Names, unique_names
from .observation import Observation
from .pipeline import Perceived, Perception
from .places import FromAnywhere
from .places.hidden import cells_over, free_share, seen_through
from .places.occlusion import Occlusion
from .probability import evidence, load_parameters, probability
from .segment import Segment, Segments
from .sightings import Sightings, check_offset, fused, matched, sightings
from .strays import with_strays
from .verdict import judge, judge_empty, with_grain
from .view import View
from .visual_module.coordinates import Coordinates

#: A block of which a camera sees through so large a share is not there.
SEEN_THROUGH: Final = 0.3
#: What lies further than this from every block is none of them [m].
APART: Final = 0.04
_GLIMPSES: Final = (
    "of no block enough is seen to say what it is; take away what is before them, or look from "
    "another side"
)


class JoinedViews:
    """Perception through several cameras. Keeps nothing but where the first one was last.

    Args:
        perception: as for one camera.
        first: name of the camera for which things are left, right and in front.
    """

    def __init__(self, perception: Perception, first: str) -> None:
        self._one, self._name = perception, first
        self._each = Perception(
            perception.locator, perception.config, perception.segmenter, FromAnywhere
        )
        self._weights = load_parameters()
        self._camera: PinholeCamera | None = None

    def configured(self, perception: Perception) -> JoinedViews:
        """The same with another configuration."""
        other = JoinedViews(perception, self._name)
        other._camera = self._camera
        return other

    def perceive(self, observations: Mapping[str, Observation]) -> Perceived:
        """Interprets what cameras deliver of one moment.

        What is wrong with some of the pictures is told, and the others are used.

        Args:
            observations: by the names of the cameras, at least one.
        """
        every = {name: self._understood(name, item) for name, item in observations.items()}
        for item in every.values():
            useless = item.view is None and item.status is not GraphStatus.BAD_IMAGE
            if useless or (item.view is not None and item.view.fallen):
                return replace(item, view=None)
        views = {name: item for name, item in every.items() if item.view is not None}
        bad = "; ".join(item.message for name, item in every.items() if name not in views)
        if not views:
            return self._one.rejected(GraphStatus.BAD_IMAGE, bad)
        if self._name in views or self._camera is None:
            nearest = views.get(self._name, next(iter(views.values())))
            assert nearest.view is not None
            self._camera = nearest.view.observation.camera
        try:
            joined = self._join(views)
        except ContradictionError as error:
            joined = self._one.rejected(GraphStatus.LOW_CONFIDENCE, str(error))
        except PerceptionError as error:
            joined = self._one.rejected(GraphStatus.BAD_IMAGE, str(error))
        return replace(joined, message="; ".join(filter(None, (joined.message, bad))))

    def _understood(self, camera: str, observation: Observation) -> Perceived:
        perceived = self._each.perceive(observation)
        told = with_topics_of(camera, perceived.message)
        if told == perceived.message and camera != self._name:
            told = f"{camera}: {told}"
        return replace(perceived, message=told)

    def _join(self, perceived: Mapping[str, Perceived]) -> Perceived:
        """Raises PerceptionError."""
        config = self._one.config
        views = {name: item.view for name, item in perceived.items() if item.view is not None}
        occlusion = _least_hidden([view.occlusion for view in views.values()])
        found: list[Sightings] = []
        for name, item in perceived.items():
            found = matched(found, sightings(name, item))
        glimpses = [one for view in views.values() for one in view.seen.glimpses]
        if not found and glimpses:
            return self._one.rejected(GraphStatus.OCCLUDED, _GLIMPSES)
        if not found:
            return self._one.rejected(*judge_empty(occlusion, config))
        check_offset(found)
        main = next(iter(views))
        observation = replace(views[main].observation, camera=self._camera)
        segments = views[main].seen.segments
        coordinates = _coordinates(found)
        surfaces = tuple(map(fused, found))
        places = self._one.places.seen_by(self._camera)
        standing = places.stand(observation, segments, coordinates, centres(surfaces))
        measured = pose_blocks(
            *(surfaces, standing.stacks, standing.table_heights),
            [index for index, block in enumerate(found) if all(one.covered for one in block)],
            config.smallest_block,
        )
        blocks = Blocks(tuple(item.shape for item in measured), measured)
        known_names = {n: view.names for n, view in views.items() if view.names is not None}
        names = _names(found, blocks.shapes, standing.stacks, known_names)
        _check_seen_through(found, names.names, blocks, views)
        size = config.column_half_width, config.column_height
        cells = seen_through(
            [
                cells_over(view.observation, view.seen.segments, standing.places, *size)
                for view in views.values()
            ]
        )
        hidden = find_hidden(cells, standing, blocks, glimpses, config)
        graph = build_graph(
            *(observation, _labelled(segments, found, main), occlusion, coordinates),
            *(standing, blocks, names, hidden),
        )
        verdict = judge(graph, occlusion, standing, blocks, names, config, hidden)
        noise = max(view.observation.noise for view in views.values())
        known = evidence(graph, verdict.status, blocks, names, occlusion, noise)
        doubtful = verdict.status is GraphStatus.DOUBTFUL
        return Perceived(
            with_strays(graph, _strays(perceived.values(), graph)),
            *with_grain(verdict, noise),
            segments,
            probability(known, self._weights),
            known,
            min(item.coverage for item in perceived.values() if item.coverage) if doubtful else 0.0,
        )


def _least_hidden(every: Sequence[Occlusion]) -> Occlusion:
    """For each place as it is in the view where the least of it is hidden."""
    known = [item for item in every if item.shares]
    if not known:
        return Occlusion()
    return Occlusion(
        None,
        tuple(map(min, zip(*(item.shares for item in known)))),
        tuple(map(max, zip(*(item.seen_to for item in known)))),
    )


def _coordinates(found: Sequence[Sightings]) -> Coordinates:
    """What the visual module says of the blocks where it is surest of each."""
    best = [max(block, key=lambda one: one.item.confidence).item for block in found]
    phi = np.array([item.coordinates for item in best])
    return Coordinates(phi, phi, phi, np.array([item.confidence for item in best]))


def _labelled(segments: Segments, found: Sequence[Sightings], camera: str) -> Segments:
    """The blocks that are found, by their labels in a camera's picture; 0 where it sees none."""
    nothing = np.zeros(segments.label_image.shape, bool)
    blocks = []
    for block in found:
        labels = [one.item.label for one in block if one.camera == camera]
        blocks.append(Segment(labels[0] if labels else 0, nothing, nothing))
    return replace(segments, blocks=tuple(blocks))


def _names(
    found: Sequence[Sightings],
    shapes: Sequence[str],
    stacks: Sequence[Sequence[int]],
    views: Mapping[str, Names],
) -> Names:
    """What the blocks are called: by the colours that all views say they may have.

    Views that are in doubt, and do not say between what, are asked last.

    Raises:
        ContradictionError: if there is no such colour.
    """
    readings, doubts = [], []
    for block in found:
        used = [one for one in block if not one.covered] or list(block)
        sure = [one for one in used if not views[one.camera].doubt or one.item.alternatives]
        sure += [one for one in used if one not in sure and views[one.camera].alternatives]
        doubts += [views[one.camera].doubt for one in used if not sure]
        colors = [one.item.readings or (one.item.color,) for one in sure or used]
        common = [color for color in colors[0] if all(color in some for some in colors)]
        if not common:
            one, other = next(
                (used[0], one)
                for one, some in zip(sure or used, colors)
                if colors[0][0] not in some
            )
            raise ContradictionError(
                f"{one.item.name} for {one.camera} is {other.item.name} for {other.camera}; "
                "look from where the light is better, and check their extrinsics"
            )
        readings.append(common)
    names = unique_names([some[0] for some in readings], shapes, stacks)
    several = [f"the colour of {name} may be {' or '.join(some)}"
               for name, some in zip(names, readings) if len(some) > 1]  # fmt: skip
    unsure = doubts[0] if doubts else ""
    choice = f"{' and '.join(several)}; give it more light, or say which it is" if several else ""
    return Names(
        tuple(some[0] for some in readings),
        names,
        unsure or choice,
        max(item.distance for item in views.values()),
        min(item.margin for item in views.values()),
        tuple(tuple(some[1:]) for some in readings) if several and not unsure else (),
    )


def _check_seen_through(
    found: Sequence[Sightings], names: Sequence[str], blocks: Blocks, views: Mapping[str, View]
) -> None:
    """Raises ContradictionError if a camera sees through a block that another one sees."""
    for block, name, measured in zip(found, names, blocks.measured):
        seen_by = [one.camera for one in block]
        for camera, view in views.items():
            if camera in seen_by:
                continue
            if free_share(view.observation, measured.pose) > SEEN_THROUGH:
                raise ContradictionError(
                    f"{camera} sees nothing where {name} stands for {seen_by[0]}; check "
                    f"{camera}/extrinsics and {seen_by[0]}/extrinsics, and that nothing moved "
                    "between the pictures"
                )


def _strays(every: Iterable[Perceived], graph: SceneGraph) -> tuple[SceneObject, ...]:
    """What a view sees lie before the places and is no block of the graph."""
    blocks = np.array([item.position_world[:2] for item in graph.objects])
    return tuple(
        item
        for perceived in every
        if perceived.view is not None and perceived.view.names is not None
        for item in perceived.graph.objects
        if item.name not in perceived.view.names.names
        and np.hypot(*(blocks - item.position_world[:2]).T).min() > APART
    )
