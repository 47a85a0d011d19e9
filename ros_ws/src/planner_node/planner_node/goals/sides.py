# SPDX-License-Identifier: Apache-2.0
"""Sides that are places: "two blocks on the left, three on the right"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .language import EVERYONE, SIDES
from .quantities import is_quantity
from .terms import Words

_PREPOSITIONS: Final = frozenset({"on", "to", "in", "at", "into", "onto"})


def with_sides(clauses: Sequence[list[Words]]) -> list[list[Words]]:
    """With "on the left" as "in the left stack" where it cannot be "left of" somebody.

    It is a place where several sides are told apart, or where a number of blocks goes there.
    """
    sides = {side for clause in clauses if (side := _named(clause))}
    return [_placed(clause, several=len(sides) > 1) for clause in clauses]


def _named(clause: Sequence[Words]) -> str | None:
    """The side that a clause ends with, as a place or on its own."""
    last = clause[-1]
    return last.side or (SIDES.get(last.text) if _ends(clause) else None)


def _ends(clause: Sequence[Words]) -> bool:
    return len(clause) > 1 and clause[-2].text in _PREPOSITIONS and clause[-1].text in SIDES


def _placed(clause: list[Words], several: bool) -> list[Words]:
    # "move all blocks to the right" may mean by one place.
    counted = clause[-2:][0].text != "to" and any(
        is_quantity(item.text) or item.text in EVERYONE for item in clause[:-2]
    )
    if not _ends(clause) or not (several or counted):
        return clause
    before, side = clause[-2:]
    if SIDES[side.text] == "middle" and not counted:
        return clause  # in a tower, it may be its middle
    inside = Words("in", before.offset, before.stop)
    return [*clause[:-2], inside, Words(f"{SIDES[side.text]} stack", side.offset, side.stop)]
