# SPDX-License-Identifier: Apache-2.0
"""Arrangements of blocks on places as single integers, and moves of many of them at once.

An arrangement is first a *word*: the symbols from the first place to the last, each stack from the
bottom, with a wall between two places. Its *key* holds the symbols in the lowest bits, and above
them, for every place but the last, how many blocks stand on it and on those before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Keys = NDArray[np.uint64]
#: Shape (arrangements, blocks + places - 1); symbols from 0, and WALL.
Words = NDArray[np.uint8]

WALL: Final = 255
#: Bits of a key.
KEY_BITS: Final = 64


@dataclass(frozen=True)
class Packing:
    """How keys are laid out.

    Attributes:
        places, blocks: of every arrangement.
        symbols: how many different ones there are.
    """

    places: int
    blocks: int
    symbols: int

    @property
    def width(self) -> int:
        """Bits of a symbol."""
        return (self.symbols - 1).bit_length()

    @property
    def end_width(self) -> int:
        """Bits of a number of blocks."""
        return self.blocks.bit_length()

    @property
    def bits(self) -> int:
        """Bits of a key; what is above them stays as it is when blocks are moved."""
        return self.blocks * self.width + (self.places - 1) * self.end_width

    def pack(self, words: Words) -> Keys:
        """One key a word."""
        walls = words == WALL
        keys = np.zeros(len(words), np.uint64)
        symbols = words[~walls].reshape(len(words), self.blocks)
        for position in range(self.blocks if self.width else 0):
            keys |= symbols[:, position].astype(np.uint64) << np.uint64(position * self.width)
        ends = np.nonzero(walls)[1].reshape(len(words), self.places - 1)
        for place in range(self.places - 1):
            shift = self.blocks * self.width + place * self.end_width
            keys |= (ends[:, place] - place).astype(np.uint64) << np.uint64(shift)
        return keys

    def stacks(self, key: int) -> list[list[int]]:
        """The symbols of one key by place, from the bottom."""
        mask = (1 << self.width) - 1
        symbols = [key >> position * self.width & mask for position in range(self.blocks)]
        above = key >> self.blocks * self.width
        mask = (1 << self.end_width) - 1
        ends = [above >> place * self.end_width & mask for place in range(self.places - 1)]
        return [symbols[a:b] for a, b in zip([0, *ends], [*ends, self.blocks])]

    def ends(self, keys: Keys) -> list[Keys]:
        """For every place: the blocks on it and on those before it; a 0 first."""
        mask = np.uint64((1 << self.end_width) - 1)
        shifts = [
            np.uint64(self.blocks * self.width + place * self.end_width)
            for place in range(self.places - 1)
        ]
        inner = [keys >> shift & mask for shift in shifts]
        return [np.zeros_like(keys), *inner, np.full_like(keys, self.blocks)]

    def tops(self, keys: Keys, ends: Sequence[Keys], source: int) -> NDArray[np.uint8]:
        """The symbols on top of stacks that are not empty."""
        shift = (ends[source + 1] - np.uint64(1)) * np.uint64(self.width)
        return (keys >> shift & np.uint64((1 << self.width) - 1)).astype(np.uint8)

    def move(self, keys: Keys, ends: Sequence[Keys], source: int, target: int) -> Keys:
        """The keys after a move from stacks that are not empty."""
        width, one = np.uint64(self.width), np.uint64(1)
        ends_change = sum(
            1 << self.blocks * self.width + place * self.end_width
            for place in range(min(source, target), max(source, target))
        )
        if self.width == 0:
            moved = keys
        elif source < target:
            # The blocks between the one that is moved and where it goes to slip down by one.
            start = (ends[source + 1] - one) * width
            end = (ends[target + 1] - one) * width
            block = keys >> start & np.uint64((1 << self.width) - 1)
            between = (keys >> start + width) & ((one << end - start) - one)
            outside = keys & ~(((one << end + width - start) - one) << start)
            moved = outside | between << start | block << end
        else:
            start = ends[target + 1] * width
            end = (ends[source + 1] - one) * width
            block = keys >> end & np.uint64((1 << self.width) - 1)
            between = (keys >> start) & ((one << end - start) - one)
            outside = keys & ~(((one << end + width - start) - one) << start)
            moved = outside | block << start | between << start + width
        change = np.uint64(ends_change)
        return moved - change if source < target else moved + change


def inserted(words: Words, symbol: int) -> Words:
    """Every word with one symbol more, in every position."""
    count, length = words.shape
    result = np.empty((length + 1, count, length + 1), np.uint8)
    for position in range(length + 1):
        result[position, :, :position] = words[:, :position]
        result[position, :, position] = symbol
        result[position, :, position + 1 :] = words[:, position:]
    return result.reshape(-1, length + 1)


def inserted_like(words: Words, symbol: int) -> Words:
    """Every word with one more of a symbol that may be there already, none made twice."""
    count, length = words.shape
    # Only behind the last one of its kind.
    like = words == symbol
    first = np.where(like.any(axis=1), length - np.argmax(like[:, ::-1], axis=1), 0)
    result = inserted(words, symbol).reshape(length + 1, count, length + 1)
    return np.concatenate([result[place][first <= place] for place in range(length + 1)])


def empty_word(places: int) -> Words:
    """The one arrangement of no blocks."""
    return np.full((1, places - 1), WALL, np.uint8)


def word_of(stacks: Sequence[Sequence[int]]) -> Words:
    """One arrangement, given as symbols by place from the bottom."""
    word: list[int] = []
    for stack in stacks:
        word += [*stack, WALL]
    return np.array([word[:-1]], np.uint8)


def spots(words: Words, symbols: Sequence[int]) -> tuple[NDArray[np.int8], NDArray[np.int8]]:
    """Place and level of symbols that are once in every word; each of shape (symbols, words)."""
    rows = np.arange(len(words))
    walls = words == WALL
    places = np.cumsum(walls, axis=1, dtype=np.int8)
    indices = np.arange(words.shape[1], dtype=np.int16)
    starts = np.maximum.accumulate(np.where(walls, indices + 1, 0), axis=1)
    stack = np.empty((len(symbols), len(words)), np.int8)
    level = np.empty_like(stack)
    for row, symbol in enumerate(symbols):
        position = np.argmax(words == symbol, axis=1)
        stack[row] = places[rows, position]
        level[row] = position - starts[rows, position]
    return stack, level
