# SPDX-License-Identifier: Apache-2.0
"""The elastic problems of what a refused plan violates, and where they start."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import islice, product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move

from ..blocks import read_scene
from ..bounds import Keyframes
from ..constraints import Clearances
from ..errors import PATH, InfeasibleError
from ..expand import Choice, expand
from ..nlp import Demand
from ..phases import PLACE, Phase
from ..planner import MotionPlanner
from .levers import Table

Array = NDArray[np.float64]

#: By so much levers are pulled to see what they do [m].
UNIT: Final = 1e-3
#: Starting points of the elastic problem of a switch, and of a way.
_POSE_STARTS: Final = 2
_PATH_STARTS: Final = 2

#: What is asked at the end of a phase, or along it, on a table.
DemandsOn = Callable[[Table], list[Demand]]


@dataclass(frozen=True)
class Try:
    """An elastic problem with a starting point.

    Attributes:
        least: its smallest changes, given the demands after each change and how far each may go.
        demands_on: what is asked on a table.
        missed: what the starting point misses, each row in words.
        same: equal for those that are the same problem from the same start.
    """

    least: Callable[[Sequence[Sequence[Demand]], tuple[Array, Array]], Array | None]
    demands_on: DemandsOn
    missed: list[str]
    same: bytes


class Tries:
    """Of one refused plan.

    Args:
        table: that it was refused on.
    """

    def __init__(
        self, planner: MotionPlanner, table: Table, moves: Sequence[Move], arm: Array
    ) -> None:
        self._planner, self._moves, self._arm = planner, moves, arm
        self._stacks = len(table.graph.places)
        floor = read_scene(table.graph).floor
        self._clear = Clearances(planner.settings.path.margin, floor)

    def moved(self, error: InfeasibleError, table: Table) -> Phase:
        """The phase that takes the block whose move was refused."""
        return self._phases(table, ())[2 * min(error.move, len(self._moves) - 1)]

    def of(self, error: InfeasibleError, table: Table) -> list[Try]:
        """Elastic problems of what was violated on a table, for each way to take the block."""
        move = min(error.move, len(self._moves) - 1)
        block = self.moved(error, table)
        find = self._along_way if error.bound == PATH else self._at_switch
        tries = dict[bytes, Try]()
        for choice in self._choices(block, error.phase):
            choices = [Choice()] * len(self._moves)
            choices[move] = choice
            # A block as deep as wide is put down alike from either side.
            for item in find(error, table, choices):
                tries.setdefault(item.same, item)
        return list(tries.values())

    def possible(self, error: InfeasibleError, table: Table) -> bool:
        """Whether the switch that was refused has a pose on a table, however it is taken."""
        move, keyframes = min(error.move, len(self._moves) - 1), self._keyframes()
        index, seen = 2 * move + (error.phase == PLACE), set[bytes]()
        with among(self._planner, table):
            for choice in self._choices(self.moved(error, table), error.phase):
                choices = [Choice()] * len(self._moves)
                choices[move] = choice
                phase = self._phases(table, choices)[index]
                demands = keyframes.problems.demands([phase], self._clear)
                same = _same(self._arm, demands)
                if same not in seen and keyframes.among.possible(phase, demands):
                    return True
                seen.add(same)
        return False

    def _keyframes(self) -> Keyframes:
        return self._planner.prepare(self._stacks)[0]

    def _at_switch(
        self, error: InfeasibleError, table: Table, choices: Sequence[Choice]
    ) -> Iterator[Try]:
        """The elastic problem of one switch (P1)."""
        index = 2 * error.move + (error.phase == PLACE)
        keyframes = self._keyframes()
        problems = keyframes.problems

        def demands_on(other: Table) -> list[Demand]:
            with among(self._planner, other):
                return problems.demands([self._phases(other, choices)[index]], self._clear)

        phase, demands = self._phases(table, choices)[index], demands_on(table)
        for guess in keyframes.poses.guesses([phase], demands)[0][:_POSE_STARTS]:
            least = partial(problems.least_changes, guess.q, demands, UNIT)
            missed = problems.missed(guess.q, demands, phase)
            yield Try(least, demands_on, missed, _same(guess.q, demands))

    def _along_way(
        self, error: InfeasibleError, table: Table, choices: Sequence[Choice]
    ) -> Iterator[Try]:
        """The elastic problem of one way (P3), its ends as P2 leaves them."""
        phases = self._phases(table, choices)
        keyframes, path = self._planner.prepare(self._stacks)
        index = min(2 * error.move + (error.phase == PLACE), len(phases) - 1)
        with among(self._planner, table):
            ends = self._ends(keyframes, phases, index)
        if ends is None:
            return

        def demands_on(other: Table) -> list[Demand]:
            with among(self._planner, other):
                return path.demands(self._phases(other, choices)[index], ends, self._clear)

        phase, demands = phases[index], demands_on(table)
        for start in islice(path.straight_starts(phase, ends, self._clear), _PATH_STARTS):
            least = partial(path.least_changes, start, demands, UNIT)
            missed = path.missed(start, demands, phase)
            yield Try(least, demands_on, missed, _same(start, demands))

    def _phases(self, table: Table, choices: Sequence[Choice]) -> list[Phase]:
        settings, gripper = self._planner.settings, self._planner.arm.gripper
        scene = read_scene(table.graph)
        return expand(
            scene, self._moves, gripper, settings.phases, settings.squeeze, choices=choices
        )

    def _choices(self, block: Phase, kind: str) -> list[Choice]:
        across = (False, True) if kind == PLACE else (False,)
        return [Choice(grasp, turn) for turn, grasp in product(across, range(block.grasps))]

    def _ends(
        self, keyframes: Keyframes, phases: Sequence[Phase], index: int
    ) -> tuple[Array, Array] | None:
        try:
            way = keyframes.solve(self._arm, phases, self._clear, sampled=True)[index]
        except InfeasibleError:
            return None
        return way.start_q, way.goal_q


def _same(start: Array, demands: Sequence[Demand]) -> bytes:
    arrays = [start, *(a for d in demands for a in (d.parameters, d.lower, d.upper))]
    return b"".join((np.round(array, 4) + 0.0).tobytes() for array in arrays)


@contextmanager
def among(planner: MotionPlanner, table: Table) -> Iterator[None]:
    """The planner among a table's obstacles, for a while."""
    before = planner.obstacles
    if table.obstacles == before or not table.obstacles:
        yield
        return
    planner.surround(table.obstacles)
    try:
        yield
    finally:
        planner.surround(before)
