# SPDX-License-Identifier: Apache-2.0
"""What is said of a place: "stack1 has two blocks in it", "no stack is higher than three"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import PREDICATES

from .language import CARRIES, HOLDS, IT, MUTE, NEGATION, NOUN_VERBS, PLACE_NOUNS, PLURALS
from .phrases import find
from .terms import Words, names_place, number_of

_EVERY: Final = frozenset({"every", "each", "all"})
_HIGHER: Final = frozenset({"higher", "taller"})
#: What is left out behind: "no blocks in them".
_THERE: Final = (
    ("on", "top", "of", "it"), ("on", "top"), ("on", "it"), ("on", "them"), ("in", "it"),
    ("in", "them"), ("inside",),
)  # fmt: skip
#: The bounds of "no stack has at least …" are those of "every stack has at most …".
_FEWER: Final = {"at-least": -1, "more-than": 0}


def as_relation(words: Sequence[Words]) -> list[Words] | None:
    """A clause that says what a place holds, or a block carries, as a relation of what is there.

    Returns:
        "two blocks in stack1" for "stack1 has two blocks in it"; None where it is none of these.
    """
    carries = False
    if found := _at(words, CARRIES):
        carries = True
        whose, held = list(words[:found]), list(words[found + 1 :])
    elif found := _at(words, HOLDS):
        whose, held = list(words[:found]), list(words[found + 1 :])
    elif found := _at(words, _HIGHER):
        if len(words) < found + 3 or words[found + 1].text != "than":
            return None
        whose, held = list(words[:found]), _as_number(words[found], words[found + 2 :])
    else:
        return None
    denied = any(item.text == NEGATION for item in whose)
    whose = [item for item in whose if item.text not in (MUTE - NOUN_VERBS) | {NEGATION}]
    held, there = _without_there(held)
    if not whose or not held:
        return None
    place = _place(whose)
    if place is not None:
        if whose[0].text == "no" or denied:
            fewer = _denied(held)
            if fewer is None or (whose[0].text == "no" and denied):
                return None
            held = fewer
        inside = "at-top-of" if there[-1:] == ("top",) else "in"
        return [*held, Words(inside, held[0].offset), *place]
    # "red has nothing on it", "red carries blue", "red has blue below it".
    if there and there[0] == "on":
        held = [*held, Words("on", held[0].offset)]
    elif beside := _related_to_it(held):
        held = beside
    elif carries:
        held = [*held, Words("on", held[0].offset)]
    else:
        return None
    if denied:
        fewer = _denied(held)
        if fewer is None:
            return None
        held = fewer
    return [*held, *whose]


def _related_to_it(held: Sequence[Words]) -> list[Words] | None:
    """ "blue below it" without "it"; None where it says no relation to it."""
    found = list(find(held, PREDICATES.phrases))
    if len(found) != 1 or found[0].last != len(held) - 1 or held[-1].text not in IT:
        return None
    return list(held[:-1]) if found[0].first else None


def _at(words: Sequence[Words], known: frozenset[str]) -> int:
    """Where one of the known words is behind others; 0 where none is."""
    return next((index for index, item in enumerate(words) if index and item.text in known), 0)


def _as_number(where: Words, words: Sequence[Words]) -> list[Words]:
    """ "three blocks", "3 high" behind "higher than" as "more than three blocks"."""
    kept = [item for item in words if item.text != "high"]
    if len(kept) == 1:
        kept.append(Words("blocks", kept[0].offset, kept[0].stop))
    return [Words("more-than", where.offset, where.stop), *kept]


def _without_there(held: list[Words]) -> tuple[list[Words], tuple[str, ...]]:
    """What is held, without "in it" behind it; and these words."""
    for texts in _THERE:
        if len(held) > len(texts) and tuple(item.text for item in held[-len(texts) :]) == texts:
            return held[: -len(texts)], texts
    return held, ()


def _place(whose: Sequence[Words]) -> list[Words] | None:
    """The place that is meant, "every stack" for "no stack"; None for a block."""
    if names_place(whose):
        return list(whose)
    if len(whose) != 2 or PLURALS.get(whose[1].text, whose[1].text) not in PLACE_NOUNS:
        return None
    if whose[0].text not in _EVERY | {"no"}:
        return None
    return [Words("every", whose[0].offset, whose[0].stop), whose[1]]


def _denied(held: Sequence[Words]) -> list[Words] | None:
    """ "at most two blocks" for "(not) more than two", "no blocks" for "(not) any blocks"."""
    first = held[0]
    if first.text == "anything":
        return [Words("nothing", first.offset, first.stop), *held[1:]]
    if first.text in ("any", "a", "an") and len(held) > 1:
        return [Words("no", first.offset, first.stop), *held[1:]]
    number = number_of(held[1].text) if len(held) > 1 else None
    if first.text not in _FEWER or number is None:
        return None
    most = str(number + _FEWER[first.text])
    return [
        Words("at-most", first.offset, first.stop),
        Words(most, held[1].offset, held[1].stop),
        *held[2:],
    ]
