# SPDX-License-Identifier: Apache-2.0
"""Why a motion cannot be, turned round: the smallest change with which it can.

What a bound violates is solved once more with the things that a person can change set free (one
elastic problem, :mod:`motion_node.nlp.elastic`). A change is told only after the whole plan has
been solved anew on the changed table, and the independent check has no objection to its trajectory.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from heapq import heapify, heappop, heappush
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move, SceneGraph

from ..blocks import read_scene
from ..dense_check import check as dense_check
from ..errors import PATH, InfeasibleError
from ..planner import MotionPlanner
from ..refining import objection
from .changes import Change, as_can_be_done
from .families import Families
from .levers import HeightLever, Lever, ObstacleLever, Table
from .pulling import pulled
from .tower_lever import TowerLever
from .tries import UNIT, Tries, Try, among

Array = NDArray[np.float64]

#: Added first to a change that should be enough and is not; twice as much the next time [m].
_GROWTH: Final = 0.01
#: Changes that are enough and too little are as good as one if they are this near [m].
_NEAR: Final = 0.005
#: How well is known how far to move what bars a way, where a trial is a whole plan [m].
_ROUGHLY: Final = 0.02
#: So often the way from too little to enough is halved.
_HALVINGS: Final = 4
#: So many changes are checked at most.
_CHECKED: Final = 30
#: Nothing is looked for longer, in time of the processor [s].
PATIENCE: Final = 10.0
#: Nor longer than this on a machine that has a lot else to do [s].
LONGEST: Final = 60.0


@dataclass(frozen=True)
class Suggestion:
    """A change with which a refused plan can be carried out, checked.

    Attributes:
        change: what, and by how much.
        words: the same for a person, such as "move green_box 32 mm to the left".
        table: what the plan was solved on after it.
    """

    change: Change
    words: str
    table: Table


class Suggestions:
    """Finds what would make refused plans feasible.

    Args:
        planner: that refused them; it is back among its own obstacles afterwards.
    """

    def __init__(self, planner: MotionPlanner) -> None:
        self._planner = planner

    def suggest(
        self,
        graph: SceneGraph,
        moves: Sequence[Move],
        arm: Array,
        fingers: Array,
        error: InfeasibleError,
        stopped: Callable[[], bool] = lambda: False,
    ) -> Suggestion | None:
        """The smallest change that was found, checked; None: none was found in time.

        Args:
            error: why ``planner.solve`` refused the same.
            stopped: polled; ends the search.
        """
        table = Table(graph, self._planner.obstacles)
        search = _Search(self._planner, table, moves, arm, fingers)
        begin, worked = time.monotonic(), time.thread_time()

        def over() -> bool:
            late = time.monotonic() - begin > LONGEST
            return late or time.thread_time() - worked > PATIENCE or stopped()

        with among(self._planner, table):
            change = search.smallest(error, over)
        if change is None:
            return None
        return Suggestion(change, change.words(table), change.made(table))


@dataclass(order=True)
class _Open:
    """A change that is not checked yet, the smallest first.

    Attributes:
        mends: the bounds, moves and phases that it is meant for.
        growth: what is added at least if it is not enough [m].
        little: a change of the same levers that is too little.
    """

    size: float
    order: int
    change: Change = field(compare=False)
    mends: frozenset[tuple[str, int, str]] = field(compare=False)
    growth: float = field(default=_GROWTH, compare=False)
    little: Change | None = field(default=None, compare=False)


class _Search:
    """For one refused plan."""

    def __init__(
        self,
        planner: MotionPlanner,
        table: Table,
        moves: Sequence[Move],
        arm: Array,
        fingers: Array,
    ) -> None:
        self._planner, self._table, self._moves = planner, table, moves
        self._arm, self._fingers = arm, fingers
        self._tries = Tries(planner, table, moves, arm)
        self._families = Families(planner, table, moves)

    def smallest(self, error: InfeasibleError, over: Callable[[], bool]) -> Change | None:
        """The smallest change that is found with which the plan can be carried out.

        Candidates are checked in the order of their sizes; one with which something else is
        violated is made larger by what that takes.
        """
        block = self._tries.moved(error, self._table)
        if narrower := self._families.narrower(block):
            first = [narrower]
        else:
            tries = self._tries.of(error, self._table)
            first = list(self._first(error, tries, over))
        what = frozenset({_what(error)})
        waiting = [_Open(c.size, index, c, what) for index, c in enumerate(first)]
        heapify(waiting)
        for count in range(len(first), len(first) + _CHECKED):
            if not waiting or over():
                return None
            here = heappop(waiting)
            table = here.change.made(self._table)
            again = self._refusal(table)
            if again is None:
                return self._less(here, over)
            more, growth = None, here.growth
            by_blocks = all(isinstance(lever, TowerLever) for lever in here.change.levers)
            # Blocks are great steps anyway, and of ways elastic problems take longer than trying.
            if _what(again) not in here.mends and not by_blocks and again.bound != PATH:
                tries = self._tries.of(again, table)
                more = self._mended(here.change.levers, table, tries, here.change, over)
            if more is None or more.beside(here.change) < growth:
                more, growth = here.change.grown(growth), 2 * growth
            if more is not None:
                mends = here.mends | {_what(again)}
                heappush(waiting, _Open(more.size, count, more, mends, growth, here.change))
        return None

    def _first(
        self, error: InfeasibleError, tries: Sequence[Try], over: Callable[[], bool]
    ) -> Iterator[Change]:
        """What may be enough, of each family of levers."""
        families = list(self._families.of(error, tries))
        if error.bound == PATH:
            # What bars a way is far from any solution, and an elastic problem of a way that finds
            # none takes as long as many plans: plans are tried first.
            found = False
            for levers, _ in families:
                if all(isinstance(lever, (HeightLever, ObstacleLever)) for lever in levers) and (
                    change := pulled(levers, self._table, self._feasible, over, (1.0,), _ROUGHLY)
                ):
                    found = True
                    yield change
            for levers, hopeful in () if found else families:
                if change := self._mended(levers, self._table, hopeful, Change((), ()), over):
                    yield change
            return
        for levers, hopeful in families:
            change = self._mended(levers, self._table, hopeful, Change((), ()), over)
            change = change or pulled(
                levers, self._table, lambda table: self._tries.possible(error, table), over
            )
            if change is not None:
                yield change

    def _less(self, here: _Open, over: Callable[[], bool]) -> Change:
        """As little of a change that is enough as a few trials show."""
        enough, little = here.change, here.little
        for _ in range(_HALVINGS):
            if little is None or enough.beside(little) <= _NEAR or over():
                break
            middle = enough.between(little)
            if middle is None:
                break
            if self._refusal(middle.made(self._table)) is None:
                enough = middle
            else:
                little = middle
        return enough

    def _feasible(self, table: Table) -> bool:
        return self._refusal(table) is None

    def _refusal(self, table: Table) -> InfeasibleError | None:
        """Why the plan cannot be carried out on a table; None: it can."""
        planner = self._planner
        with among(planner, table):
            try:
                motion = planner.solve(table.graph, self._moves, self._arm, self._fingers)
            except InfeasibleError as error:
                return error
            scene = read_scene(table.graph)
            around = (planner.model, motion.trajectory, scene, table.obstacles)
            contacts = dense_check(*around, floor=scene.floor).contacts
        return objection(contacts[0]) if contacts else None

    def _mended(
        self,
        levers: Sequence[Lever],
        table: Table,
        tries: Sequence[Try],
        before: Change,
        over: Callable[[], bool],
    ) -> Change | None:
        """A change of a table that mends what was violated there, added to the one before."""
        pulled = before.amounts or (0.0,) * len(levers)
        low, high = np.array([lever.reach for lever in levers]).T
        reach = np.minimum(low - pulled, 0.0), np.maximum(high - pulled, 0.0)
        best: Array | None = None
        for item in tries:
            if over():
                break
            changed = [item.demands_on(lever.pulled(table, UNIT)) for lever in levers]
            amounts = item.least(changed, reach)
            if amounts is None:
                continue
            if best is None or np.abs(amounts).sum() < np.abs(best).sum():
                best = amounts
        if best is None:
            return None
        found = as_can_be_done(levers, (np.array(pulled) + best).tolist())
        return found if found is not None and found.amounts != before.amounts else None


def _what(error: InfeasibleError) -> tuple[str, int, str]:
    return error.bound, error.move, error.phase
