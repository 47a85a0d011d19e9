# SPDX-License-Identifier: Apache-2.0
"""What stands on either side of a relation: a block, a place, or a number of blocks of a kind."""

from __future__ import annotations

import enum
import re
from dataclasses import dataclass
from typing import Final

from scene_graph import Phrase, base_name

from .hashing import hashed_once
from .language import NUMBERS, PLACE_NOUNS, SIDES
from .slips import mended

_BASE: Final = re.compile(r"([a-z]+)[ _]?(?:number |no |nr )?(\d+)")
_STACK: Final = frozenset({"stack"})
_FROM_RIGHT: Final = re.compile(r"stack (\d+) from right")


@hashed_once
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
        if match is None or not (match[1] in PLACE_NOUNS or mended(match[1], _STACK)):
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
        return side if side in SIDES and noun in PLACE_NOUNS else None

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


@hashed_once
@dataclass(frozen=True)
class Described:
    """What is true now of the one that is meant.

    Attributes:
        how: ``related`` (by a phrase to the others), ``top`` or ``bottom`` (of the one other, or of
            the only tower); of a place: ``tallest``, ``shortest``, ``empty``, ``other``, ``with``
            (the others in it).
        place: it is a place.
    """

    how: str
    place: bool = False
    phrase: Phrase | None = None
    others: tuple[Term, ...] = ()


@hashed_once
@dataclass(frozen=True)
class Term:
    """A name and which of the objects that fit it are meant.

    Attributes:
        least, most: of a COUNT; most is None where more may be.
        but: of EVERY, those that are left out.
        others: of EVERY and NO, those that were named are left out.
        only: of THE, nothing else is there.
        among: of COUNT, those that are counted; none: all that fit.
        exact: of EVERY, how many there have to be; None: it is not said.
        less: of COUNT, how many fewer than all there have to be; 0: it is not said so.
        bare: it is a number or "all" without a name: "two boxes in stack0, one in stack1".
        partitive: of COUNT, they are some of those that the name fits: "two of the boxes".
        described: it is known by how the blocks stand now.
    """

    words: Words
    kind: Kind = Kind.THE
    least: int = 1
    most: int | None = None
    but: tuple[Term, ...] = ()
    others: bool = False
    only: bool = False
    among: tuple[Words, ...] = ()
    exact: int | None = None
    less: int = 0
    bare: bool = False
    partitive: bool = False
    described: Described | None = None

    @property
    def is_place(self) -> bool:
        """Whether it is a place, or every one."""
        if self.described is not None:
            return self.described.place
        return self.words.is_place or self.is_every_place

    @property
    def is_every_place(self) -> bool:
        """Whether it is "every stack"."""
        return self.kind is Kind.EVERY and self.words.text in PLACE_NOUNS

    @property
    def several(self) -> bool:
        """Whether more than one object is asked for."""
        return self.kind is Kind.EVERY or (self.kind is Kind.COUNT and self.least > 1)


def is_any_place(term: Term) -> bool:
    """Whether it is "any stack"."""
    some = term.kind is Kind.COUNT and (term.least, term.most) == (1, None)
    return some and term.words.text in PLACE_NOUNS


def _with_digits(text: str) -> str:
    """ "stack two" as "stack 2"."""
    head, _, last = text.rpartition(" ")
    return f"{head} {NUMBERS[last]}" if head and last in NUMBERS else text
