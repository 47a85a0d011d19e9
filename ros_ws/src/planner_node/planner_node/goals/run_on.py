# SPDX-License-Identifier: Apache-2.0
"""Names with nothing between them: "red on blue green on yellow"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from scene_graph import COLORS, PREDICATES, SHAPES

from .language import (
    CARRIES,
    HEADING,
    HOLDS,
    MORE_COLORS,
    MUTE,
    NOUN_VERBS,
    NOUNS,
    PLURALS,
    SYNONYMS,
    TAKES,
)
from .orders import ORDERS
from .phrases import RIGHT_WORDS, find
from .quantities import is_quantity
from .terms import Words, names_place

_SHAPES: Final = frozenset(SHAPES) | {word for word in SYNONYMS if SYNONYMS[word] in SHAPES}
_COLORS: Final = frozenset(COLORS) | MORE_COLORS | SYNONYMS.keys() - _SHAPES
_ALONE: Final = frozenset({"it", "them", "nothing"})
_MEANS_NOTHING: Final = (MUTE | TAKES) - NOUN_VERBS - HOLDS - CARRIES


def told_apart(clause: list[Words]) -> Iterator[list[Words]]:
    """A clause as several, where names follow one another.

    In front of the first relation and behind an order there are names only; between two relations
    there are the object of one and the subjects of the next.
    """
    found = list(find(clause, PREDICATES.phrases))
    ordered = any(item.text in ORDERS for item in clause)
    ends = [*((item.first, item.last) for item in found), (len(clause), len(clause))]
    if not found and (inside := _in_place(clause)):
        yield inside
        return
    start, done = 0, 0
    for number, (last, behind) in enumerate(ends):
        names = _names(clause, start, last)
        if number == 0 and found and not names and not ordered:
            break  # "on blue put red"
        object_last = number == len(found) and number > 0 and not ordered
        for index, (first, stop) in enumerate(names[:-1]):
            place = ordered and index == 0 and names_place(clause[first:stop])
            if object_last or place:
                continue
            yield clause[done:stop]
            done = stop
        start = behind
    yield clause[done:]


def is_name(words: Sequence[Words]) -> bool:
    """Whether it is one name and nothing else."""
    return bool(words) and _name(words) == len(words)


def _in_place(clause: list[Words]) -> list[Words] | None:
    """ "red stack 1" as "red in stack 1"; None for all else."""
    names = _names(clause, 0, len(clause))
    if len(names) != 2:
        return None
    parts = [clause[first:last] for first, last in names]
    places = [names_place(part) for part in parts]
    if sum(places) != 1:
        return None
    place, name = parts if places[0] else reversed(parts)
    return [*name, Words("in", place[0].offset, place[0].offset), *place]


def _names(clause: Sequence[Words], start: int, last: int) -> list[tuple[int, int]]:
    """Where the names among some words start and end; none where there are other words."""
    result: list[tuple[int, int]] = []
    index = start
    while index < last:
        if used := _name(clause[index:last]):
            result.append((index, index + used))
            index += used
        elif clause[index].text in _MEANS_NOTHING | ORDERS.keys() or (
            any(item.text in ORDERS for item in clause[index:last])
            and clause[index].text in HEADING - {"one", "this"}
        ):
            index += 1
        else:
            return []
    return result


def _name(words: Sequence[Words]) -> int:
    """How many words the name is that they begin with; 0 where they begin with none."""
    texts = [item.text for item in words]
    if words[0].is_place or texts[0] in _ALONE:
        return 1
    if len(words) > 1 and names_place(words[:2]):
        return 2
    index = 0
    while index < len(texts) and is_quantity(texts[index]):
        index += 1
    rest = [PLURALS.get(text, text) for text in texts[index : index + 3]]
    if rest[:1] and rest[0] in _SHAPES and rest[1:2] and rest[1] in _COLORS:
        if rest[2:] and rest[2] in NOUNS | _SHAPES:
            return 0 if texts[index] in PLURALS and not index else index + 1
        return index + 2  # "the box blue"
    if len(rest) > 1 and rest[1] in NOUNS | _SHAPES and _may_be_color(rest[0]):
        return index + 2
    if rest and (rest[0] in _COLORS or rest[0] in _SHAPES or (index and rest[0] in NOUNS)):
        return index + 1
    return 0


def _may_be_color(word: str) -> bool:
    """Whether it is a colour, or one with a typo."""
    return word in _COLORS or (word not in RIGHT_WORDS and word.isalpha())
