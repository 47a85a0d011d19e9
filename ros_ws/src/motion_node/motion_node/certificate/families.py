# SPDX-License-Identifier: Apache-2.0
"""Which levers may help a refused plan, and which of them are pulled together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from scene_graph import Move, base_index, base_name

from ..blocks import read_scene
from ..errors import PATH, InfeasibleError
from ..phases import PLACE, Phase
from ..planner import MotionPlanner
from .changes import Change, as_can_be_done
from .levers import Lever, ObstacleLever, StackLever, Table, WidthLever, X, Y, height_lever
from .tower_lever import TowerLever
from .tries import Try

#: So many things that are in the way are considered, the first that are found.
_MOST: Final = 4


class Families:
    """Of one refused plan."""

    def __init__(self, planner: MotionPlanner, table: Table, moves: Sequence[Move]) -> None:
        self._planner, self._table, self._moves = planner, table, moves
        self._stacks = table.graph.stacks()
        self._floor = read_scene(table.graph).floor

    def narrower(self, phase: Phase) -> Change | None:
        """For a block that the open fingers do not go around in any way."""
        widest = self._planner.settings.phases.max_grasp_width
        grasp = phase.grasp
        if grasp is None or grasp.width <= widest:
            return None
        item = self._table.graph.object(phase.object_name)
        width, axis = min((item.size[axis], axis) for axis in (0, 1))
        if phase.grasps == 1:  # a prism is taken along its ridge only
            width, axis = min((abs(item.size[a] - grasp.width), a) for a in range(3))
            width = item.size[axis]
        lever = WidthLever(phase.object_name, axis, width)
        return as_can_be_done([lever], [width - widest])

    def _stack(self, index: int) -> tuple[Lever, ...]:
        names = self._stacks[index]
        place = not names or any(move.target == index for move in self._moves)
        return StackLever(index, X, place, names), StackLever(index, Y, place, names)

    def _tower(self, index: int) -> TowerLever | None:
        """The blocks of a stack, where it has any and the plan takes none of them."""
        names = self._stacks[index][::-1]
        if not names or any(move.source == index for move in self._moves):
            return None
        heights = tuple(self._table.graph.object(name).size[2] for name in names)
        return TowerLever(index, names, heights)

    def of(
        self, error: InfeasibleError, tries: Sequence[Try]
    ) -> Iterator[tuple[tuple[Lever, ...], list[Try]]]:
        """Levers that are pulled together, with the elastic problems in which that may be enough.

        What the hand goes to is one, each thing that is in the way, then all of these: enough is
        what has to do with all that a starting point misses.
        """
        move = self._moves[min(error.move, len(self._moves) - 1)]
        ends = (move.source, move.target)
        own = ends[error.phase == PLACE]
        if error.bound != PATH:
            yield self._stack(own), list(tries)
        if error.phase == PLACE and (tower := self._tower(own)):
            yield (tower,), list(tries)
        known = {item.name for item in self._table.obstacles}
        known |= {base_name(i) for i in range(len(self._stacks)) if i not in ends}

        def in_the_way(rows: Sequence[str]) -> dict[str, None]:
            return dict.fromkeys(n for row in rows if (n := row.rpartition(" to ")[2]) in known)

        others = in_the_way([error.constraint, *(row for item in tries for row in item.missed)])

        def enough(*names: str) -> list[Try]:
            return [item for item in tries if set(in_the_way(item.missed)) <= set(names)]

        known_obstacles = {item.name for item in self._table.obstacles}
        obstacles = [name for name in others if name in known_obstacles][:_MOST]
        heights: list[Lever] = [
            height_lever(self._table.obstacles, name, self._floor) for name in obstacles
        ]
        sideways = [(ObstacleLever(name, X), ObstacleLever(name, Y)) for name in obstacles]
        for name, height, pair in zip(obstacles, heights, sideways):
            if alone := enough(name) or (list(tries) if len(obstacles) == 1 else []):
                yield (height,), alone
                yield pair, alone
        if len(obstacles) > 1:
            together = enough(*obstacles) or list(tries)
            yield tuple(heights), together
            yield tuple(lever for pair in sideways for lever in pair), together
        for name in others:
            stack = base_index(name)
            if stack is not None:
                yield self._stack(stack), enough(name) or list(tries)
