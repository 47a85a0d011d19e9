# SPDX-License-Identifier: Apache-2.0
"""Places: points on the table where stacks can stand, and the imaginary bases on them (A.2.2)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

Point = tuple[float, float, float]

#: Centres of the m = 3 places of 5.3.1 on the table, from the left of the image, in world [m].
ROW_OF_THREE: Final[tuple[Point, ...]] = ((0.5, -0.15, 0.0), (0.5, 0.0, 0.0), (0.5, 0.15, 0.0))

_BASE: Final = re.compile(r"stack(0|[1-9]\d*)")


@dataclass(frozen=True)
class Place:
    """A place: index from the left from 0, and its centre on the table's surface [m]."""

    index: int
    position_world: Point


def base_name(index: int) -> str:
    """Name of the imaginary base of a place (A.2.2): ``stack0``, ``stack1``, … from the left."""
    return f"stack{index}"


def base_index(name: str) -> int | None:
    """Index of the place of a base by its name, or None where the name is not a base's."""
    match = _BASE.fullmatch(name)
    return int(match.group(1)) if match else None
