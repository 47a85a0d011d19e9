# SPDX-License-Identifier: Apache-2.0
"""What stands on either side of a relation: a block, a place, or a number of blocks of a kind."""

from __future__ import annotations

import enum
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from scene_graph import base_name

from ..errors import InvalidGoalError
from .language import (
    BOTH,
    EXCEPT,
    MODALS,
    NOTHING_ELSE,
    NOUNS,
    NUMBERS,
    OTHERS,
    PLACE_NOUNS,
    PLURALS,
    SIDES,
    meant,
)

_BASE: Final = re.compile(r"([a-z]+)[ _]?(?:number |no |nr )?(\d+)")
_FROM_RIGHT: Final = re.compile(r"stack (\d+) from right")


@dataclass(frozen=True)
class Words:
    """Some words of the goal in lower case, and where they start and end, counted from 0."""

    text: str
    offset: int
    end: int = -1

    @property
    def stop(self) -> int:
        """Where they end, where it is not as long as they are."""
        return self.end if self.end >= 0 else self.offset + len(self.text)

    @property
    def base(self) -> str | None:
        """The name of the base that is meant, or None where it is a block or another place."""
        match = _BASE.fullmatch(_with_digits(self.text))
        if match is None or not (match[1] in PLACE_NOUNS or meant(match[1], {"stack"})):
            return None
        return base_name(int(match[2]))

    @property
    def from_right(self) -> int | None:
        """Which place it is from the right, from 0; None where it is not told from there."""
        match = _FROM_RIGHT.fullmatch(self.text)
        return int(match[1]) if match else None

    @property
    def side(self) -> str | None:
        """left, middle or right, where it is the place at that side of the row."""
        side, _, noun = self.text.partition(" ")
        return SIDES.get(side) if noun in PLACE_NOUNS else None

    @property
    def is_place(self) -> bool:
        """Whether it is a place."""
        return any(one is not None for one in (self.base, self.side, self.from_right))


class Kind(enum.Enum):
    """Which of the objects that fit a name are meant."""

    THE = "the one that fits"
    EVERY = "every one"
    NO = "none"
    COUNT = "a number of them"


@dataclass(frozen=True)
class Term:
    """A name and which of the objects that fit it are meant.

    Attributes:
        least, most: of a COUNT; most is None where more may be.
        but: of EVERY, those that are left out.
        others: of EVERY and NO, those that were named are left out.
        only: of THE, nothing else is there.
        listed: of COUNT, the names that follow are the ones that are counted.
        among: of COUNT, those that are counted; none: all that fit.
        exact: of EVERY, how many there have to be; None: it is not said.
        bare: it is a number alone, as in "two boxes in stack0, one in stack1".
    """

    words: Words
    kind: Kind = Kind.THE
    least: int = 1
    most: int | None = None
    but: tuple[Term, ...] = ()
    others: bool = False
    only: bool = False
    listed: bool = False
    among: tuple[Words, ...] = ()
    exact: int | None = None
    bare: bool = False

    @property
    def is_place(self) -> bool:
        """Whether it is a place, or every one."""
        return self.words.is_place or self.is_every_place

    @property
    def is_every_place(self) -> bool:
        """Whether it is "every stack"."""
        return self.kind is Kind.EVERY and self.words.text in PLACE_NOUNS

    @property
    def several(self) -> bool:
        """Whether more than one object is asked for."""
        return self.kind is Kind.EVERY or (self.kind is Kind.COUNT and self.least > 1)


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
    if whole.text == "all of them":
        return Term(Words("block", offset), Kind.EVERY, bare=True)
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
        used += used < len(texts) and texts[used] == "all"
    if kind is Kind.EVERY and used < len(texts):
        exact = 2 if "both" in texts[:used] else number_of(texts[used])
        if texts[used] == "both":
            exact, used = 2, used + 1
        elif exact is not None and "both" not in texts[:used]:
            used += 1
    others = texts[0] == "another" or (
        used < len(texts) - 1 and texts[used] == "other" and kind is not Kind.THE
    )
    used += others and texts[0] != "another"  # "any other block"
    rest = texts[used:]
    if kind is Kind.THE and rest[-1] in PLURALS:
        kind = Kind.EVERY
    bare = not rest
    if bare:
        if kind is not Kind.COUNT or texts[0] in _SOME:
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


def number_of(text: str) -> int | None:
    """The number that a word is, in digits or in letters."""
    return int(text) if text.isdigit() else NUMBERS.get(text)


def is_any_place(term: Term) -> bool:
    """Whether it is "any stack"."""
    some = term.kind is Kind.COUNT and (term.least, term.most) == (1, None)
    return some and term.words.text in PLACE_NOUNS


def _with_digits(text: str) -> str:
    """ "stack two" as "stack 2"."""
    head, _, last = text.rpartition(" ")
    return f"{head} {NUMBERS[last]}" if head and last in NUMBERS else text
