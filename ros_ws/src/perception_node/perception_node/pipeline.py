# SPDX-License-Identifier: Apache-2.0
"""From an observation to a scene graph with a verdict, one value handed on to the next stage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from scene_graph import GraphStatus, SceneGraph

from .blocks import find_blocks
from .config import PerceptionConfig
from .errors import BadImageError, NotUprightError, PerceptionError
from .graph import build_graph
from .names import color_names, mean_colors, name_blocks
from .observation import Observation
from .places import Places, Points, RowOfPlaces
from .places.occlusion import find_occlusion
from .places.table import table_problem
from .segment import Segmenter, Segments, check_segments, given_labels
from .verdict import judge, judge_empty, judge_not_upright
from .visual_module.coordinates import Locator
from .visual_module.object_images import object_images


@dataclass(frozen=True)
class Perceived:
    """What was made of an observation.

    Attributes:
        graph: of the scene; without objects where the observation cannot be used.
        status: whether it can be planned on.
        message: a sentence saying why not; empty if it can.
        segments: which pixels the graph's objects are; None if it did not come that far.
    """

    graph: SceneGraph
    status: GraphStatus
    message: str = ""
    segments: Segments | None = None


class Perception:
    """Interprets observations. Keeps nothing between them: several threads can use it at once."""

    def __init__(
        self,
        locator: Locator,
        config: PerceptionConfig | None = None,
        segmenter: Segmenter = given_labels,
        places: Callable[[Points], Places] = RowOfPlaces,
    ) -> None:
        """Puts the parts together.

        Args:
            locator: finds coordinates: the visual module G, see :func:`load_weights`.
            config: what is known of the scene beforehand, and what is accepted.
            segmenter: finds the blocks' pixels.
            places: makes of ``config.stack_positions`` how they lie.
        """
        self.locator = locator
        self.config = config or PerceptionConfig()
        self.segmenter = segmenter
        self.make_places = places
        self.places = places(self.config.stack_positions)

    def configured(self, config: PerceptionConfig) -> Perception:
        """The same parts with another configuration."""
        return Perception(self.locator, config, self.segmenter, self.make_places)

    def perceive(self, observation: Observation) -> Perceived:
        """Interprets one observation. Whatever is wrong with it is told by status and message."""
        try:
            return self._perceive(observation.checked())
        except PerceptionError as error:
            return self.rejected(GraphStatus.BAD_IMAGE, str(error))

    def rejected(self, status: GraphStatus, message: str) -> Perceived:
        """An empty graph with the reason for it."""
        graph = SceneGraph((), frozenset(), self.places.places, 0.0)
        return Perceived(graph, status, message)

    def _perceive(self, observation: Observation) -> Perceived:
        """Raises PerceptionError if the observation cannot be used."""
        config, places = self.config, self.places
        observation.check_values()
        segments = self._segments(observation)
        check_segments(observation.rgb, segments)
        if problem := table_problem(observation, segments, places):
            raise BadImageError(problem)
        occlusion = find_occlusion(observation, segments, places, config)
        if len(segments) == 0:
            return self.rejected(*judge_empty(occlusion, config))
        coordinates = self.locator.locate(object_images(observation.rgb, segments))
        standing = places.stand(observation, segments, coordinates)
        try:
            blocks = find_blocks(observation, segments, standing)
        except NotUprightError as error:
            parts = [segment.part for segment in segments]
            color = color_names(mean_colors(observation.rgb, parts))[error.index]
            sentence = f"the {color} block {error}"
            return self.rejected(*judge_not_upright(sentence, occlusion, config))
        names = name_blocks(observation.rgb, segments, blocks.shapes, standing.stacks)
        graph = build_graph(observation, segments, occlusion, coordinates, standing, blocks, names)
        verdict = judge(graph, occlusion, standing, blocks, names, config)
        return Perceived(graph, *verdict, segments)

    def _segments(self, observation: Observation) -> Segments:
        segments = self.segmenter(observation)
        if segments.label_image.shape != observation.rgb.shape[:2]:
            raise BadImageError(
                f"the segmenter's labels have the shape {segments.label_image.shape}, "
                f"the image {observation.rgb.shape[:2]}; both must show the same pixels"
            )
        return segments
