# SPDX-License-Identifier: Apache-2.0
"""How a name and what is in front of it are read: "three red blocks", "every box", "only red"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from ..errors import InvalidGoalError
from .language import BOTH, EXCEPT, MODALS, NOTHING_ELSE, NOUNS, OTHERS, PLURALS, meant
from .terms import Kind, Term, Words, number_of

_EVERY: Final = frozenset({"every", "each", "all", "both"})
_SOME: Final = frozenset({"a", "an", "any", "some", "another"})
_NO: Final = frozenset({"no", "none"})
_ALONE: Final = {
    "everything": Kind.EVERY,
    "nothing": Kind.NO,
    "none": Kind.NO,
    "something": Kind.COUNT,
    "anything": Kind.COUNT,
    "all": Kind.EVERY,
}
#: "between two and three", "two or three".
_RANGE: Final = re.compile(r"(\d+)-to-(\d+)")
#: Which bounds a number has behind these words, and what is added to it.
_BOUNDS: Final = {
    "at-least": (True, False, 0),
    "at-most": (False, True, 0),
    "more-than": (True, False, 1),
    "fewer-than": (False, True, -1),
}


def term_of(words: Sequence[Words]) -> Term:
    """Reads a quantity in front of a name: "three red blocks", "every box", "a cylinder".

    Raises:
        InvalidGoalError: it does not say which or how many are meant.
    """
    texts = [item.text for item in words]
    offset = words[0].offset
    whole = Words(" ".join(texts), offset)
    if whole.is_place or whole.text in BOTH:
        return Term(whole)
    if EXCEPT in texts[1:-1]:
        at = len(texts) - 1 - texts[::-1].index(EXCEPT)
        every, other = term_of(words[:at]), term_of(words[at + 1 :])
        if every.kind is Kind.EVERY and other.kind in (Kind.THE, Kind.EVERY):
            return replace(every, but=(*every.but, other))
    if whole.text in OTHERS:
        return Term(Words("block", offset), Kind.EVERY, others=True)
    if texts[0] == "other":
        return _other(words)
    if texts[:2] == ["all", "other"]:
        return replace(term_of([words[0], *words[2:]]), others=True)
    if whole.text in NOTHING_ELSE:
        return Term(Words("block", offset), Kind.NO, 0, 0, others=True)
    if texts[0] in ("this", "that") and len(texts) > 1:
        return term_of(words[1:])
    if texts[:2] == ["the-", "only"] and len(texts) > 2 and texts[-1] not in NOUNS:
        return term_of(words[2:])  # "the only cylinder"
    only = _only(words, whole)
    if only is not None:
        return only
    return _quantified(words, whole)


def _other(words: Sequence[Words]) -> Term:
    """ "the other", "the other three", "the other red one": those that were not named yet."""
    offset = words[0].offset
    texts = [item.text for item in words[1:]]
    number = number_of(texts[0]) if texts and texts[0] != "one" else None
    if not texts or texts == ["one"] or number is not None:
        most = 1 if number is None else number
        if len(texts) > 1 and not (len(texts) == 2 and texts[1] in PLURALS):
            raise InvalidGoalError("it is not clear which these are", offset, " ".join(texts))
        return Term(Words("other", offset), Kind.COUNT, most, most, others=True, bare=True)
    rest = term_of(words[1:])
    if rest.kind is not Kind.THE:
        return replace(rest, others=True)
    return replace(rest, kind=Kind.EVERY, others=True, exact=1)


def _only(words: Sequence[Words], whole: Words) -> Term | None:
    """ "only red", "red alone"; None where it says no such."""
    texts = [item.text for item in words]
    first = texts[0] == "only" and len(texts) > 1 and _quantity(texts)[0] is Kind.THE
    if not first and not (texts[-1] == "alone" and len(texts) > 1):
        return None
    alone = term_of(words[1:] if first else words[:-1])
    if alone.kind is not Kind.THE:
        raise InvalidGoalError(
            "it is not clear what 'only' is said of; name the blocks", whole.offset, whole.text
        )
    return replace(alone, only=True)


def _quantified(words: Sequence[Words], whole: Words) -> Term:
    """A name with what is in front of it: a number, "every", "a", "no", or nothing."""
    texts, offset = [item.text for item in words], whole.offset
    if len(texts) == 2 and texts[0] in _ALONE and meant(texts[1], MODALS):
        texts = texts[:1]  # "nothing shoud be on red"
    if len(texts) == 1 and len(texts[0]) > 5:
        texts = [meant(texts[0], _ALONE) or texts[0]]
    if len(texts) == 1 and texts[0] in _ALONE:
        bare = texts[0] in ("none", "all")
        return Term(Words("block", offset), _ALONE[texts[0]], bare=bare)
    kind, least, most, used = _quantity(texts)
    listed, exact = False, None
    if used and used < len(texts) and texts[used] == "of":
        if kind is Kind.COUNT and number_of(texts[0]) is not None:
            # "put one of the red ones in stack 1": may more be there?
            raise InvalidGoalError(
                "say 'exactly' or 'at least' in front of the number", offset, whole.text
            )
        used += 1
        listed = kind is Kind.COUNT and texts[-1] not in PLURALS
        used += used < len(texts) and texts[used] in ("all", "both")
    if texts[used - 1 : used] == ["both"]:
        exact = 2
    elif texts[used - 1 : used] == ["all"] and used < len(texts):
        exact = number_of(texts[used])
        used += exact is not None
    others = texts[0] == "another" or (
        used < len(texts) - 1 and texts[used] == "other" and kind is not Kind.THE
    )
    used += others and texts[0] != "another"  # "any other block"
    rest = texts[used:]
    if kind is Kind.THE and rest[-1] in PLURALS:
        kind = Kind.EVERY
    bare = not rest
    if bare:
        if (kind is not Kind.COUNT and exact is None) or texts[0] in _SOME:
            raise InvalidGoalError("it is not said which block", offset, whole.text)
        rest = ["block"]
    start = words[used].offset if used < len(words) else offset
    name = Words(" ".join(PLURALS.get(text, text) for text in rest), start)
    return Term(name, kind, least, most, others=others, listed=listed, exact=exact, bare=bare)


def is_quantity(text: str) -> bool:
    """Whether a word in front of a name says how many are meant."""
    return (
        text in _EVERY | _SOME | _NO | _BOUNDS.keys() | {"exactly"}
        or number_of(text) is not None
        or _RANGE.fullmatch(text) is not None
    )


def _quantity(texts: Sequence[str]) -> tuple[Kind, int, int | None, int]:
    """The kind, the bounds, and how many words say so."""
    first = texts[0]
    if len(texts) > 1 and first in _ALONE and first not in ("none", "all"):
        kind = _ALONE[first]  # "anything red"
        return kind, int(kind is not Kind.NO), 0 if kind is Kind.NO else None, 1
    if first in _EVERY:
        return Kind.EVERY, 1, None, 1
    if first in _NO:
        return Kind.NO, 0, 0, 1
    if first in _SOME:
        return Kind.COUNT, 1, None, 1
    named = _BOUNDS.get(first)
    used = int(named is not None or first in ("exactly", "only"))
    if used < len(texts):
        if bounds := _RANGE.fullmatch(texts[used]):
            return Kind.COUNT, int(bounds[1]), int(bounds[2]), used + 1
        number = number_of(texts[used])
        if number is not None:
            low, high, more = named or (True, True, 0)
            number = max(0, number + more)
            return Kind.COUNT, number if low else 0, number if high else None, used + 1
    return Kind.THE, 1, None, 0
