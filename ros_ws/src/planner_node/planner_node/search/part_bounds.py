# SPDX-License-Identifier: Apache-2.0
"""Moves that every plan for many blocks has: those that parts of the blocks need by themselves.

The blocks are split into groups whose distances are in tables of all their arrangements, see
:mod:`~planner_node.search.patterns`, so that the tables' values add up to as much as possible. Some
groups are then a part, and whether it needs one move more than that, and one more, is searched for
from both ends. Parts share no block, so that their moves add up. In C (``part_bounds.c``).
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from scene_graph import Stacks

from ..errors import SearchLimitError
from .group_tables import (
    FILE,
    MOST_IN_GROUP,
    MOST_PLACES,
    GroupTables,
    Patterns,
    group_tables,
    library,
)
from .limits import Limits, PartTooLargeError
from .patterns import pattern_count

#: What ``part_bounds.c`` has room for, and the blocks' spots are counted by.
MOST_BLOCKS: Final = 64
#: Arrangements of one group times the moves from each, which a table looks at. Some tables are
#: kept, a byte for an arrangement.
TABLE: Final = 40_000_000
#: Groups of a part; one more where the last would be alone.
IN_PART: Final = 2
#: Random orders that splits are made from, and exchanges of two blocks that are tried in each.
RESTARTS: Final = 20
EXCHANGES: Final = 1_000
#: Expansions between two looks at the limits: some milliseconds.
CHUNK: Final = 4_096

_TOO_MANY: Final = (PartTooLargeError, SearchLimitError)
_GO_ON: Final = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int)


class _Group(ctypes.Structure):
    _fields_ = [
        ("patterns", ctypes.POINTER(Patterns)),
        ("place", ctypes.c_uint8 * MOST_PLACES),
        *((name, ctypes.c_uint32) for name in ("start", "goal")),
        ("distances", ctypes.c_void_p * 2),
        *((name, ctypes.c_int) for name in ("shift", "bits")),
    ]


class _Part(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_int) for name in ("places", "groups", "blocks", "width")),
        ("group", ctypes.POINTER(_Group)),
    ]


class PartBounds:
    """The bound of one problem, which can be raised."""

    def __init__(self, initial: Stacks, target: Stacks, limits: Limits) -> None:
        names = [name for stack in initial for name in stack]
        self._places, self._blocks = len(initial), len(names)
        self._start, self._goal = (spots_by_name(stacks, names) for stacks in (initial, target))
        self._parts = self._split(limits)
        self._bounds = [sum(group.moves for group in part) for part in self._parts]

    @staticmethod
    def possible(places: int, blocks: int) -> bool:
        """Whether there is the C for it, and room for so many."""
        fits = 3 <= places <= MOST_PLACES and blocks <= MOST_BLOCKS
        return fits and written(FILE) is not None

    @property
    def least(self) -> int:
        """No plan has fewer moves."""
        return sum(self._bounds)

    def raise_to(self, enough: int, max_expansions: int, limits: Limits) -> None:
        """Makes it larger by a search.

        Args:
            enough: what is as good as more.
            max_expansions: of all parts.

        Raises:
            SearchCancelledError: see :class:`Limits`. Its other limits end it without an error.
        """
        left = max_expansions
        for index, part in enumerate(self._parts):
            within = limits.of_a_part(left // (len(self._parts) - index))
            others = self.least - self._bounds[index]
            self._bounds[index] = self._searched(part, enough - others, within)
            left -= within.expanded

    def _split(self, limits: Limits) -> list[list[_Member]]:
        sizes = _sizes(self._places, self._blocks)
        spaces = [group_tables(self._places, size) for size in sizes]
        for space in spaces:
            space.make_tables(limits.poll)
        order = np.arange(self._blocks, dtype=np.uint8)
        pointers = (ctypes.c_void_p * len(spaces))(*(ctypes.addressof(s.struct) for s in spaces))
        library().best_split(
            len(spaces), pointers, self._blocks, address(order), address(self._start),
            address(self._goal),
            RESTARTS, EXCHANGES,
        )  # fmt: skip
        members = [
            _Member(space, blocks, self._start, self._goal)
            for space, blocks in zip(spaces, np.split(order, np.cumsum(sizes)[:-1]))
        ]
        count = max(1, len(members) // IN_PART)
        # The smallest group is first; it is in a larger part.
        cuts = [-(-len(members) * part // count) for part in range(count + 1)]
        return [members[low:high] for low, high in pairwise(cuts)]

    def _searched(self, members: Sequence[_Member], enough: int, within: Limits) -> int:
        width = max(1, (len(members) - 1).bit_length())
        colour = {
            int(block): number for number, member in enumerate(members) for block in member.blocks
        }
        groups = (_Group * len(members))()
        shift, tables = len(colour) * width, []
        for group, member in zip(groups, members):
            within.poll()
            tables.append(member.space.distances(member.group.start))
            ctypes.memmove(ctypes.byref(group), ctypes.byref(member.group), ctypes.sizeof(group))
            group.distances[1] = tables[-1].ctypes.data
            group.shift, group.bits = shift, member.space.bits
            shift += group.bits
        part = _Part(self._places, len(members), len(colour), width, groups)
        colours = [
            sum(
                colour[block] << place * width
                for place, block in enumerate(sorted(colour, key=lambda block: int(spots[block])))
            )
            for spots in (self._start, self._goal)
        ]
        proven = ctypes.c_int()
        with Going(within) as going:
            if not library().part_bound(
                ctypes.byref(part), *map(ctypes.c_uint64, colours), enough, CHUNK,
                going.on, ctypes.byref(proven),
            ):  # fmt: skip
                raise MemoryError("no memory to search for the bound of a part")
        return proven.value


class Going:
    """``on`` for C to call now and then, by which limits end it.

    Leaving the context raises what the limits raised, but not that there were too many expansions.
    """

    def __init__(self, limits: Limits, count: bool = True) -> None:
        self._limits, self._count = limits, count
        self._error: Exception | None = None
        self.on = _GO_ON(self._go_on)

    def __enter__(self) -> Going:
        return self

    def __exit__(self, *_: object) -> None:
        if self._error is not None and not isinstance(self._error, _TOO_MANY):
            raise self._error

    def _go_on(self, number: int) -> int:
        # An exception cannot pass through C.
        try:
            if self._count:
                while number > 0:
                    number -= self._limits.count_expansions(number)
            else:
                self._limits.poll()
        except Exception as error:
            self._error = error
            return 0
        return 1


def spots_by_name(stacks: Stacks, names: Sequence[str]) -> NDArray[np.uint16]:
    """Where every block stands: its place times MOST_BLOCKS, plus its level."""
    spot = {
        name: place * MOST_BLOCKS + level
        for place, stack in enumerate(stacks)
        for level, name in enumerate(stack)
    }
    return np.array([spot[name] for name in names], np.uint16)


class _Member:
    """A group of a part.

    Attributes:
        moves: that it needs by itself.
    """

    def __init__(
        self,
        space: GroupTables,
        blocks: NDArray[np.uint8],
        start: NDArray[np.uint16],
        goal: NDArray[np.uint16],
    ) -> None:
        self.space, self.blocks, self.group = space, blocks, _Group()
        self.moves: int = library().set_group(
            ctypes.byref(space.struct),
            address(blocks),
            address(start),
            address(goal),
            ctypes.byref(self.group),
        )


def _sizes(places: int, blocks: int) -> list[int]:
    """Of groups as large as their tables may be, but for the first one."""
    size, largest = 1, TABLE // (places * (places - 1))
    while size < MOST_IN_GROUP and pattern_count(places, size + 1, 0) <= largest:
        size += 1
    full, rest = divmod(blocks, size)
    return [rest] * (rest > 0) + [size] * full
