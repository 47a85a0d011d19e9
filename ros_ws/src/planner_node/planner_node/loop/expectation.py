# SPDX-License-Identifier: Apache-2.0
"""Where the blocks are at a step of a plan, if all goes well."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from scene_graph import SceneObject, base_name

from .plan import Plan

#: A block that has not been seen since it was put down may be this far beside what it stands on:
#: the motion node puts it nearer to the middle of its place where it may overhang [m].
PLACED_TOLERANCE: Final = 0.025
#: One that was seen stands where it was seen, to this; an open hand takes it all the same [m].
RESTING_TOLERANCE: Final = 0.015
#: One that stands where it stood but for this has been moved a little, and is taken from there [m].
NUDGED: Final = 0.05
#: Of a height, which follows from the blocks beneath [m].
HEIGHT_TOLERANCE: Final = 0.015

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Rest:
    """Where a block is to rest.

    Attributes:
        stack: index of its place.
        support: what it is to stand on: a block, or the base of its place.
        position_world: of its centre [m].
        tolerance: horizontal, of its centre [m].
        height: of the block [m].
        moves: how many moves of the plan have placed it; tells its rests apart.
    """

    stack: int
    support: str
    position_world: Point
    tolerance: float
    height: float
    moves: int

    def nearly_holds(self, position_world: Point) -> bool:
        """Whether a block there has been moved a little, before the plan has moved it."""
        dx, dy, dz = (a - b for a, b in zip(position_world, self.position_world))
        away = (dx * dx + dy * dy) ** 0.5
        return self.moves == 0 and away <= NUDGED and abs(dz) <= HEIGHT_TOLERANCE

    def holds(self, position_world: Point) -> bool:
        """Whether a block that is seen there is where it is to rest."""
        dx, dy, dz = (a - b for a, b in zip(position_world, self.position_world))
        return (dx * dx + dy * dy) ** 0.5 <= self.tolerance and abs(dz) <= HEIGHT_TOLERANCE


class Expectation:
    """Where the blocks of a plan are at each of its steps, see :class:`.timeline.Timeline`.

    Blocks that were not moved stand where the plan's scene has them, and one that was moved where
    it was first seen afterwards, so that what is compared is only what was measured.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._objects = {item.name: item for item in plan.scene.graph.objects}
        self._seen: dict[tuple[str, int], Point] = {
            (item.name, 0): item.position_world for item in plan.scene.graph.objects
        }

    def at(self, step: int) -> dict[str, Rest | None]:
        """Where each block is to rest; None for the one that is on its way."""
        plan = self._plan
        done, under_way = (step + 1) // 2, step // 2
        loose = plan.blocks[under_way] if step % 2 else ""
        rests: dict[str, Rest | None] = {}
        for index, stack in enumerate(plan.states[done]):
            support = base_name(index)
            x, y, top = plan.scene.graph.places[index].position_world
            for name in stack:
                rest = self._rest(name, done, index, support, (x, y, top))
                rests[name] = None if name == loose else rest
                x, y, top = rest.position_world
                top += 0.5 * self._objects[name].size[2]
                support = name
        return rests

    def picked(self, step: int) -> str:
        """The block that is about to be taken; empty while none is."""
        blocks = self._plan.blocks
        return "" if step % 2 or step >= 2 * len(blocks) else blocks[step // 2]

    def learn(self, item: SceneObject, rest: Rest) -> None:
        """A block is seen where it is to rest: from now on it is expected just there."""
        self._seen.setdefault((item.name, rest.moves), item.position_world)

    def move(self, item: SceneObject) -> None:
        """A block that the plan has not moved yet stands a little elsewhere from now on."""
        self._seen[(item.name, 0)] = item.position_world

    def _rest(self, name: str, done: int, stack: int, support: str, beneath: Point) -> Rest:
        moves = self._plan.blocks[:done].count(name)
        height = self._objects[name].size[2]
        if (seen := self._seen.get((name, moves))) is not None:
            return Rest(stack, support, seen, RESTING_TOLERANCE, height, moves)
        x, y, top = beneath
        centre = (x, y, top + 0.5 * height)
        return Rest(stack, support, centre, PLACED_TOLERANCE, height, moves)
