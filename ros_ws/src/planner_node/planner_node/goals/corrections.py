# SPDX-License-Identifier: Apache-2.0
"""People who correct themselves: "red on blue, no wait, on green", "scratch that"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import PREDICATES

from ..errors import InvalidGoalError
from .language import (
    CORRECTION,
    IT,
    JOINS,
    MUTE,
    NEGATION,
    NOUN_VERBS,
    NOUNS,
    TAKEN_BACK,
    TAKES,
)
from .phrases import find
from .terms import Words

_MARKS: Final = frozenset({CORRECTION, TAKEN_BACK})


def corrected(clauses: Sequence[list[Words]], said_before: bool) -> list[list[Words]]:
    """The clauses of a sentence as they were meant.

    Args:
        said_before: there is a sentence before; where there is none, and nothing was said before
            the first mark, it corrects nothing.

    Raises:
        InvalidGoalError: it is not clear what is corrected.
    """
    result: list[list[Words]] = []
    mark: Words | None = None
    for clause in clauses:
        for part in _at_marks(clause):
            if part[0].text in _MARKS:
                if mark is None or part[0].text == TAKEN_BACK:
                    mark = part[0]
                continue
            if mark is not None and not result:
                if said_before:
                    raise _unclear(mark)
            elif mark is not None:
                target = _last_relation(result)
                part = _instead(target, part, mark) if mark.text == CORRECTION else part
            result.append(part)
            mark = None
    if mark is not None and result:
        if mark.text == CORRECTION:
            raise _unclear(mark)
        _last_relation(result)
    return result


def joined(before: Sequence[Sequence[Words]], after: Sequence[Sequence[Words]]) -> bool:
    """Whether a sentence corrects the one before: a mark ends that, or begins this."""
    return any(
        one[at].text in _MARKS or [item.text for item in one] == ["no"]
        for one, at in ((before[-1], -1), (after[0], 0))
    )


def _at_marks(clause: Sequence[Words]) -> list[list[Words]]:
    """A clause cut at the marks in it; "no" is one where it stands alone."""
    if [item.text for item in clause] == ["no"]:
        return [[Words(CORRECTION, clause[0].offset, clause[0].stop)]]
    parts: list[list[Words]] = []
    for item in clause:
        if item.text in _MARKS or not parts or parts[-1][0].text in _MARKS:
            parts.append([])
        parts[-1].append(item)
    return parts


def _last_relation(clauses: list[list[Words]]) -> list[Words]:
    """Takes away what was said last: a relation, or a name that had none yet."""
    words = clauses.pop()
    joins = [at for at, item in enumerate(words) if item.text in JOINS]
    for at in reversed(joins):
        if _phrases(words[at + 1 :]):
            clauses.append(words[:at])
            return words[at + 1 :]
    return words


def _instead(target: Sequence[Words], fix: list[Words], mark: Words) -> list[Words]:
    """What is meant instead of a relation: another object, another relation, or all of it."""
    fix = _without_verb(fix)
    told, new = _phrases(target), _phrases(fix)
    if not fix or any(item.text == NEGATION for item in fix):
        raise _unclear(mark)
    if not told:
        # "put red, no, blue on green"
        return fix
    first, last = told[-1]
    if not new:
        return [*target[:last], *fix]
    if new[0][0] == 0:
        return [*target[:first], *fix]
    ours, theirs = _name(target[: told[0][0]]), _name(fix[: new[0][0]])
    same_object = _name(target[last:]) == _name(fix[new[-1][1] :])
    if ours != theirs and not same_object:
        raise _unclear(mark)
    return fix


def _phrases(words: Sequence[Words]) -> list[tuple[int, int]]:
    return [(item.first, item.last) for item in find(words, PREDICATES.phrases)]


def _without_verb(words: Sequence[Words]) -> list[Words]:
    """Without "put it" in front: what is corrected has its verb."""
    start = 0
    while start < len(words) and words[start].text in ((MUTE | TAKES) - NOUN_VERBS) | IT:
        start += 1
    return list(words[start:])


def _name(words: Sequence[Words]) -> frozenset[str]:
    """The words of a name that tell it from others."""
    return frozenset(item.text for item in words) - MUTE - TAKES - NOUNS


def _unclear(mark: Words) -> InvalidGoalError:
    return InvalidGoalError("it is not clear what this corrects", mark.offset, "")
