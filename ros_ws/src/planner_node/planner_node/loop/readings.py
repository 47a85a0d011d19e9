# SPDX-License-Identifier: Apache-2.0
"""What a scene may be where some colours are in doubt, and what was answered about them.

A block in doubt keeps one name while it is seen, whichever of its colours is the likeliest in the
newest picture. So plans and predictions know nothing of doubt: only a goal, which people put in
words, has to be asked what it means in each reading, see :mod:`.certain_goal`.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from scene_graph import GraphStatus, SceneGraph, SceneObject, Stacks, object_name

from .scene import Sighting


@dataclass(frozen=True)
class Doubt:
    """A block whose colour is in doubt.

    Attributes:
        name: as the scene has it.
        colors: that it may have, the likeliest first, two or more.
        shape: which it has.
    """

    name: str
    colors: tuple[str, ...]
    shape: str

    def as_color(self, color: str, others: Collection[str]) -> str:
        """What the block is called if it has this color, beside others with these names."""
        kind = object_name(color, self.shape)
        numbered = (f"{kind}_{number}" for number in itertools.count(2))
        return next(name for name in itertools.chain([kind], numbered) if name not in others)


def doubts_in(graph: SceneGraph) -> tuple[Doubt, ...]:
    """The blocks of a graph whose colours are in doubt."""
    return tuple(
        Doubt(item.name, item.readings, item.shape) for item in graph.objects if item.alternatives
    )


def readings_of(doubts: Iterable[Doubt], names: Iterable[str]) -> Iterator[dict[str, str]]:
    """How the blocks in doubt may be called, the likeliest reading first.

    Args:
        names: of all blocks.
    """
    doubts = tuple(doubts)
    certain = set(names) - {doubt.name for doubt in doubts}
    for colors in itertools.product(*(doubt.colors for doubt in doubts)):
        reading: dict[str, str] = {}
        for doubt, color in zip(doubts, colors):
            reading[doubt.name] = doubt.as_color(color, {*certain, *reading.values()})
        yield reading


def renamed(stacks: Stacks, names: Mapping[str, str]) -> Stacks:
    """A state with other names for some of its blocks."""
    return tuple(tuple(names.get(name, name) for name in stack) for stack in stacks)


class Readings:
    """Names for blocks in doubt that stay the same over pictures, and what was answered.

    A block is known again by its name, or as the only one that was not there before and may have
    one of its colours. An answer holds as long as the block may have that colour.
    """

    def __init__(self) -> None:
        self._known: dict[str, frozenset[str]] = {}
        self._answered: dict[str, str] = {}
        self._certain: frozenset[str] = frozenset()
        self._stamp = 0

    def answer(self, doubt: Doubt, color: str, names: Collection[str]) -> None:
        """Takes it that a block has this colour; ``names`` are those of all blocks."""
        name = doubt.as_color(color, set(names) - {doubt.name})
        self._known.pop(doubt.name, None)
        self._known[name] = frozenset([object_name(color, doubt.shape)])
        self._answered[name] = color

    def named(self, sighting: Sighting) -> Sighting:
        """The same with the names that its blocks in doubt have had, to be planned on."""
        if sighting.stamp < self._stamp:  # the clock went back: another scene
            self._known, self._answered, self._certain = {}, {}, frozenset()
        self._stamp = sighting.stamp
        graph = sighting.graph
        if self._known:
            graph = self._as_answered(graph.renamed(self._names_in(graph)))
        if sighting.status.sees_all:
            self._remember(graph)
        if graph is sighting.graph and sighting.status is not GraphStatus.DOUBTFUL:
            return sighting
        status = GraphStatus.CONFIDENT if sighting.status.sees_all else sighting.status
        return replace(sighting, graph=graph, status=status)

    def _names_in(self, graph: SceneGraph) -> dict[str, str]:
        """Which blocks have to be called otherwise."""
        seen = {item.name: _kinds(item) for item in graph.objects}
        found: dict[str, str] = {}
        for name, kinds in self._known.items():
            if name in seen and seen[name] & kinds:
                continue
            new = [
                other
                for other, its in seen.items()
                if its & kinds and other not in self._certain and other not in self._known
            ]
            if len(new) == 1 and name not in seen and new[0] not in found:
                found[new[0]] = name
        return found

    def _as_answered(self, graph: SceneGraph) -> SceneGraph:
        objects = tuple(
            replace(item, color=self._answered[item.name], alternatives=())
            if self._answered.get(item.name) in item.readings
            else item
            for item in graph.objects
        )
        return replace(graph, objects=objects)

    def _remember(self, graph: SceneGraph) -> None:
        names = set(graph.names)
        for name in set(self._known) - names:  # all are seen: it is gone
            del self._known[name]
            self._answered.pop(name, None)
        for item in graph.objects:
            if item.alternatives:
                self._known.setdefault(item.name, _kinds(item))
        self._certain = frozenset(names - set(self._known))


def _kinds(item: SceneObject) -> frozenset[str]:
    return frozenset(object_name(color, item.shape) for color in item.readings)
