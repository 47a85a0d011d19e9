# SPDX-License-Identifier: Apache-2.0
"""Tables on which a move cannot be, and why; and what a suggestion comes to, by its words alone."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from motion_scenes import scene
from obstacle_scenes import WIDE, pen, wall

from motion_node.obstacles import Obstacle
from scene_graph import Move, SceneGraph, SceneObject

Point = tuple[float, float, float]

_MOVE: Final = Move(0, 2)
#: "move obstacle wall 12 mm to the left and 3 mm nearer to the arm" and the like.
_MOVED: Final = re.compile(r"move (?P<what>.*?) (?P<by>\d+ mm .*)")
_STEP: Final = re.compile(
    r"(\d+) mm (to the left|to the right|nearer to the arm|away from the arm)"
)
_HEIGHT: Final = re.compile(r"(make|hang) obstacle (.*) (?:(\d+) mm (lower|higher)|as low as)")
_TAKEN: Final = re.compile(r"take (?P<names>.*) off the stack at \S+")
_WIDTH: Final = re.compile(r"make (\S+) (\d+) mm narrower")
#: World x and y of a step.
_STEPS: Final = {
    "to the left": (0.0, -1.0),
    "to the right": (0.0, 1.0),
    "nearer to the arm": (-1.0, 0.0),
    "away from the arm": (1.0, 0.0),
}


@dataclass(frozen=True)
class Refused:
    """A move that cannot be.

    Attributes:
        kind: why, as it was made.
        words: one of these stands in the reason of a right refusal.
    """

    kind: str
    graph: SceneGraph
    words: tuple[str, ...]
    obstacles: tuple[Obstacle, ...] = ()
    move: Move = _MOVE


def out_of_reach(rng: np.random.Generator) -> Refused:
    """A place, or the block itself, farther away than the arm is long."""
    far = (float(rng.uniform(0.85, 1.05)), float(rng.uniform(-0.25, 0.25)))
    if rng.integers(2):
        graph = scene((1, 1, 0), places=(*WIDE[:2], far))
    else:
        graph = scene((1, 1, 0), places=(far, *WIDE[1:]))
    return Refused("out of reach", graph, ("reach",))


def walled_in(rng: np.random.Generator) -> Refused:
    """A fence around the place or the block, narrower than the hand is wide."""
    place = WIDE[0 if rng.integers(2) else 2]
    around = pen(*place, float(rng.uniform(0.12, 0.3)), float(rng.uniform(0.1, 0.14)))
    return Refused("walled in", scene((1, 1, 0), places=WIDE), ("fence",), around)


def too_wide(rng: np.random.Generator) -> Refused:
    """A block that the fingers do not go around."""
    graph = scene((1, 1, 0), places=WIDE, edge=float(rng.uniform(0.073, 0.1)))
    return Refused("too wide", graph, ("width",))


def too_high(rng: np.random.Generator) -> Refused:
    """A tower to whose top the hand does not come."""
    edge = float(rng.uniform(0.062, 0.067))
    graph = scene((1, 0, int(rng.integers(12, 14))), places=WIDE, edge=edge)
    return Refused("tower too high", graph, ("reach", "lift"))


def too_close(rng: np.random.Generator) -> Refused:
    """A block beside a higher stack, without room for the hand in between."""
    apart = float(rng.uniform(0.047, 0.054))
    places = ((0.5, -apart), (0.5, 0.0), (0.5, 0.25))
    graph = scene((1, int(rng.integers(3, 6)), int(rng.integers(0, 3))), places=places)
    return Refused("blocks too close", graph, ("stack1",))


def in_the_way(rng: np.random.Generator) -> Refused:
    """Something on the place or over it, or a wall between it and the block."""
    graph = scene((1, 1, 0), places=WIDE)
    x, y = WIDE[2]
    form = rng.integers(3)
    if form == 0:
        height, (dx, dy) = float(rng.uniform(0.03, 0.3)), rng.uniform(-0.01, 0.01, 2)
        side = float(rng.uniform(0.03, 0.1))
        thing = Obstacle("thing", (side, side, height), (x + dx, y + dy, height / 2))
    elif form == 1:
        side, z = float(rng.uniform(0.1, 0.25)), float(rng.uniform(0.09, 0.25))
        thing = Obstacle("thing", (side, side, 0.02), (x, y, z))
    else:
        length, height = float(rng.uniform(1.0, 1.6)), float(rng.uniform(0.8, 1.2))
        thing = wall(0.1 + length / 2, 0.1, length, height, name="thing")
    return Refused("obstacle in the way", graph, ("thing",), (thing,))


KINDS: Final[tuple[Callable[[np.random.Generator], Refused], ...]] = (
    out_of_reach,
    walled_in,
    too_wide,
    too_high,
    too_close,
    in_the_way,
)


def followed(table: Refused, suggestion: str) -> Refused:
    """The table after somebody has done what the words say.

    Raises:
        ValueError: if they cannot be understood.
    """
    for sentence in suggestion.split(", and "):
        if match := _WIDTH.fullmatch(sentence):
            table = _narrower(table, match[1], int(match[2]) / 1000)
        elif match := _TAKEN.fullmatch(sentence):
            table = _without(table, set(match["names"].split(", ")))
        elif match := _HEIGHT.match(sentence):
            table = _height(table, match[2], match[4] or "", int(match[3] or 0) / 1000)
        elif match := _MOVED.fullmatch(sentence):
            step = np.zeros(2)
            for far, way in _STEP.findall(match["by"]):
                step += np.multiply(_STEPS[way], int(far) / 1000)
            table = _moved(table, match["what"], step)
        else:
            raise ValueError(f"not understood: {sentence!r}")
    return table


def _shifted(point: Point, step: np.ndarray) -> Point:
    return point[0] + float(step[0]), point[1] + float(step[1]), point[2]


def _moved(table: Refused, what: str, step: np.ndarray) -> Refused:
    if what.startswith("obstacle "):
        name = what.removeprefix("obstacle ")
        return _with_obstacle(
            table, name, lambda o: replace(o, position_world=_shifted(o.position_world, step))
        )
    graph, names, places = table.graph, set[str](), table.graph.places
    if what.startswith("the place "):
        index = int(what.split()[2].removeprefix("stack"))
        names = set(graph.stacks()[index])
        places = tuple(
            replace(p, position_world=_shifted(p.position_world, step)) if p.index == index else p
            for p in places
        )
    else:
        names = set(what.removeprefix("the stack of ").split(", "))
        assert names <= set(graph.names), what

    def moved(item: SceneObject) -> SceneObject:
        if item.name not in names:
            return item
        return replace(item, position_world=_shifted(item.position_world, step))

    return replace(
        table, graph=replace(graph, objects=tuple(map(moved, graph.objects)), places=places)
    )


def _height(table: Refused, name: str, way: str, by: float) -> Refused:
    def changed(item: Obstacle) -> Obstacle:
        (width, depth, height), (x, y, z) = item.size, item.position_world
        if way == "higher":
            return replace(item, position_world=(x, y, z + by))
        left = height - by if way else 0.001
        bottom = z - height / 2
        return replace(item, size=(width, depth, left), position_world=(x, y, bottom + left / 2))

    return _with_obstacle(table, name, changed)


def _with_obstacle(table: Refused, name: str, change: Callable[[Obstacle], Obstacle]) -> Refused:
    assert any(item.name == name for item in table.obstacles), name
    around = tuple(change(item) if item.name == name else item for item in table.obstacles)
    return replace(table, obstacles=around)


def _narrower(table: Refused, name: str, by: float) -> Refused:
    def changed(item: SceneObject) -> SceneObject:
        if item.name != name:
            return item
        x, y, z = item.size
        return replace(item, size=(x - by, y, z))

    return replace(
        table, graph=replace(table.graph, objects=tuple(map(changed, table.graph.objects)))
    )


def _without(table: Refused, names: set[str]) -> Refused:
    graph = table.graph
    assert names <= set(graph.names), names
    objects = tuple(item for item in graph.objects if item.name not in names)
    relations = frozenset(r for r in graph.relations if not names & {r.subject, r.object})
    return replace(table, graph=replace(graph, objects=objects, relations=relations))
