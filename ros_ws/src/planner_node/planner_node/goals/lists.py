# SPDX-License-Identifier: Apache-2.0
"""Clauses that are told in another order than they are meant, and lists without a relation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .clauses import Said
from .language import BOTH, IT, MUTE, TAKES


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
