# SPDX-License-Identifier: Apache-2.0
"""Which base a place's name means in the scene that is seen."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from scene_graph import Rows, base_index, base_name

from ..errors import InvalidGoalError, UnknownObjectError
from .terms import Term, Words

#: What people call a place, with or without a number; only ``stack0`` … are places.
_PLACE: Final = re.compile(
    r"(stack|place|position|spot|slot|column|pile|tower|base)s?[ _-]*\d*"
    r"|table|tabletop|floor|ground|desk|surface"
)


def is_place_word(text: str) -> bool:
    """Whether people call a place so, though which one is not known."""
    return _PLACE.fullmatch(text) is not None


def place_named(words: Words, stack_count: int | None) -> str | None:
    """The base that words mean, or None where they mean no place.

    Raises:
        UnknownObjectError: the scene has no such place.
    """
    base = words.base
    if base is not None:
        index = base_index(base)
        if stack_count is not None and index is not None and index >= stack_count:
            raise unknown_place(words, stack_count)
        return base
    further = words.from_right
    if further is not None:
        if stack_count is None or further >= stack_count:
            raise unknown_place(words, stack_count)
        return base_name(stack_count - 1 - further)
    side = words.side
    if side is None:
        return None
    if stack_count is None or (side == "middle" and stack_count % 2 == 0):
        raise unknown_place(words, stack_count)
    return base_name({"left": 0, "middle": stack_count // 2, "right": stack_count - 1}[side])


def check_sides(terms: Iterable[Term], rows: Rows) -> None:
    """Raises InvalidGoalError for "the left stack" where there are two rows."""
    if rows.count == 1:
        return
    named = [
        words
        for term in terms
        for words in (term.words, *term.among, *(one.words for one in term.but))
    ]
    for words in named:
        if words.side is None and words.from_right is None:
            continue
        known = [
            ", ".join(base_name(place) for place, row in enumerate(rows.rows) if row == number)
            for number in range(rows.count)
        ]
        raise InvalidGoalError(
            f"it is not clear in which row; the places are {known[0]} in front and "
            f"{' and '.join(known[1:])} behind, from the left",
            words.offset,
            words.text,
        )


def unknown_place(words: Words, stack_count: int | None) -> UnknownObjectError:
    """What to say of a name that looks like a place and is none."""
    if stack_count is None:
        known: tuple[str, ...] = ()
        listed = f"places are called {base_name(0)}, {base_name(1)}, … from the left"
    else:
        known = tuple(base_name(index) for index in range(stack_count))
        listed = f"the places are {', '.join(known)} from the left"
    numbered = re.search(r"\d", words.text)
    example = "" if numbered else f"; write which one, such as 'red on {base_name(0)}'"
    return UnknownObjectError(
        words.text,
        known,
        f"at offset {words.offset}: there is no place '{words.text}'; {listed}{example}",
    )
