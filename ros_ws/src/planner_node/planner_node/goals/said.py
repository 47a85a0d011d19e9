# SPDX-License-Identifier: Apache-2.0
"""What one clause of a goal says, and the error of one that relates nothing to nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from scene_graph import PREDICATES, UP, Phrase

from ..errors import InvalidGoalError
from .terms import Kind, Term, Words

EXAMPLE: Final = "write relations like 'red on blue, green left of red'"

#: A phrase, whether it is negated, its object, and the words of the phrase.
Link = tuple[Phrase, bool, Term, Words]


@dataclass(frozen=True)
class Said:
    """What one clause says; a name without a relation has no links.

    Attributes:
        subject: None where the clause leaves it out.
        links: its relations, in their order.
        takes: it only says what to take, as in "take red and put it on blue".
        clears: it says of the name that nothing stands on it.
        order: the names that follow are a tower or a row, see ``ORDERS``; None: they are not.
        again: what was said before is said of its subject too: "so should blue", "nor should blue".
        asks: it has a verb, but no relation, as in "on blue, put red".
        edge: "top" or "bottom" where its subject is said to be there, of the place that is meant.
        adjacent: it says "directly left of": the places are neighbours too.
        of_object: it says of its object how many subjects it has: "stack1 has two blocks".
    """

    words: Sequence[Words]
    subject: Term | None
    links: tuple[Link, ...] = ()
    takes: bool = False
    clears: bool = False
    order: tuple[str, bool] | None = None
    asks: bool = False
    of_object: bool = False
    edge: str | None = None
    adjacent: bool = False
    again: str = ""

    def denies(self, subjects: Sequence[Term]) -> bool:
        """Whether its last relation does not hold: a list behind it then may go on."""
        return bool(self.links) and (
            self.links[-1][1] or all(subject.kind is Kind.NO for subject in subjects)
        )


def no_relation(text: str, words: Sequence[Words]) -> InvalidGoalError:
    """The error of a part of a goal that relates nothing to nothing."""
    start, end = words[0].offset, words[-1].stop
    return InvalidGoalError(
        f"no relation found; known are {', '.join(_known())}; {EXAMPLE}", start, text[start:end]
    )


def _known() -> Iterator[str]:
    """One way to write each relation, its inverse, and its form for places."""
    for name in PREDICATES:
        predicate = PREDICATES[name]
        yield from predicate.phrases[:1]
        if name != UP:
            yield from predicate.inverse_phrases[:1]
            yield from predicate.place_phrases[:1]
