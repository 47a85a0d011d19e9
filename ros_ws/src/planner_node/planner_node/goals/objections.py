# SPDX-License-Identifier: Apache-2.0
"""What is wrong with relations that were read, as errors that say so."""

from __future__ import annotations

from scene_graph import LEFT, PREDICATES, Phrase

from ..errors import InvalidGoalError
from .example import EXAMPLE
from .terms import Kind, Term


def check_places(subject: Term, phrase: Phrase, object_: Term, written: str) -> None:
    """Raises InvalidGoalError where a relation cannot be said of a place, or only of one."""
    if phrase.needs_place and not object_.is_place:
        raise InvalidGoalError(
            f"'{written}' needs a place, such as stack0; "
            f"use '{phrase.predicate.words}' for a block",
            object_.words.offset,
            object_.words.text,
        )
    if not phrase.predicate.takes_place:
        beside_place = phrase.predicate.name == LEFT and object_.kind is Kind.THE
        for term in (subject,) if beside_place else (subject, object_):
            if term.is_place:
                fitting = [
                    f"'{PREDICATES[name].words}'"
                    for name in PREDICATES
                    if PREDICATES[name].takes_place and PREDICATES[name].phrases
                ]
                raise InvalidGoalError(
                    f"'{written}' relates two blocks; use {' or '.join(fitting)} for a place",
                    term.words.offset,
                    term.words.text,
                )


def untold(term: Term) -> InvalidGoalError:
    """The error of a block that is taken and not put down."""
    return InvalidGoalError(
        f"it is not said where to put it; {EXAMPLE}", term.words.offset, term.words.text
    )


def unclear(term: Term) -> InvalidGoalError:
    """The error of a word that may stand for several blocks, or for none."""
    return InvalidGoalError(
        f"it is not clear which block '{term.words.text}' is; name it",
        term.words.offset,
        term.words.text,
    )
