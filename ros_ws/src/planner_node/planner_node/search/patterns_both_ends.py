# SPDX-License-Identifier: Apache-2.0
"""From both ends, layer by layer as arrays, without the states that pattern bounds rule out.

For C = bound, bound + 1, …: is there a plan of C moves? Layers grow from the start and from the
goals, the smaller one first; a state stays if its depth and its bound to the other end make C at
most. Where the layers meet at depths that make C is a shortest plan, as C - 1 was not enough. A
state on a plan of C moves is never left out, whether or not the bound is consistent.
"""

from __future__ import annotations

from collections.abc import Sequence, Sized
from itertools import pairwise
from typing import Final

import numpy as np

from scene_graph import Move

from .a_star import a_star
from .breadth_first import breadth_first
from .ends import Ends, prepare
from .limits import Limits
from .packed import Keys, spots, word_of
from .patterns import FAR, Distances
from .state import Problem, State
from .wanted import Wanted

#: States whose successors are made at once: some milliseconds.
CHUNK: Final = 1 << 14
#: Keys that are sorted at once: some tens of milliseconds.
SORTED_AT_ONCE: Final = 1 << 18


def patterns_both_ends(problem: Problem, limits: Limits) -> list[State]:
    """A shortest path; where there are too many blocks for it, that of :func:`a_star`.

    On one or two places there are so few states that breadth-first search is the quickest.
    """
    if len(problem.start) <= 2:
        return breadth_first(problem, limits)
    wanted = Wanted(problem)
    if not wanted.possible:
        raise limits.impossible()
    ends = prepare(problem, wanted, limits)
    if ends is None:
        return a_star(problem, limits)
    return states_along(problem.start, _Search(ends, wanted, limits).moves())


def moves_along(path: Sequence[Sequence[Sized]]) -> list[Move]:
    """The moves between the states of a path, encoded or in names."""
    moves = []
    for before, after in pairwise(path):
        changes = [len(new) - len(old) for old, new in zip(before, after)]
        moves.append(Move(changes.index(-1), changes.index(1)))
    return moves


def states_along(start: State, moves: Sequence[Move]) -> list[State]:
    """The state at the start and after every move."""
    path = [start]
    for move in moves:
        stacks = list(path[-1])
        stacks[move.target] += stacks[move.source][-1]
        stacks[move.source] = stacks[move.source][:-1]
        path.append(tuple(stacks))
    return path


class _Search:
    """One search; ``moves`` runs it."""

    def __init__(self, ends: Ends, wanted: Wanted, limits: Limits) -> None:
        self._ends, self._limits = ends, limits
        self._wanted = wanted
        self._space = ends.space
        self._farthest = sum(int(table[table < FAR].max()) for table in ends.to_goal)

    def moves(self) -> list[Move]:
        """A shortest plan.

        Raises:
            UnreachableError, SearchLimitError, SearchCancelledError: see :class:`Limits`.
        """
        ends = self._ends
        bound = int(self._space.bound(ends.start, ends.to_goal)[0])
        if bound >= FAR:
            raise self._limits.impossible()
        while True:
            self._limits.prove_at_least(bound)
            found = self._meet(bound)
            if found is not None:
                return found
            bound += 1

    def _meet(self, length: int) -> list[Move] | None:
        """A plan of ``length`` moves; None: there is none."""
        ends = self._ends
        near: list[Keys] = [ends.start]
        far: list[Keys] = []
        if ends.goals is not None:
            bounds = self._space.bound(ends.goals, ends.to_start)
            far = [ends.goals[bounds <= length]]
        while True:
            depth = len(near) - 1 + max(len(far) - 1, 0)
            if depth == length:
                return self._joined(near, far)
            forward = not far or len(near[-1]) <= len(far[-1])
            layers = near if forward else far
            if not len(layers[-1]):
                if not far and length - depth >= self._farthest:
                    # Nothing was left out, as no state can have a larger bound.
                    raise self._limits.unreachable()
                return None
            # The last layer is only compared with the other side's, not with its own past.
            meeting = (far if forward else near)[-1] if far and depth + 1 == length else None
            tables = ends.to_goal if forward else ends.to_start
            layers.append(self._next_layer(layers, tables, length - len(layers), meeting))

    def _next_layer(
        self,
        layers: Sequence[Keys],
        tables: Sequence[Distances],
        at_most: int,
        meeting: Keys | None,
    ) -> Keys:
        found: list[Keys] = []
        layer, offset = layers[-1], 0
        while offset < len(layer):
            allowed = self._limits.count_expansions(min(CHUNK, len(layer) - offset))
            chunk = layer[offset : offset + allowed]
            offset += allowed
            after = self._space.after_moves(chunk, tables, at_most)
            if meeting is None:
                found += after
                continue
            for keys in after:
                common = keys[_is_in(keys, meeting)]
                if len(common):
                    return common[:1]
        return _distinct(found, layers[-2:], self._limits)

    def _joined(self, near: Sequence[Keys], far: Sequence[Keys]) -> list[Move] | None:
        """The moves through a state that the last layers share, or to a goal in the last one."""
        if far:
            common = near[-1][_is_in(near[-1], far[-1])]
        else:
            common = near[-1][self._space.bound(near[-1], self._ends.to_goal) == 0]
            common = common[self._are_goals(common)]
        if not len(common):
            return None
        back = [Move(move.target, move.source) for move in self._way(common[0], near)]
        return back[::-1] + self._way(common[0], far)

    def _way(self, key: np.uint64, layers: Sequence[Keys]) -> list[Move]:
        """The moves from a state of the last layer down to one of the first."""
        moves: list[Move] = []
        for layer in reversed(layers[:-1]):
            for move, after in self._space.moves(key):
                if _is_in(np.array([after]), layer)[0]:
                    moves.append(move)
                    key = after
                    break
            else:
                raise AssertionError("a layer holds a state that none before it leads to")
        return moves

    def _are_goals(self, keys: Keys) -> np.ndarray:
        result = np.zeros(len(keys), np.bool_)
        for offset in range(0, len(keys), 256):
            self._limits.poll()
            some = keys[offset : offset + 256]
            words = np.concatenate([word_of(self._space.stacks(key)) for key in some])
            result[offset : offset + 256] = self._wanted.holds(
                *spots(words, range(self._wanted.blocks))
            )
        return result


def _is_in(keys: Keys, layer: Keys) -> np.ndarray:
    """Which keys are in a layer, whose keys ascend."""
    if not len(layer):
        return np.zeros(len(keys), np.bool_)
    places = np.searchsorted(layer, keys)
    places[places == len(layer)] = 0
    return layer[places] == keys


def _distinct(found: Sequence[Keys], known: Sequence[Keys], limits: Limits) -> Keys:
    """The keys in ascending order, once each, without those of the two layers before.

    Every move can be undone, so that a state of an older layer cannot come up again.
    """
    if not found:
        return np.zeros(0, np.uint64)
    keys = np.concatenate(found)
    parts = [keys]
    if len(keys) > SORTED_AT_ONCE:
        sample = np.sort(keys[:: len(keys) // 4096])
        cuts = sample[:: max(1, len(sample) * SORTED_AT_ONCE // len(keys))][1:]
        edges: list[np.uint64 | None] = [None, *cuts, None]
        parts = []
        for low, high in pairwise(edges):
            limits.poll()
            kept = np.ones(len(keys), np.bool_) if low is None else keys >= low
            parts.append(keys[kept if high is None else kept & (keys < high)])
    result = []
    for part in parts:
        limits.poll()
        part = np.unique(part)
        for layer in known:
            part = part[~_is_in(part, layer)]
        result.append(part)
    return np.concatenate(result)
