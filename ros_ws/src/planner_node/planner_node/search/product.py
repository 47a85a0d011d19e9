# SPDX-License-Identifier: Apache-2.0
"""States as one integer each: a pattern for every group, and how the groups' blocks interleave."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move

from .groups import Group
from .packed import KEY_BITS, WALL, Keys, Packing, Words
from .patterns import Distances, pattern_count, pattern_space

#: The word's symbol for a block that the goal does not mention.
LIKE = 254


class ProductSpace:
    """The states of one problem as keys that numpy can move, compare and bound by the million.

    The lowest bits say of which group every block is, the indices of the groups' patterns follow.
    """

    def __init__(self, places: int, groups: Sequence[Group]) -> None:
        self.places, self.groups = places, tuple(groups)
        self.spaces = [pattern_space(places, len(item.named), item.like) for item in groups]
        blocks = sum(len(item.named) + item.like for item in groups)
        self._colours = Packing(places, blocks, len(groups))
        self._shifts: list[np.uint64] = []
        self._masks: list[np.uint64] = []
        bits = self._colours.bits
        for space in self.spaces:
            self._shifts.append(np.uint64(bits))
            self._masks.append(np.uint64((1 << space.bits) - 1))
            bits += space.bits

    @staticmethod
    def fits(places: int, groups: Sequence[Group]) -> bool:
        """Whether the states of such groups fit into keys."""
        blocks = sum(len(item.named) + item.like for item in groups)
        bits = Packing(places, blocks, len(groups)).bits
        for item in groups:
            size = len(item.named) + item.like
            bits += (pattern_count(places, size, item.like) - 1).bit_length()
        return bits <= KEY_BITS

    def indices(self, words: Words) -> list[NDArray[np.intp]]:
        """For every group the patterns of states given as words."""
        result = []
        for group, space in zip(self.groups, self.spaces):
            symbols = np.full(256, 253, np.uint8)
            symbols[list(group.named)] = range(len(group.named))
            symbols[WALL] = WALL
            if group.like:
                symbols[LIKE] = space.named
            ours = symbols[words]
            size = len(group.named) + group.like + self.places - 1
            result.append(space.index(ours[ours != 253].reshape(len(words), size)))
        return result

    def pack(self, words: Words) -> Keys:
        """The keys of states given as words."""
        colours = np.zeros(256, np.uint8)
        for number, group in enumerate(self.groups):
            colours[list(group.named)] = number
            if group.like:
                colours[LIKE] = number
        colours[WALL] = WALL
        keys = self._colours.pack(colours[words])
        for shift, index in zip(self._shifts, self.indices(words)):
            keys |= index.astype(np.uint64) << shift
        return keys

    def bound(self, keys: Keys, distances: Sequence[Distances]) -> NDArray[np.int16]:
        """The groups' distances, added up."""
        parts = [table[index] for table, index in zip(distances, self._patterns(keys))]
        return np.add.reduce([part.astype(np.int16) for part in parts])

    def after_moves(self, keys: Keys, distances: Sequence[Distances], at_most: int) -> list[Keys]:
        """The states after every move whose bound is not above ``at_most``; some twice."""
        found = []
        patterns = self._patterns(keys)
        bounds = [table[index].astype(np.int16) for table, index in zip(distances, patterns)]
        bound = np.add.reduce(bounds)
        ends = self._colours.ends(keys)
        for source in range(self.places):
            some = ends[source + 1] > ends[source]
            if len(self.groups) > 1:
                colours = self._colours.tops(keys, ends, source)
            for number, space in enumerate(self.spaces):
                ours = some & (colours == number) if len(self.groups) > 1 else some
                rows = np.flatnonzero(ours)
                if not len(rows):
                    continue
                index = patterns[number][rows]
                # What the moved block's group may need at most, given what the others need.
                left = at_most - (bound[rows] - bounds[number][rows])
                for target in range(self.places):
                    if target == source:
                        continue
                    moved = space.moves[source * self.places + target][index]
                    kept = np.flatnonzero(distances[number][moved] <= left)
                    if not len(kept):
                        continue
                    chosen = rows[kept]
                    after = self._colours.move(
                        keys[chosen], [end[chosen] for end in ends], source, target
                    )
                    shift = self._shifts[number]
                    after &= ~(self._masks[number] << shift)
                    after |= moved[kept].astype(np.uint64) << shift
                    found.append(after)
        return found

    def moves(self, key: np.uint64) -> Iterator[tuple[Move, np.uint64]]:
        """Every move from a state with the state after it."""
        keys = np.array([key], np.uint64)
        patterns = self._patterns(keys)
        ends = self._colours.ends(keys)
        for source in range(self.places):
            if ends[source + 1][0] == ends[source][0]:
                continue
            number = 0
            if len(self.groups) > 1:
                number = int(self._colours.tops(keys, ends, source)[0])
            for target in range(self.places):
                if target == source:
                    continue
                moved = self.spaces[number].moves[source * self.places + target][patterns[number]]
                after = self._colours.move(keys, ends, source, target)
                shift = self._shifts[number]
                after &= ~(self._masks[number] << shift)
                after |= moved.astype(np.uint64) << shift
                yield Move(source, target), after[0]

    def stacks(self, key: np.uint64) -> list[list[int]]:
        """The blocks of a state by place: indices of those that are named, LIKE for others."""
        left = []
        for group, space, pattern in zip(
            self.groups, self.spaces, self._patterns(np.array([key], np.uint64))
        ):
            named = [*group.named, LIKE]
            stacks = space.packing.stacks(int(space.keys[pattern[0]]))
            left.append([[named[symbol] for symbol in stack][::-1] for stack in stacks])
        return [
            [left[colour][place].pop() for colour in stack]
            for place, stack in enumerate(self._colours.stacks(int(key)))
        ]

    def _patterns(self, keys: Keys) -> list[NDArray[np.intp]]:
        return [
            (keys >> shift & mask).astype(np.intp) for shift, mask in zip(self._shifts, self._masks)
        ]
