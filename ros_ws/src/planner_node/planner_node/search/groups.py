# SPDX-License-Identifier: Apache-2.0
"""Which blocks are looked at together: groups whose bounds add up to as much as possible.

All choices are drawn from one fixed sequence, so that the same problem is split the same way.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .packed import Words, spots
from .patterns import pattern_count, pattern_space
from .wanted import Wanted

#: Arrangements of one group: the most that is made without a noticeable wait.
MAX_PATTERNS: Final = 200_000
#: What is large enough to be a good bound and small enough to be made at once.
GOOD_PATTERNS: Final = 22_000
#: Splits that are tried where the goal is complete, and where it is not.
COMPLETE_TRIALS: Final = 500
PARTIAL_TRIALS: Final = 12


@dataclass(frozen=True, order=True)
class Group:
    """Some of the blocks: indices of those that the goal mentions, and how many of the others."""

    named: tuple[int, ...]
    like: int = 0


def group_sizes(places: int, blocks: int, largest: int = GOOD_PATTERNS) -> list[int]:
    """Sizes, as equal as possible, of the fewest groups with patterns of up to that number."""
    size = _largest_size(places, blocks, largest)
    count = max(1, -(-blocks // size))
    return [len(part) for part in np.array_split(np.arange(blocks), count)]


def largest_first(places: int, blocks: int, largest: int = GOOD_PATTERNS) -> list[int]:
    """Sizes of the fewest such groups, each as large as possible before the next."""
    size = _largest_size(places, blocks, largest)
    full, rest = divmod(blocks, size)
    return [size] * full + [rest] * (rest > 0)


def _largest_size(places: int, blocks: int, largest: int) -> int:
    size = 1
    while size < blocks and pattern_count(places, size + 1, 0) <= largest:
        size += 1
    return size


def complete_groups(
    start: Words, target: Words, places: int, sizes: Sequence[int], trials: int = COMPLETE_TRIALS
) -> tuple[tuple[Group, ...], int]:
    """Groups for a goal that says where every block is, with their bound."""
    blocks = sum(sizes)
    splits = np.array(list(_splits(blocks, sizes, trials)))
    order = {name: spots(words, range(blocks)) for name, words in (("a", start), ("b", target))}
    stacks = {name: item[0][:, 0].astype(np.int64) for name, item in order.items()}
    # Along the row, the position of every block; ascending within a stack and from place to place.
    along = {name: stacks[name] * 64 + item[1][:, 0] for name, item in order.items()}
    total = np.zeros(len(splits), np.int64)
    offset = 0
    for size in sizes:
        group = splits[:, offset : offset + size]
        offset += size
        # Named anew in the order of the target, every target is one of a few.
        group = np.take_along_axis(group, np.argsort(along["b"][group], axis=1), axis=1)
        symbols = np.argsort(along["a"][group], axis=1)
        heights_a, heights_b = (_heights(stacks[name][group], places) for name in ("a", "b"))
        space = pattern_space(places, size, 0)
        keys = np.zeros(len(splits), np.uint64)
        for position in range(size if space.packing.width else 0):
            shift = np.uint64(position * space.packing.width)
            keys |= symbols[:, position].astype(np.uint64) << shift
        for place, ends in enumerate(np.cumsum(heights_a, axis=1).T[:-1]):
            shift = np.uint64(size * space.packing.width + place * space.packing.end_width)
            keys |= ends.astype(np.uint64) << shift
        indices = np.searchsorted(space.keys, keys)
        # Each shape as one number, which are told apart much more quickly than rows.
        codes = heights_b @ (64 ** np.arange(places))
        for code in np.unique(codes):
            rows = np.flatnonzero(codes == code)
            shape = tuple(heights_b[rows[0]].tolist())
            total[rows] += space.canonical_distances(shape)[indices[rows]]
    best = int(np.argmax(total))
    cuts = np.split(splits[best], np.cumsum(sizes)[:-1])
    return tuple(Group(tuple(sorted(part.tolist()))) for part in cuts), int(total[best])


def partial_groups(wanted: Wanted, places: int, like: int) -> Iterator[tuple[Group, ...]]:
    """Splits to try for another goal: those that the goal ties together are kept together.

    The blocks that it does not mention are in the first group, so that they stay alike.
    """
    rng = random.Random(0)
    first = 0
    largest = GOOD_PATTERNS
    while first < wanted.blocks and pattern_count(places, first + 1 + like, like) <= largest:
        first += 1
    sizes = [first] if like else []
    rest = wanted.blocks - sum(sizes)
    sizes += group_sizes(places, rest) if rest else []
    seen: set[tuple[Group, ...]] = set()
    for trial in range(PARTIAL_TRIALS):
        order = _tied_order(wanted, rng) if trial % 2 == 0 else _any_order(wanted, rng)
        groups, offset = [], 0
        for index, size in enumerate(sizes):
            part = tuple(sorted(order[offset : offset + size]))
            groups.append(Group(part, like if like and index == 0 else 0))
            offset += size
        if tuple(groups) not in seen:
            seen.add(tuple(groups))
            yield tuple(groups)


def _any_order(wanted: Wanted, rng: random.Random) -> list[int]:
    return rng.sample(range(wanted.blocks), wanted.blocks)


def _tied_order(wanted: Wanted, rng: random.Random) -> list[int]:
    """Next to each block those that the goal ties to the ones before."""
    left = _any_order(wanted, rng)
    order: list[int] = []
    while left:
        following = max(left, key=lambda block: sum(int(wanted.linked[block, o]) for o in order))
        left.remove(following)
        order.append(following)
    return order


def _splits(blocks: int, sizes: Sequence[int], trials: int) -> Iterator[list[int]]:
    """Orders of the blocks, to be cut into groups; all that differ, where there are few."""
    if len(sizes) == 1:
        yield list(range(blocks))
    elif len(sizes) == 2 and comb(blocks, sizes[0]) <= 2 * trials:
        for part in combinations(range(blocks), sizes[0]):
            if sizes[0] == sizes[1] and 0 not in part:
                break
            yield [*part, *(block for block in range(blocks) if block not in part)]
    else:
        rng = random.Random(0)
        for _ in range(trials):
            yield rng.sample(range(blocks), blocks)


def _heights(stacks: NDArray[np.int64], places: int) -> NDArray[np.int64]:
    counts: NDArray[np.int64] = (stacks[:, :, None] == np.arange(places)).sum(axis=1)
    return counts
