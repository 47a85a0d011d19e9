# SPDX-License-Identifier: Apache-2.0
"""What a person can change about a table, by how much, and in which words that is told.

A lever is one such thing along one axis: a stack or a place moved, blocks taken off a stack, an
obstacle moved, lower or higher, a block narrower. Left is as in the pictures, where places are
numbered from the left; nearer to the arm is along world x.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Protocol

import numpy as np

from scene_graph import Place, SceneGraph, SceneObject, base_name

from ..obstacles import Obstacle

#: Along world x and y.
X: Final = 0
Y: Final = 1
#: Things are moved this far at most [m].
FARTHEST: Final = 0.4
#: An obstacle of which so little is left is taken away [m].
_NOTHING_LEFT: Final = 0.005
#: As good as nothing [m].
ROUNDING: Final = 1e-6


@dataclass(frozen=True)
class Table:
    """What motions are planned for: blocks on places, and what stands around."""

    graph: SceneGraph
    obstacles: tuple[Obstacle, ...] = ()


class Lever(Protocol):
    """One thing that can be changed.

    Attributes:
        reach: least and largest amount [m].
    """

    @property
    def reach(self) -> tuple[float, float]:
        """Least and largest amount [m]."""

    @property
    def thing(self) -> str:
        """What to do with what, as a sentence begins: "move green_box"."""

    def by(self, amount: float, table: Table, /) -> str:
        """How far, in words, as the sentence goes on; ``amount`` in [m]."""

    def pulled(self, table: Table, amount: float) -> Table:
        """The table after a change by ``amount`` [m]."""

    def rounded(self, amount: float) -> float:
        """At least as much, as a person can do it [m]."""


class _ByMillimetres:
    """What can be done by whole millimetres."""

    def rounded(self, amount: float) -> float:
        """See :class:`Lever`."""
        return float(np.sign(amount) * np.ceil(1000 * (abs(amount) - ROUNDING)) / 1000)


@dataclass(frozen=True)
class StackLever(_ByMillimetres):
    """A stack moved along an axis.

    Attributes:
        place: whether its place goes with it; without it only the blocks are moved.
    """

    index: int
    axis: int
    place: bool
    names: tuple[str, ...]

    @property
    def reach(self) -> tuple[float, float]:
        """See :class:`Lever`."""
        return -FARTHEST, FARTHEST

    @property
    def thing(self) -> str:
        """See :class:`Lever`."""
        if self.place:
            on = " with what stands there" if self.names else ""
            return f"move the place {base_name(self.index)}{on}"
        if len(self.names) == 1:
            return f"move {self.names[0]}"
        return f"move the stack of {', '.join(self.names)}"

    def by(self, amount: float, table: Table) -> str:
        """See :class:`Lever`."""
        return _moved(self.axis, amount, table.graph.places)

    def pulled(self, table: Table, amount: float) -> Table:
        """See :class:`Lever`."""
        graph = table.graph

        def shifted(point: tuple[float, float, float]) -> tuple[float, float, float]:
            x, y, z = point
            return (x + amount, y, z) if self.axis == X else (x, y + amount, z)

        def item_of(item: SceneObject) -> SceneObject:
            own = item.name in self.names
            return replace(item, position_world=shifted(item.position_world)) if own else item

        places = graph.places
        if self.place:
            places = tuple(
                replace(place, position_world=shifted(place.position_world))
                if place.index == self.index
                else place
                for place in places
            )
        objects = tuple(item_of(item) for item in graph.objects)
        return replace(table, graph=replace(graph, objects=objects, places=places))


@dataclass(frozen=True)
class ObstacleLever(_ByMillimetres):
    """An obstacle (all of its parts) moved along an axis."""

    name: str
    axis: int

    @property
    def reach(self) -> tuple[float, float]:
        """See :class:`Lever`."""
        return -FARTHEST, FARTHEST

    @property
    def thing(self) -> str:
        """See :class:`Lever`."""
        return f"move obstacle {self.name}"

    def by(self, amount: float, table: Table) -> str:
        """See :class:`Lever`."""
        return _moved(self.axis, amount, table.graph.places)

    def pulled(self, table: Table, amount: float) -> Table:
        """See :class:`Lever`."""

        def moved(item: Obstacle) -> Obstacle:
            x, y, z = item.position_world
            at = (x + amount, y, z) if self.axis == X else (x, y + amount, z)
            return replace(item, position_world=at)

        return _with_obstacle(table, self.name, moved)


@dataclass(frozen=True)
class HeightLever(_ByMillimetres):
    """An obstacle that stands made lower from above, or one that hangs made to hang higher.

    Attributes:
        height: how high it stands, or how much room there is to lift it [m].
    """

    name: str
    hangs: bool
    height: float

    @property
    def reach(self) -> tuple[float, float]:
        """See :class:`Lever`."""
        return 0.0, self.height

    @property
    def thing(self) -> str:
        """See :class:`Lever`."""
        return f"{'hang' if self.hangs else 'make'} obstacle {self.name}"

    def by(self, amount: float, _table: Table) -> str:
        """See :class:`Lever`."""
        if self.hangs:
            return f"{1000 * amount:.0f} mm higher"
        if amount > self.height - _NOTHING_LEFT:
            return "as low as the table"
        return f"{1000 * amount:.0f} mm lower"

    def pulled(self, table: Table, amount: float) -> Table:
        """See :class:`Lever`."""

        def changed(item: Obstacle) -> Obstacle:
            x, y, z = item.position_world
            if self.hangs:
                return replace(item, position_world=(x, y, z + amount))
            width, depth, height = item.size
            less = min(amount, height - 1e-3)
            size = (width, depth, height - less)
            return replace(item, size=size, position_world=(x, y, z - less / 2))

        return _with_obstacle(table, self.name, changed)


@dataclass(frozen=True)
class WidthLever(_ByMillimetres):
    """A block made narrower along one of its own axes."""

    name: str
    axis: int
    width: float

    @property
    def reach(self) -> tuple[float, float]:
        """See :class:`Lever`."""
        return 0.0, self.width

    @property
    def thing(self) -> str:
        """See :class:`Lever`."""
        return f"make {self.name}"

    def by(self, amount: float, _table: Table) -> str:
        """See :class:`Lever`."""
        return f"{1000 * amount:.0f} mm narrower"

    def pulled(self, table: Table, amount: float) -> Table:
        """See :class:`Lever`."""
        item = table.graph.object(self.name)
        round_ = item.shape in ("cylinder", "sphere")
        own = np.array([True, True, False]) if round_ else np.arange(3) == self.axis
        x, y, z = (float(extent - amount * cut) for extent, cut in zip(item.size, own))
        narrower = replace(item, size=(x, y, z))
        objects = tuple(narrower if o.name == self.name else o for o in table.graph.objects)
        return replace(table, graph=replace(table.graph, objects=objects))


def height_lever(obstacles: Sequence[Obstacle], name: str, floor: float) -> HeightLever:
    """What can be done about the height of an obstacle, all parts of one name together."""
    parts = [item for item in obstacles if item.name == name]
    bottom = min(item.position_world[2] - item.size[2] / 2 for item in parts)
    hangs = bottom > floor + 0.05
    return HeightLever(name, hangs, FARTHEST if hangs else max(p.size[2] for p in parts))


def _moved(axis: int, amount: float, places: Sequence[Place]) -> str:
    far = f"{1000 * abs(amount):.0f} mm"
    if axis == X:
        return f"{far} {'nearer to' if amount < 0 else 'away from'} the arm"
    first, last = places[0].position_world, places[-1].position_world
    left = 1.0 if first[1] > last[1] else -1.0
    return f"{far} to the {'left' if amount * left > 0 else 'right'}"


def _with_obstacle(table: Table, name: str, change: object) -> Table:
    assert callable(change)
    parts = tuple(change(item) if item.name == name else item for item in table.obstacles)
    return replace(table, obstacles=parts)
