# SPDX-License-Identifier: Apache-2.0
"""A plan by hand: blocks are put to their last place one after the other, the lowest first."""

from __future__ import annotations

import random

from scene_graph import Move, Stacks


def constructed(initial: Stacks, target: Stacks, rng: random.Random) -> list[Move]:
    """Moves from one state to another, on three places or more; always some, seldom the fewest.

    The next block is one that costs the fewest moves; what is in the way goes where it covers what
    is needed latest. Equal choices are drawn from ``rng``, a few others as well.
    """
    return _Construction(initial, target, rng).moves()


class _Construction:
    def __init__(self, initial: Stacks, target: Stacks, rng: random.Random) -> None:
        self._stacks = [list(stack) for stack in initial]
        self._target = target
        self._rng = rng
        self._moves: list[Move] = []
        self._settled = [0] * len(target)
        #: How deep a block stands at the end: the deeper, the sooner it is needed.
        self._depth = {name: level for stack in target for level, name in enumerate(stack)}

    def moves(self) -> list[Move]:
        """All of them."""
        places = range(len(self._target))
        while True:
            for place in places:
                self._settle(place)
            open_places = [
                place for place in places if self._settled[place] < len(self._target[place])
            ]
            if not open_places:
                return self._moves
            self._fetch(min(open_places, key=lambda place: self._cost(place) + self._chance()))

    def _settle(self, place: int) -> None:
        stack, target = self._stacks[place], self._target[place]
        level = self._settled[place]
        while level < min(len(stack), len(target)) and stack[level] == target[level]:
            level += 1
        self._settled[place] = level

    def _chance(self) -> float:
        return self._rng.random() * 2.5

    def _cost(self, place: int) -> int:
        block = self._target[place][self._settled[place]]
        here = self._place_of(block)
        above = len(self._stacks[here]) - 1 - self._stacks[here].index(block)
        if here == place:
            return len(self._stacks[place]) - self._settled[place] + 1
        return above + len(self._stacks[place]) - self._settled[place] + 1

    def _fetch(self, place: int) -> None:
        """Puts the next block of a place there."""
        block = self._target[place][self._settled[place]]
        here = self._place_of(block)
        while self._stacks[here][-1] != block:
            self._put_aside(here, {place})
        if here == place:
            self._put_aside(here, set())
            here = self._place_of(block)
        while len(self._stacks[place]) > self._settled[place]:
            self._put_aside(place, {here})
        self._move(here, place)

    def _put_aside(self, source: int, not_onto: set[int]) -> None:
        """Home where possible, else where it covers what is needed latest."""
        block = self._stacks[source][-1]
        others = [
            place for place in range(len(self._stacks)) if place != source and place not in not_onto
        ]

        def badness(place: int) -> float:
            stack, settled = self._stacks[place], self._settled[place]
            free = stack[settled:]
            if not free and settled < len(self._target[place]):
                if self._target[place][settled] == block:
                    return -100.0
                # It would cover a place that waits for its next block.
                return 4.0 + self._chance()
            soonest = min((self._depth[name] for name in free), default=99)
            return (3.0 if soonest < self._depth[block] else 0.0) + self._chance()

        self._move(source, min(others, key=badness))

    def _move(self, source: int, target: int) -> None:
        self._stacks[target].append(self._stacks[source].pop())
        self._settled[source] = min(self._settled[source], len(self._stacks[source]))
        self._settle(target)
        self._moves.append(Move(source, target))

    def _place_of(self, block: str) -> int:
        return next(place for place, stack in enumerate(self._stacks) if block in stack)
