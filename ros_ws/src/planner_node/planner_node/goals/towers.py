# SPDX-License-Identifier: Apache-2.0
"""Towers whose blocks are told with their places in them: "red at the bottom, blue on top"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from scene_graph import PREDICATES

from .language import MUTE, NEGATION, NOUN_VERBS, NOUNS, OPENINGS
from .phrases import find, has_phrase
from .terms import Words, names_place

#: Where in a tower, from the bottom; behind a name or in front of it.
_LEVELS: Final = {
    (preposition, *very, noun): level
    for preposition in ("at", "on")
    for very in ((), ("very",), ("its",))
    for noun, level in (("bottom", 0), ("base", 0), ("top", 2), ("peak", 2))
} | {
    ("bottom",): 0, ("top",): 2, ("middle",): 1, ("in", "middle"): 1, ("in", "between"): 1,
    ("between", "them"): 1, ("in", "between", "them"): 1,
}  # fmt: skip
_LONGEST: Final = max(map(len, _LEVELS))


@dataclass(frozen=True)
class _Block:
    """A clause that names a block, and where it says that the block is, in which place."""

    name: list[Words]
    level: int | None
    place: list[Words] = field(default_factory=list)


def as_tower(clauses: list[list[Words]]) -> list[list[Words]]:
    """ "in stack 0: red at the bottom, then blue, green on top" as "from bottom to top".

    What is told before and behind stays as it is; so does what is no tower.
    """
    told = [_block(clause) for clause in clauses]
    levelled = [index for index, block in enumerate(told) if block and block.level is not None]
    if not levelled:
        return clauses
    if listed := _listed_with_ends(clauses, told, levelled):
        return listed
    first, last = levelled[0], levelled[-1]
    if first == last and not _has_phrase(told[first]):
        last = _last_listed(clauses, first)
    if first == last:
        return clauses
    run = told[first : last + 1]
    blocks = [block for block in run if block is not None]
    heading, name = _heading_before(blocks[0].name)
    if len(blocks) != len(run) or (heading and first):
        return clauses
    places = [block.place for block in blocks if block.place]
    if places and (len(blocks) < 3 or len(places) > 1):
        return clauses
    if places:
        heading = [*heading, Words("in", places[0][0].offset, places[0][0].offset), *places[0]]
    ordered = _from_bottom([_Block(name, blocks[0].level), *blocks[1:]])
    if ordered is None:
        return clauses
    order = Words("bottom-to-top", name[0].offset, name[0].stop)
    behind = clauses[last + 1 : last + 2]
    if behind and len(behind[0]) > 2 and behind[0][0].text in ("all", "both"):
        # "…, all in stack 1" says where the bottom stands.
        heading, last = [*heading, *behind[0][1:]], last + 1
    if first == 1 and not heading:
        return [[*clauses[0], order], *ordered, *clauses[last + 1 :]]
    return [*clauses[:first], [*heading, order], *ordered, *clauses[last + 1 :]]


def _listed_with_ends(
    clauses: Sequence[list[Words]], told: Sequence[_Block | None], levelled: Sequence[int]
) -> list[list[Words]] | None:
    """ "red, green and blue, with red on top and blue at the bottom": the third is between them."""
    if len(clauses) != 5 or list(levelled) != [3, 4]:
        return None
    ends = {block.level: _key(block.name) for block in told[3:] if block and not block.place}
    names = {_key(clause): clause for clause in clauses[:3]}
    between = names.keys() - set(ends.values())
    if ends.keys() != {0, 2} or len(between) != 1 or not set(ends.values()) <= names.keys():
        return None
    order = Words("bottom-to-top", clauses[0][0].offset, clauses[0][0].stop)
    return [[order], names[ends[0]], names[between.pop()], names[ends[2]]]


def _key(name: Sequence[Words]) -> frozenset[str]:
    return frozenset(item.text for item in name) - MUTE - NOUNS - OPENINGS


def _from_bottom(blocks: Sequence[_Block]) -> list[list[Words]] | None:
    """The names from the bottom; None where it is not clear which is where."""
    levels = [block.level for block in blocks]
    names = [block.name for block in blocks]
    if sorted(level for level in levels if level is not None) == [0, 1, 2] and len(levels) == 3:
        return [names[levels.index(level)] for level in range(3)]
    if any(level not in (None, 1) for level in levels[1:-1]) or levels.count(1) > 1:
        return None
    ends = (levels[0], levels[-1])
    if ends in ((0, 2), (0, None)):
        return names
    return names[::-1] if ends in ((2, 0), (2, None)) else None


def _last_listed(clauses: Sequence[Sequence[Words]], first: int) -> int:
    """The last of the names alone behind "red at the bottom"; ``first`` where none is.

    What comes behind them has no name of its own, so that they belong to nothing else.
    """
    last = first
    while last + 1 < len(clauses) and not list(find(clauses[last + 1], PREDICATES.phrases)):
        last += 1
    behind = clauses[last + 1 : last + 2]
    return last if not behind or behind[0][0].text in ("all", "in", "on") else first


def _block(clause: Sequence[Words]) -> _Block | None:
    """A clause as a block and its level; None where it says something else."""
    texts = tuple(item.text for item in clause)
    if NEGATION in texts:
        return None
    for last in (2, 1):
        place = list(clause[-last:])
        if texts[-last - 1 : -last] == ("of",) and names_place(place):
            block = _block(clause[: -last - 1])
            return block and (None if block.level is None else replace(block, place=place))
    for length in range(min(_LONGEST, len(texts) - 1), 0, -1):
        if (level := _LEVELS.get(texts[-length:])) is not None:
            return _Block(list(clause[:-length]), level)
        if (level := _LEVELS.get(texts[:length])) is not None and texts[length] != "of":
            name = list(clause[length:])
            while len(name) > 1 and name[0].text in MUTE - NOUN_VERBS:
                name.pop(0)
            return _Block(name, level)
    return _Block(list(clause), None)


def _has_phrase(block: _Block | None) -> bool:
    return block is not None and has_phrase(block.name)


def _heading_before(words: list[Words]) -> tuple[list[Words], list[Words]]:
    """What is before "with", and what is behind."""
    for index, item in enumerate(words):
        if item.text in OPENINGS and index:
            return words[:index], words[index + 1 :]
    return [], words
