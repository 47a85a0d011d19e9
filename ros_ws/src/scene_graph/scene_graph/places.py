# SPDX-License-Identifier: Apache-2.0
"""Places: points on the table where stacks can stand, and the imaginary bases on them (A.2.2)."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

Point = tuple[float, float, float]

#: Centres of the m = 3 places of 5.3.1 on the table, from the left of the image, in world [m].
ROW_OF_THREE: Final[tuple[Point, ...]] = ((0.5, -0.15, 0.0), (0.5, 0.0, 0.0), (0.5, 0.15, 0.0))

_BASE: Final = re.compile(r"stack(0|[1-9]\d*)")


@dataclass(frozen=True)
class Place:
    """A place.

    Attributes:
        index: from the left from 0; of two rows those of the one nearer to the camera come first.
        position_world: its centre on the table's surface [m].
        hidden: how much of the column over it something hid that is not a block, in the picture
            that its graph was made of, in 0..1; of no matter to whether it is the same place.
        seen_to: up to which height over it nothing hid the column, likewise [m]; 0 where that is
            not known.
        row: 0 for the row that is nearest to the camera.
        column: rank from the left among the places of all rows, see :class:`.rows.Rows`; None: that
            of its index, as in one row.
        clear: for each place, how high a stack on this one may be without hiding anything of a
            block there from the camera [m]; empty: no stack hides another one.
        aside: it is none, just where a block stands that is on none: it can be taken from here, and
            nothing is put here. Such places come after all others.
    """

    index: int
    position_world: Point
    hidden: float = field(default=0.0, compare=False)
    seen_to: float = field(default=0.0, compare=False)
    row: int = 0
    column: int | None = None
    clear: tuple[float, ...] = field(default=(), compare=False)
    aside: bool = False


def base_name(index: int) -> str:
    """Name of the imaginary base of a place (A.2.2): ``stack0``, ``stack1``, … from the left."""
    return f"stack{index}"


def base_index(name: str) -> int | None:
    """Index of the place of a base by its name, or None where the name is not a base's."""
    match = _BASE.fullmatch(name)
    return int(match.group(1)) if match else None
