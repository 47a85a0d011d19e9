# SPDX-License-Identifier: Apache-2.0
"""Patterns: all arrangements of a few blocks as if there were no others, and their distances.

A plan for all blocks, with the moves of the others left out, is a plan for a few of them. So the
moves that each of several groups of blocks needs by itself add up to a bound on the moves that all
need (an additive pattern database). The arrangements and the moves between them are the same for
every problem, so that they are made once; the distances to a goal take a millisecond.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, perm
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .packed import Keys, Packing, Words, empty_word, inserted, inserted_like, spots

#: The distance of what cannot be reached.
FAR: Final = 255

Distances = NDArray[np.uint8]


def pattern_count(places: int, blocks: int, like: int) -> int:
    """Arrangements of blocks, ``like`` of which are not told apart."""
    return perm(blocks, blocks - like) * comb(blocks + places - 1, places - 1)


class PatternSpace:
    """All arrangements of a few blocks; the symbol behind the named ones is that of the others.

    Attributes:
        packing, keys: of the arrangements, in ascending order.
        moves: for a move (p, q) in row p * places + q, the arrangement after it; the same one
            where there is nothing to move.
        stack, level: place and level of every named block; shape (named, arrangements).
    """

    def __init__(self, places: int, named: int, like: int) -> None:
        self.places, self.named, self.like = places, named, like
        blocks = named + like
        self.packing = Packing(places, blocks, named + (like > 0))
        words = empty_word(places)
        for symbol in range(named):
            words = inserted(words, symbol)
        for _ in range(like):
            words = inserted_like(words, named)
        keys = self.packing.pack(words)
        order = np.argsort(keys)
        self.keys: Keys = keys[order]
        self.stack, self.level = spots(words[order], range(named))
        self.moves = self._make_moves()
        self._canonical: dict[tuple[int, ...], Distances] = {}

    def __len__(self) -> int:
        return len(self.keys)

    @property
    def bits(self) -> int:
        """Bits of the index of an arrangement."""
        return (len(self) - 1).bit_length()

    def index(self, words: Words) -> NDArray[np.intp]:
        """The indices of arrangements given as words."""
        return np.searchsorted(self.keys, self.packing.pack(words))

    def distances(self, goals: NDArray[np.intp]) -> Distances:
        """For every arrangement the moves to the nearest of some, or FAR."""
        result = np.full(len(self), FAR, np.uint8)
        result[goals] = 0
        layer, depth = goals, 0
        while len(layer):
            depth += 1
            # In the rows of moves, which are few but long, the layer is gathered row by row.
            near = self.moves[:, layer].ravel()
            result[near[result[near] == FAR]] = depth
            layer = np.flatnonzero(result == depth)
        return result

    def canonical_distances(self, heights: tuple[int, ...]) -> Distances:
        """To the arrangement whose symbols ascend from place to place, with these heights."""
        if heights not in self._canonical:
            stacks = np.split(np.arange(self.named), np.cumsum(heights)[:-1])
            key = np.uint64(0)
            position = 0
            for place, stack in enumerate(stacks):
                for symbol in stack:
                    key |= np.uint64(int(symbol) << position * self.packing.width)
                    position += 1
                if place < self.places - 1:
                    shift = self.packing.blocks * self.packing.width
                    key |= np.uint64(position << shift + place * self.packing.end_width)
            self._canonical[heights] = self.distances(np.searchsorted(self.keys, [key]))
        return self._canonical[heights]

    def _make_moves(self) -> NDArray[np.int32]:
        places = self.places
        moves = np.empty((places * places, len(self)), np.int32)
        moves[:] = np.arange(len(self))
        ends = self.packing.ends(self.keys)
        for source in range(places):
            rows = np.flatnonzero(ends[source + 1] > ends[source])
            keys, ours = self.keys[rows], [end[rows] for end in ends]
            for target in range(places):
                if target != source:
                    moved = self.packing.move(keys, ours, source, target)
                    moves[source * places + target, rows] = np.searchsorted(self.keys, moved)
        return moves


@lru_cache(maxsize=32)
def pattern_space(places: int, named: int, like: int) -> PatternSpace:
    """The space, made at the first call."""
    return PatternSpace(places, named, like)
