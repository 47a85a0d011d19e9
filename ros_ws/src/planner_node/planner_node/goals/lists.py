# SPDX-License-Identifier: Apache-2.0
"""Clauses that are told in another order than they are meant, and lists without a relation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from .language import BOTH, IT, MUTE, TAKES
from .said import Link, Said

_INSIDE: Final = frozenset({"in", "on", "at"})


def turned_at_comma(said: Sequence[Said]) -> list[Said]:
    """With "on blue, put red" as one clause."""
    result: list[Said] = []
    for clause in said:
        before = result[-1] if result else None
        named = clause.subject is not None and not clause.links and not clause.takes
        # "in stack 1: red" as well, but not "red on blue, in stack 1, …".
        turned = clause.asks or (named and len(result) == 1 and not clause.clears)
        if turned and before is not None and before.links and before.subject is None:
            result[-1] = replace(before, subject=clause.subject, edge=clause.edge)
        else:
            result.append(clause)
    return result


def row_of(said: Sequence[Said]) -> tuple[list[Said], list[Said]]:
    """The names of a row, and what is said behind them: "red, blue, green, and green in stack1"."""
    for number, clause in enumerate(said):
        if clause.links or clause.clears or clause.takes:
            return list(said[:number]), list(said[number:])
    return list(said), []


def is_listed(following: Sequence[Said]) -> bool:
    """Whether what "get" takes is the first of a list: "get red, green and blue into stack 0"."""
    for clause in following:
        if clause.subject is None or clause.takes or clause.asks or clause.clears:
            return False
        if clause.links:
            verb = clause.words[0].text in MUTE | TAKES
            return not verb and clause.subject.words.text not in IT | BOTH
    return False


def place_of(clause: Said) -> Link | None:
    """The link of a clause that says of nobody but the row before it where it stands."""
    if clause.subject is not None or len(clause.links) != 1:
        return None
    _, denied, place, _ = clause.links[0]
    return clause.links[0] if place.is_place and not denied else None


def row_before(said: Sequence[Said], heading: Said) -> tuple[list[Said], Said, list[Said]]:
    """A row that is told before its order: "red, blue and green, from bottom to top".

    Returns:
        what is said before the row, its heading with the first name and the place, and the other
        names.
    """
    first = len(said)
    while first and said[first - 1].subject is not None and not said[first - 1].links:
        if said[first - 1].clears or said[first - 1].takes:
            break
        first -= 1
    names = list(said[first:])
    if first and said[first - 1].subject is not None and said[first - 1].words[0].text in _INSIDE:
        # "in stack 1: red, blue, from bottom to top"
        first -= 1
        names.insert(0, replace(said[first], links=()))
        heading = replace(heading, links=(*heading.links, *said[first].links))
    if heading.subject is not None:
        names.append(replace(heading, links=(), order=None))
    if names:
        heading = replace(heading, subject=names[0].subject)
    return list(said[:first]), heading, names[1:]
