# SPDX-License-Identifier: Apache-2.0
"""What a goal says of any set of blocks, with all that follows from its relations.

A condition on two blocks that still holds when other blocks are taken out of their stacks can be
asked of a part of the blocks alone: a block directly on another one, above another one, or on a
place that goes with the other one's place. That is what makes bounds of parts possible.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scene_graph import ABOVE, LEFT, NOT, PREDICATES, UP, Relation, base_index, base_name

from ..goals.goal import Count
from .state import Problem

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Exact:
    """A relation whose truth depends on levels in a way that only whole states can tell.

    Attributes:
        subject, object: indices of blocks, or of places behind them.
        table: its truth by place and level, from the base's, of both.
    """

    subject: int
    object: int
    table: Flags


@dataclass(frozen=True)
class Counted:
    """Relations of which ``least`` to ``most`` have to hold, which only whole states can tell."""

    relations: tuple[Exact, ...]
    least: int
    most: int


class Wanted:
    """The relations of a goal, closed under what follows from them; and its counts, as they are.

    Blocks are counted in the order of ``problem.symbols``; behind them come the places.

    Attributes:
        blocks: how many the goal mentions.
        possible: False if no arrangement can fulfil them; True proves nothing.
        linked: for two blocks, how closely the goal ties them: 3 directly on, 2 above, 1 some
            condition on their places, 0 nothing.
    """

    def __init__(self, problem: Problem) -> None:
        self._places = len(problem.start)
        self._spot = problem.goal.rows.spot
        column = np.array([self._spot(place, -1).column for place in range(self._places)])
        self._left = column[:, None] < column[None]
        self.blocks = len(problem.symbols)
        self._height = sum(map(len, problem.start))
        self.possible = True
        size = self.blocks + self._places
        self._on = np.zeros((size, size), np.bool_)
        self._over = np.zeros((size, size), np.bool_)
        self._never_over = np.zeros((size, size), np.bool_)
        self._exact: list[Exact] = []
        beside: list[tuple[int, int, Flags]] = []
        self._index = {name: index for index, name in enumerate(problem.symbols)}
        for relation in problem.goal.relations:
            self._read(relation, beside)
        self._counts = tuple(map(self._counted, problem.goal.counts))
        self._close_over()
        self._close_places(beside)
        if self.possible and not self._over.diagonal().any():
            self.possible = not self._over[self.blocks :].any()
            self.possible &= not (self._over & self._never_over).any()
        else:
            self.possible = False
        self.linked = self._links()

    @property
    def exact(self) -> tuple[Exact, ...]:
        """What is asked of whole states only."""
        return tuple(self._exact)

    def relations_among(self, names: Collection[str]) -> tuple[Relation, ...]:
        """What follows for some of the blocks alone, as relations.

        Conditions on places that are neither of these are left out.
        """
        blocks = [(index, name) for name, index in self._index.items() if name in names]
        bases = [(self.blocks + place, base_name(place)) for place in range(self._places)]
        found = []
        for one, name in blocks:
            for other, below in [*blocks, *bases]:
                if self._on[one, other]:
                    found.append(Relation(name, UP, below))
                elif self._over[one, other]:
                    found.append(Relation(name, ABOVE, below))
                elif other < self.blocks:
                    allowed = self._allowed[self._class[one], self._class[other]]
                    if not (allowed & ~self._left).any():
                        found.append(Relation(name, LEFT, below))
        return tuple(found)

    def pinned(self, block: int) -> int:
        """How closely the goal ties a block to a place, as in ``linked``."""
        if self._on[block, self.blocks :].any():
            return 3
        return 2 * int(self._over[block, self.blocks :].any())

    def holds_among(
        self, blocks: Sequence[int], stack: NDArray[np.int8], level: NDArray[np.int8]
    ) -> Flags:
        """Which arrangements of some of the blocks fulfil all that is said of these alone.

        Args:
            stack, level: shape (blocks, arrangements), rows in the order of ``blocks``.
        """
        mask = np.ones(stack.shape[1], np.bool_)
        if not self.possible:
            return ~mask
        base = self.blocks
        for row, block in enumerate(blocks):
            domain = self._allowed[self._class[block], self._class[block]].diagonal()
            if not domain.all():
                mask &= domain[stack[row]]
            if self._on[block, base:].any():
                mask &= level[row] == 0
            for other_row, other in enumerate(blocks):
                if self._on[block, other]:
                    mask &= level[row] == level[other_row] + 1
                if self._over[block, other]:
                    mask &= (stack[row] == stack[other_row]) & (level[row] > level[other_row])
                    continue
                if self._never_over[block, other]:
                    mask &= (stack[row] != stack[other_row]) | (level[row] < level[other_row])
                if block < other and not self._over[other, block]:
                    allowed = self._allowed[self._class[block], self._class[other]]
                    if not allowed.all():
                        mask &= allowed[stack[row], stack[other_row]]
        return mask

    def holds(self, stack: NDArray[np.int8], level: NDArray[np.int8]) -> Flags:
        """Which whole states are goals; rows are all the blocks that the goal mentions."""
        mask = self.holds_among(range(self.blocks), stack, level)
        count = stack.shape[1]
        places = np.repeat(np.arange(self._places, dtype=np.int8)[:, None], count, axis=1)
        stack = np.concatenate([stack, places])
        level = np.concatenate([level, np.full_like(places, -1)])

        def true(item: Exact) -> Flags:
            one, other = item.subject, item.object
            return item.table[stack[one], level[one] + 1, stack[other], level[other] + 1]

        for item in self._exact:
            mask &= true(item)
        for counted in self._counts:
            number = sum((true(item).astype(np.int16) for item in counted.relations), start=0)
            mask &= (number >= counted.least) & (number <= counted.most)
        return mask

    def _counted(self, count: Count) -> Counted:
        found = []
        for relation in count.relations:
            subject, object_ = self._node(relation.subject), self._node(relation.object)
            # What is not there fulfils nothing.
            if subject is not None and object_ is not None:
                found.append(Exact(subject, object_, self._truth(relation, subject, object_)))
        return Counted(tuple(found), count.least, count.most)

    def _node(self, name: str) -> int | None:
        index = base_index(name)
        if index is None:
            return self._index.get(name)
        return self.blocks + index if index < self._places else None

    def _read(self, relation: Relation, beside: list[tuple[int, int, Flags]]) -> None:
        subject, object_ = self._node(relation.subject), self._node(relation.object)
        if subject is None or object_ is None:
            self.possible = False
        elif relation.predicate in (UP, ABOVE):
            self._over[subject, object_] = True
            self._on[subject, object_] |= relation.predicate == UP
        elif relation.predicate == LEFT:
            beside.append((subject, object_, self._left))
        elif relation.predicate == NOT + ABOVE and max(subject, object_) < self.blocks:
            self._never_over[subject, object_] = subject != object_
        else:
            table = self._truth(relation, subject, object_)
            # Of the places alone: whether any levels fulfil it.
            places_only = np.asarray(table.any(axis=(1, 3)))
            beside.append((subject, object_, places_only))
            levels = [
                range(1, self._height + 1) if node < self.blocks else [0]
                for node in (subject, object_)
            ]
            every = range(self._places)
            possible = table[np.ix_(every, levels[0], every, levels[1])]
            if (possible != places_only[:, None, :, None]).any():
                self._exact.append(Exact(subject, object_, table))

    def _truth(self, relation: Relation, subject: int, object_: int) -> Flags:
        """The predicate's meaning at all spots that the two can have."""
        holds = PREDICATES[relation.predicate].holds
        size = self._height + 1
        table = np.zeros((self._places, size, self._places, size), np.bool_)
        ours, theirs = (
            [
                self._spot(place, level)
                for place in range(self._places)
                for level in range(self._height)
            ]
            if node < self.blocks
            else [self._spot(node - self.blocks, -1)]
            for node in (subject, object_)
        )
        for one in ours:
            for other in theirs:
                if (one == other) == (subject == object_):
                    table[one.stack, one.level + 1, other.stack, other.level + 1] = holds(
                        one, other
                    )
        return table

    def _close_over(self) -> None:
        """Transitively, and: nothing fits between two of which one is directly on the other."""
        on, over, blocks = self._on, self._over, self.blocks
        while True:
            known = over.copy()
            over |= _product(over, over)
            for upper, lower in zip(*np.nonzero(on)):
                others = over[:, lower].copy()
                others[upper] = False
                over[others, upper] = True
                others = over[upper].copy()
                others[lower] = False
                over[lower, others] = True
            # Who shares a stack with a block also stands on that stack's base.
            together = self._together()
            over[:blocks, blocks:] |= together[:blocks, blocks:]
            if (over == known).all():
                break
        # The bases of two places are never in one stack.
        below = over[:blocks, blocks:]
        if (below.sum(axis=1) > 1).any() or over[blocks:].any():
            self.possible = False

    def _together(self) -> Flags:
        """Which blocks and bases are in one stack."""
        together = self._over | self._over.T | np.eye(len(self._over), dtype=np.bool_)
        while not ((more := together | _product(together, together)) == together).all():
            together = more
        return together

    def _close_places(self, beside: list[tuple[int, int, Flags]]) -> None:
        """For any two stacks that the goal speaks of, the pairs of places they may stand on."""
        places, blocks = self._places, self.blocks
        self._class = np.argmax(self._together(), axis=1)
        classes, self._class = np.unique(self._class, return_inverse=True)
        count = len(classes)
        allowed = np.ones((count, count, places, places), np.bool_)
        same = np.arange(count)
        allowed[same, same] = np.eye(places, dtype=np.bool_)
        for place in range(places):
            here = self._class[blocks + place]
            allowed[here, here] &= np.arange(places) == place
        for subject, object_, table in beside:
            one, other = self._class[subject], self._class[object_]
            allowed[one, other] &= table
            allowed[other, one] &= table.T
        while True:
            known = allowed.copy()
            for middle in range(count):
                into = allowed[:, middle].astype(np.float32)
                onward = allowed[middle].astype(np.float32)
                through = np.tensordot(into, onward, axes=(2, 1)) > 0
                allowed &= through.transpose(0, 2, 1, 3)
            if (allowed == known).all():
                break
        self._allowed = allowed
        if not allowed.any(axis=(2, 3)).all():
            self.possible = False

    def _links(self) -> NDArray[np.int8]:
        blocks = self.blocks
        on, over = self._on[:blocks, :blocks], self._over[:blocks, :blocks]
        ours = self._class[:blocks]
        beside = ~np.asarray(self._allowed.all(axis=(2, 3)))[np.ix_(ours, ours)]
        return np.maximum.reduce([3 * (on | on.T), 2 * (over | over.T), 1 * beside]).astype(np.int8)


def _product(one: Flags, other: Flags) -> Flags:
    return (one.astype(np.uint8) @ other.astype(np.uint8)) > 0
