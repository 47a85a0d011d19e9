# SPDX-License-Identifier: Apache-2.0
"""Distances between all arrangements of a group of blocks, for ``part_bounds.c``."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from functools import cache, lru_cache
from itertools import permutations
from math import comb, factorial
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from .patterns import Distances

#: What ``part_bounds.c`` has room for.
MOST_PLACES: Final = 16
MOST_IN_GROUP: Final = 8

FILE: Final = Path(__file__).with_name("part_bounds.c")


class Patterns(ctypes.Structure):
    """All patterns of groups of one size, as ``part_bounds.c`` has them."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("places", "size", "compositions", "permutations")),
        *(
            (name, ctypes.c_void_p)
            for name in ("turned", "after", "turn", "heights", "before", "tables")
        ),
    ]


class GroupTables:
    """All arrangements of a group, and the distances to goals of every shape."""

    def __init__(self, places: int, size: int) -> None:
        heights = np.array(list(_compositions(places, size)), np.uint8)
        self._heights, self._before = heights, _before(places, size)
        count, orders = len(heights), factorial(size)
        self._after = np.full((count, places, places), 0xFFFF, np.uint16)
        self._turn = np.zeros((count, places, places), np.uint8)
        ends = np.cumsum(heights, axis=1)
        for source, target in permutations(range(places), 2):
            rows = np.flatnonzero(heights[:, source])
            moved = heights[rows]
            moved[:, source] -= 1
            moved[:, target] += 1
            self._after[rows, source, target] = self._numbers(moved)
            to = ends[rows, target] - 1 if target > source else ends[rows, target]
            self._turn[rows, source, target] = (ends[rows, source] - 1) * size + to
        self._turned = np.empty((size * size, orders), np.uint16)
        library().fill_turned(size, orders, address(self._turned))
        self._pointers = np.zeros(count, np.uintp)
        self._tables: dict[int, Distances] = {}
        self.bits = (count * orders - 1).bit_length()
        self.struct = Patterns(
            places, size, count, orders,
            *(array.ctypes.data for array in (self._turned, self._after, self._turn)),
            *(array.ctypes.data for array in (self._heights, self._before, self._pointers)),
        )  # fmt: skip

    def _numbers(self, heights: NDArray[np.uint8]) -> NDArray[np.int64]:
        """Of compositions, shape (compositions, places)."""
        left = np.full(len(heights), heights[0].sum())
        numbers = np.zeros(len(heights), np.int64)
        for place, height in enumerate(heights.T):
            numbers += self._before[place, left, height]
            left -= height
        return numbers

    def make_tables(self, poll: Callable[[], None]) -> None:
        """Of all goals with descending heights, as far as they are not there."""
        descending = (np.diff(self._heights.astype(np.int8), axis=1) <= 0).all(axis=1)
        for shape in np.flatnonzero(descending).tolist():
            if shape not in self._tables:
                poll()
                self._tables[shape] = self.distances(shape * self.struct.permutations)
                self._pointers[shape] = self._tables[shape].ctypes.data

    def distances(self, pattern: int) -> Distances:
        """From one arrangement to all."""
        result = np.empty(self.struct.compositions * self.struct.permutations, np.uint8)
        some = np.empty(self.struct.permutations + 1, np.uint16)
        library().fill_distances(
            ctypes.byref(self.struct), ctypes.c_uint32(pattern), address(result), address(some)
        )
        return result


@lru_cache(maxsize=16)
def group_tables(places: int, size: int) -> GroupTables:
    """Made at the first call, but for the distances."""
    return GroupTables(places, size)


def _compositions(places: int, blocks: int) -> Iterator[tuple[int, ...]]:
    """How many blocks stand on each place, in ascending order."""
    if places == 1:
        yield (blocks,)
        return
    for first in range(blocks + 1):
        for others in _compositions(places - 1, blocks - first):
            yield (first, *others)


def _before(places: int, size: int) -> NDArray[np.int32]:
    """Compositions that come before one, for each place by the blocks left and its height."""
    result = np.zeros((places, size + 1, size + 1), np.int32)
    for place in range(places - 1):
        behind = places - 1 - place
        for left in range(size + 1):
            for height in range(left):
                number = comb(left - height + behind - 1, behind - 1)
                result[place, left, height + 1] = result[place, left, height] + number
    return result


@cache
def library() -> Any:
    """``part_bounds.c``, where there is a compiler."""
    made = written(FILE)
    if made is None:
        raise RuntimeError("no C compiler; see PartBounds.possible")
    return made
