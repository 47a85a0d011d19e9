# SPDX-License-Identifier: Apache-2.0
"""What perception reports, and the scene that can be planned on if it can be trusted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from scene_graph import (
    UP,
    GraphStatus,
    Rows,
    SceneGraph,
    SceneGraphError,
    Stacks,
    hidden_places,
    is_hidden,
    rows_of,
)

from ..errors import NotConfidentError

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Sighting:
    """A scene graph as perception reports it.

    Attributes:
        graph: empty where it could not be read.
        status: what perception thinks of it.
        message: perception's reason where it is not confident; may be empty.
        stamp: when its image was taken, in ROS time [ns].
        frame_id: the frame of all positions.
        defect: why the graph could not be read, or empty.
        view_requested: whether a camera was asked to look at what is hidden from elsewhere.
    """

    graph: SceneGraph
    status: GraphStatus = GraphStatus.CONFIDENT
    message: str = ""
    stamp: int = 0
    frame_id: str = ""
    defect: str = ""
    view_requested: bool = False


@dataclass(frozen=True)
class Scene:
    """A scene graph that can be planned on, and the state that it describes.

    Attributes:
        graph, stamp, frame_id: as in :class:`Sighting`.
        stacks: every object of the graph stands on one; what stands for hidden blocks among them,
            see :mod:`scene_graph.hidden`.
        lying: where blocks lie that are before the places, and in nobody's way, by name [m].
        view_requested: as in :class:`Sighting`.
    """

    graph: SceneGraph
    stacks: Stacks
    stamp: int = 0
    frame_id: str = ""
    lying: Mapping[str, Point] = field(default_factory=dict)
    view_requested: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all objects, sorted."""
        return tuple(sorted(self.graph.names))

    @property
    def rows(self) -> Rows:
        """How the places lie."""
        return rows_of(self.graph.places)

    @property
    def aside(self) -> tuple[str, ...]:
        """The blocks that stand on the table beside the places, and are to be put on one."""
        stands = zip(self.stacks, self.graph.places)
        return tuple(name for stack, place in stands if place.aside for name in stack)

    @property
    def on_places(self) -> Stacks:
        """The state as if blocks that stand beside the places stood on top of the first of them."""
        count = sum(not place.aside for place in self.graph.places)
        first, *others = self.stacks[:count]
        return ((*first, *self.aside), *others)

    @property
    def hidden(self) -> tuple[int, ...]:
        """The places of which it is not known what stands there, as blocks hide it."""
        return hidden_places(self.stacks)

    @property
    def seen_stacks(self) -> Stacks:
        """The blocks that are seen."""
        return tuple(tuple(name for name in stack if not is_hidden(name)) for stack in self.stacks)


def scene_in(sighting: Sighting, min_confidence: float = 0.0, may_hide: bool = False) -> Scene:
    """Raises NotConfidentError if the graph cannot be planned on; the sentence says why.

    Args:
        may_hide: whether blocks of a row in front may hide a part of it.
    """
    graph = sighting.graph
    partial = may_hide and sighting.status == GraphStatus.HIDDEN
    if sighting.status != GraphStatus.CONFIDENT and not partial:
        raise NotConfidentError(sighting.message or f"perception reports {sighting.status.name}")
    if graph.confidence < min_confidence:
        raise NotConfidentError(
            f"the scene graph's confidence {graph.confidence:.2f} is below min_confidence "
            f"{min_confidence:.2f}; look again, or lower the parameter"
        )
    if sighting.defect:
        raise NotConfidentError(f"the scene graph contradicts itself: {sighting.defect}")
    # Of what lies no size is known. Perception would not be confident if it lay among the places.
    standing = {item.subject for item in graph.relations if item.predicate == UP}
    lying = {item.name: item.position_world for item in graph.objects
             if not any(item.size) and item.name not in standing}  # fmt: skip
    if lying:
        others = tuple(item for item in graph.objects if item.name not in lying)
        graph = replace(graph, objects=others)
    try:
        stacks = graph.stacks()
    except SceneGraphError as error:
        raise NotConfidentError(f"the scene graph contradicts itself: {error}") from error
    if not graph.places:
        raise NotConfidentError("the scene graph has no bases, so that stacks cannot be told apart")
    on_stacks = {name for stack in stacks for name in stack}
    if on_stacks != set(graph.names):
        odd = ", ".join(sorted(on_stacks ^ set(graph.names)))
        raise NotConfidentError(
            f"the scene graph is incomplete: objects and relations differ: {odd}"
        )
    return Scene(graph, stacks, sighting.stamp, sighting.frame_id, lying, sighting.view_requested)
