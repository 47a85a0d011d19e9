# SPDX-License-Identifier: Apache-2.0
"""From an observation to a scene graph with a verdict, one value handed on to the next stage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from scene_graph import GraphStatus, SceneGraph

from .alignment import aligned
from .blocks import centres, find_blocks, measure
from .config import PerceptionConfig
from .covered import Seen, measure_seen, poorly_seen, uncovered
from .errors import BadImageError, BlockImageError, HiddenPlacesError, PerceptionError, PlacesError
from .fallen import find_fallen, with_fallen
from .graph import build_graph
from .hiding import Hidden, find_hidden
from .name_sets import load_name_sets
from .names import name_blocks
from .observation import Observation
from .places import FromAnywhere, Places, Points, RowOfPlaces, TwoRows
from .places.found import find_places, search_volume
from .places.hidden import cells_over
from .places.occlusion import find_occlusion
from .places.table import table_problem
from .probability import evidence, load_parameters, probability
from .segment import (
    RGB,
    RGBD,
    SEGMENTERS,
    Segmenter,
    Segments,
    Volume,
    check_segments,
    given_labels,
)
from .sight import sight_problem
from .strays import find_strays, seen_besides, with_strays
from .verdict import Verdict, judge, judge_empty, judge_fallen, with_grain, with_stray
from .view import View
from .visual_module.coordinates import Locator

#: What is said where places are looked for and no block is seen.
NOTHING_STANDS: Final = (
    "no block is seen in reach, so that no places are found; put one wherever a stack shall be"
)


@dataclass(frozen=True)
class Perceived:
    """What was made of an observation.

    Attributes:
        graph: of the scene; without objects where the observation cannot be used.
        status: whether it can be planned on.
        message: a sentence saying why not; empty if it can.
        segments: which pixels the graph's objects are, those that lie left out; None if it did not
            come that far.
        probability: that the whole graph is right, 0..1; 0 without objects.
        evidence: what that follows from, see :mod:`.probability`; empty without objects.
        coverage: of a doubtful graph: share of such scenes whose names are among those given, at
            least; else 0.
        view: what the graph was made of; None if it did not come that far.
    """

    graph: SceneGraph
    status: GraphStatus
    message: str = ""
    segments: Segments | None = None
    probability: float = 0.0
    evidence: tuple[float, ...] = ()
    coverage: float = 0.0
    view: View | None = None


class Perception:
    """Interprets observations. Keeps nothing between them: several threads can use it at once."""

    def __init__(
        self,
        locator: Locator,
        config: PerceptionConfig | None = None,
        segmenter: Segmenter | None = None,
        places: Callable[[Points], Places] = RowOfPlaces,
    ) -> None:
        """Puts the parts together.

        Args:
            locator: finds coordinates: the visual module G, see :func:`load_weights`.
            config: what is known of the scene beforehand, and what is accepted.
            segmenter: finds the blocks' pixels; None: the one that ``config.mask_source`` names.
            places: makes of ``config.stack_positions`` how they lie.
        """
        self.locator = locator
        self.config = config or PerceptionConfig()
        self.segmenter = segmenter
        self.make_places = places
        self.places = places(self.config.stack_positions)
        self._probability = load_parameters()
        self._name_sets = load_name_sets()
        feet = np.array([place.position_world for place in self.places.places])
        self._volume = Volume.over(feet, self.config.column_height) if len(feet) else None

    def configured(self, config: PerceptionConfig) -> Perception:
        """The same parts with another configuration."""
        return Perception(self.locator, config, self.segmenter, self.make_places)

    def perceive(self, observation: Observation) -> Perceived:
        """Interprets one observation. Whatever is wrong with it is told by status and message."""
        try:
            return self._perceive(observation.checked())
        except PerceptionError as error:
            return self.rejected(GraphStatus.BAD_IMAGE, str(error))

    def find_places(self, observation: Observation) -> tuple[Perception, Perceived]:
        """The same parts with the places at which stacks are seen, and what is seen with them.

        Itself where there are none, or where what is seen cannot be planned on.
        """
        try:
            observation = observation.checked()
            found = self.configured(replace(self.config, stack_positions=self._found(observation)))
        except HiddenPlacesError as error:
            return self, self.rejected(GraphStatus.OCCLUDED, str(error))
        except PlacesError as error:
            return self, self.rejected(GraphStatus.NO_PLACES, str(error))
        except PerceptionError as error:
            return self, self.rejected(GraphStatus.BAD_IMAGE, str(error))
        if not found.places.places:
            return self, self.rejected(GraphStatus.NO_OBJECTS, NOTHING_STANDS)
        perceived = found.perceive(observation)
        return (found if perceived.status.sees_all else self), perceived

    def _found(self, observation: Observation) -> Points:
        """Raises PerceptionError."""
        if observation.depth is None or observation.camera is None:
            raise BadImageError(
                "places are found in depth only; publish it, or set places to given"
            )
        observation.check_values()
        volume = search_volume(self.config.search, self.config.column_height)
        observation = self._aligned(observation, volume)
        segments = self._segments(observation, volume)
        surfaces = measure(observation, segments)
        labelled = segments.label_image > 0
        return find_places(observation, labelled, surfaces, self.config.search, volume)

    def rejected(self, status: GraphStatus, message: str) -> Perceived:
        """An empty graph with the reason for it."""
        graph = SceneGraph((), frozenset(), self.places.places, 0.0)
        return Perceived(graph, status, message)

    def _perceive(self, observation: Observation) -> Perceived:
        """Raises PerceptionError if the observation cannot be used."""
        config, places = self.config, self.places.seen_by(observation.camera)
        observation.check_values()
        taken, observation = observation, self._aligned(observation, self._volume)
        segments = self._segments(observation, self._volume)

        def refused(verdict: Verdict) -> Perceived:
            return self.rejected(*with_grain(verdict, observation.noise))

        try:
            check_segments(taken.rgb, segments, observation.depth)
            if problem := table_problem(observation, segments, places):
                raise BadImageError(problem)
            if problem := sight_problem(observation, segments, places, config):
                raise BadImageError(problem)
        except BlockImageError as error:
            perceived = self.rejected(GraphStatus.BAD_IMAGE, str(error))
            others = seen_besides(observation, segments, error.label)
            return replace(perceived, graph=with_strays(perceived.graph, others))

        def nothing(seen: Seen) -> Perceived:
            occlusion = find_occlusion(observation, segments, places, config)
            view = View(observation, seen, occlusion)
            return replace(refused(judge_empty(occlusion, config)), view=view)

        seen = Seen(segments, ())
        if len(segments):
            seen = self._seen(observation, segments, places)
        if not len(seen.segments):
            return nothing(seen)
        coordinates = self.locator.locate(self.locator.images(observation.rgb, seen.segments))
        fallen = find_fallen(observation.rgb, seen.segments, seen.surfaces, coordinates)
        if fallen:
            occlusion = find_occlusion(observation, segments, places, config)
            by_depth = observation.depth is not None
            verdict = judge_fallen(fallen[0], occlusion, config, by_depth)
            if len(fallen) == len(seen.segments):
                return refused(verdict)
            # What is known of the others is told all the same; what has fallen may hide some.
            coordinates = coordinates.of(seen.upright)
            seen = seen.standing()
        while True:
            segments = seen.segments
            standing = places.stand(observation, segments, coordinates, centres(seen.surfaces))
            blocks = find_blocks(
                *(observation, segments, standing, seen.surfaces),
                *(seen.partly, config.smallest_block),
            )
            if seen.covered:
                whole = uncovered(observation, seen, blocks)
                coordinates = self.locator.locate(self.locator.images(*whole))
            if not (poor := poorly_seen(seen, blocks, standing.stacks, coordinates.iou, config)):
                break
            seen = seen.without(poor, observation, places.places)
            if not len(seen.segments):
                return nothing(seen)
            coordinates = self.locator.locate(self.locator.images(observation.rgb, seen.segments))
        occlusion = find_occlusion(observation, segments, places, config, blocks.poses)
        hidden: tuple[Hidden, ...] = ()
        if isinstance(places, TwoRows):
            size = config.column_half_width, config.column_height
            cells = cells_over(observation, segments, standing.places, *size)
            hidden = find_hidden(cells, standing, blocks, seen.glimpses, config)
        names = name_blocks(
            observation.rgb, segments, blocks.shapes, standing.stacks, self._name_sets
        )
        graph = build_graph(
            observation, segments, occlusion, coordinates, standing, blocks, names, hidden
        )
        if not fallen:
            verdict = judge(graph, occlusion, standing, blocks, names, config, hidden)
        known = evidence(graph, verdict.status, blocks, names, occlusion, observation.noise)
        verdict = with_grain(verdict, observation.noise)
        likely = probability(known, self._probability)
        graph = with_fallen(graph, fallen) if fallen else graph
        if self._volume is not None and config.mask_source == RGBD:
            strays = find_strays(taken, self._volume, segments)
            graph, verdict = with_strays(graph, strays), with_stray(verdict, strays)
        doubtful = verdict.status is GraphStatus.DOUBTFUL
        coverage = self._name_sets.coverage if doubtful else 0.0
        view = View(observation, seen, occlusion, names, bool(fallen))
        return Perceived(graph, *verdict, segments, likely, known, coverage, view)

    def _seen(self, observation: Observation, segments: Segments, places: Places) -> Seen:
        """The blocks measured; where things hide others, without those that are mostly covered."""
        if isinstance(places, FromAnywhere) and observation.depth is not None:
            return measure_seen(observation, segments, places.places, by_things=True)
        if isinstance(places, TwoRows) and observation.depth is not None:
            return measure_seen(observation, segments, places.places)
        if isinstance(places, TwoRows) and segments.hides is not None:
            raise BadImageError(
                "the places lie in two rows, which only depth tells apart; set mask_source to rgbd"
            )
        return Seen(segments, measure(observation, segments, places.places))

    def _aligned(self, observation: Observation, volume: Volume | None) -> Observation:
        """With edges where they are, where the places are seen and depth can be moved to colour."""
        if volume is None or observation.camera is None or observation.depth is None:
            return observation
        box = volume.seen_by(observation.camera)
        return observation if box is None else aligned(observation, box)

    def _segments(self, observation: Observation, volume: Volume | None) -> Segments:
        segmenter = self.segmenter or SEGMENTERS[self.config.mask_source]
        alone = self.config.mask_source == RGB and observation.labels is None
        if observation.depth is None and self.segmenter is None and not alone:
            segmenter = given_labels  # a goal image, drawn by hand
        segments = segmenter(observation, volume)
        if segments.label_image.shape != observation.rgb.shape[:2]:
            raise BadImageError(
                f"the segmenter's labels have the shape {segments.label_image.shape}, "
                f"the image {observation.rgb.shape[:2]}; both must show the same pixels"
            )
        return segments
