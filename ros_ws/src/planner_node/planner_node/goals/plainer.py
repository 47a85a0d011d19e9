# SPDX-License-Identifier: Apache-2.0
"""Clauses that say something besides their relation: where in a stack, side by side, of a place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from scene_graph import PREDICATES

from .described import by_place
from .holdings import as_relation
from .language import EXCEPT, MUTE, STEPS, TAKES, UPON, VERBS
from .phrases import find
from .relative import as_told_of, as_topped
from .terms import Words, names_place, number_of

_EDGES: Final = (
    ("at", "top"), ("at", "very", "top"), ("on", "very", "top"), ("at", "bottom"),
    ("at", "very", "bottom"), ("on", "very", "bottom"), ("on", "top"),
    ("at", "base"), ("at", "very", "base"),
)  # fmt: skip
_NEIGHBOURS: Final = frozenset({"adjacent", "neighbours", "neighbors", "neighbouring"})
_SIDE_BY_SIDE: Final = ("next", "to", "each-other")
_JUST: Final = {"just-left-of": "left", "just-right-of": "right"}


@dataclass(frozen=True)
class Plain:
    """A clause in plainer words, and what else it says.

    Attributes:
        edge: "top" or "bottom" where it says that its subject is there; UPON for "on top" of what
            was spoken of.
        adjacent: it says that left or right is meant of neighbouring places.
        of_object: it was told of what is its object now.
    """

    words: list[Words]
    edge: str | None = None
    adjacent: bool = False
    of_object: bool = False


def plainer(words: Sequence[Words]) -> Plain | None:
    """A clause with one turn less; None where it is plain already."""
    texts = [item.text for item in words]
    each = texts.index("each") if "each" in texts[1:] else 0
    if each and any(item.first == each + 1 for item in find(words, PREDICATES.phrases)):
        return Plain([*words[:each], *words[each + 1 :]])  # "two blocks each in stack0 and stack1"
    if texts == ["not", "directly"]:
        start, end = words[0], words[1]
        return Plain([start, Words("on", end.offset, end.stop), Words("it", end.stop, end.stop)])
    if len(words) > 1 and texts[0] in STEPS and texts[1] in VERBS | TAKES:
        return Plain(list(words[1:]))
    if "at-top-of" in texts[1:]:
        # "red at the top of stack1" is in it, and carries nothing.
        at = texts.index("at-top-of")
        inside = Words("in", words[at].offset, words[at].stop)
        return Plain([*words[:at], inside, *words[at + 1 :]], edge="top")
    for text, side in _JUST.items():
        if text in texts:
            at = texts.index(text)
            where = words[at]
            phrase = [Words(side, where.offset, where.stop), Words("of", where.stop)]
            return Plain([*words[:at], *phrase, *words[at + 1 :]], adjacent=True)
    for turn in (_except_behind, as_told_of, as_topped, _alone_behind, _apart, _height):
        if told := turn(words):
            return Plain(told)
    if described := by_place(words):
        return Plain(described[0], edge=described[1])
    if texts[-1] in _NEIGHBOURS and len(texts) > 1:
        end = words[-1]
        return Plain([*words[:-1], *(Words(text, end.offset, end.stop) for text in _SIDE_BY_SIDE)])
    if texts[-1] in ("at-least", "at-most") and number_of(texts[0]) is not None:
        return Plain([words[-1], *words[:-1]])  # "one block in every stack at least"
    if texts[-1] == "either" and len(words) > 1:
        return Plain(list(words[:-1]))
    for ending in _EDGES:
        if tuple(texts[-len(ending) :]) == ending and len(words) > len(ending):
            edge = UPON if ending == ("on", "top") else ending[-1].replace("base", "bottom")
            return Plain(list(words[: -len(ending)]), edge=edge)
    if held := as_relation(words):
        return Plain(held, of_object=True)
    return None


def _except_behind(words: Sequence[Words]) -> list[Words] | None:
    """ "everything in stack1 except red" with whom it leaves out behind "everything"."""
    at = next((index for index, item in enumerate(words) if item.text == EXCEPT), 0)
    found = list(find(words[:at], PREDICATES.phrases))
    if not found or not found[0].first:
        return None
    first = found[0].first
    if words[first - 1].text == "nothing":
        only = Words("only", words[first - 1].offset, words[at].stop)
        return [*words[: first - 1], only, *words[at + 1 :], *words[first:at]]
    return [*words[:first], *words[at:], *words[first:at]]


def _alone_behind(words: Sequence[Words]) -> list[Words] | None:
    """ "red in stack1 alone" with "alone" behind the name that it is said of."""
    found = list(find(words, PREDICATES.phrases)) if words[-1].text == "alone" else []
    if len(found) != 1 or not found[0].first or len(words) < found[0].last + 2:
        return None
    return [*words[: found[0].first], words[-1], *words[found[0].first : -1]]


def _apart(words: Sequence[Words]) -> list[Words] | None:
    """ "no two boxes in the same stack" as "all boxes in different stacks"."""
    texts = [item.text for item in words]
    at = texts.index("same") if "same" in texts else 0
    if texts[:2] != ["no", "two"] or at < 4 or at + 2 != len(words):
        return None
    every = Words("all", words[0].offset, words[1].stop)
    apart = Words("different", words[at].offset, words[at].stop)
    return [every, *words[2:at], apart, words[at + 1]]


def _height(words: Sequence[Words]) -> list[Words] | None:
    """ "the height of stack 0 is at most 2" as "at most 2 blocks in stack 0"."""
    if [item.text for item in words[:2]] != ["height", "of"]:
        return None
    for last in (4, 3):
        place, number = words[2:last], list(words[last:])
        if not names_place(place):
            continue
        while number and number[0].text in MUTE:
            number.pop(0)
        if not number or number_of(number[-1].text) is None:
            return None
        offset = number[-1].stop
        return [*number, Words("blocks", offset, offset), Words("in", offset, offset), *place]
    return None
