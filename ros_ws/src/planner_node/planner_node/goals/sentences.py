# SPDX-License-Identifier: Apache-2.0
"""From a text to the words of its clauses: what is written together, and what stands for what."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import takewhile
from typing import Final

from scene_graph import PREDICATES

from ..errors import InvalidGoalError
from .corrections import corrected, joined
from .courtesy import is_talk, says_nothing, without_courtesy
from .exceptions import leaves_out, with_exceptions, with_only, without_both
from .language import (
    CLEAR,
    EXCEPT,
    HEADING,
    JOINS,
    MUTE,
    NEGATION,
    NOUN_VERBS,
    OPENINGS,
    PLURALS,
    SIDES,
    TAKES,
    meant,
)
from .merged import merged
from .orders import ORDERS
from .phrases import RIGHT_WORDS, find, has_phrase
from .relative import with_looks, without_contrast
from .run_on import is_name, told_apart
from .sides import with_sides
from .terms import Words, names_place
from .tokens import parts_of
from .towers import as_tower

_BEFORE_OPENING: Final = (MUTE | HEADING) - {"this", "one", "two", "them"}
#: Say in which order a tower is told.
_TOLD_IN_ORDER: Final = ORDERS.keys() | {"bottom", "top"}
#: Places on their own, in front of a colon.
_OUTERMOST: Final = {word: side for word, side in SIDES.items() if side != "middle"}
_NO_NAMES: Final = MUTE | TAKES | CLEAR | {"elsewhere"}
_NONE: Final = frozenset({"nothing", "no", "none"})
_DENYING: Final = frozenset({NEGATION, "nothing", "none"})
#: Say that a tower is what the heading before is about.
_OF_TOWERS: Final = ORDERS.keys() | {"on", "upon", "top", "bottom", "base"}


def sentences(text: str) -> Iterator[list[list[Words]]]:
    """The clauses of every sentence; those that say nothing are left out.

    Raises:
        InvalidGoalError: for what no goal has, see :func:`parts_of`, and for unclear corrections.
    """
    found: list[list[list[Words]]] = []
    for clauses in _written(text):
        kept = [clause for clause in clauses if not _says_nothing(clause)]
        if found and kept and joined(found[-1], kept):
            found[-1] += kept
        elif found and kept and _goes_on(found[-1], kept):
            found[-1][0] += kept[0]  # "Red. On blue."
            found[-1] += kept[1:]
        elif kept:
            found.append(kept)
    heading: list[list[Words]] = []
    for number, clauses in enumerate(found):
        clauses = corrected(clauses, said_before=number > 0)
        if heading:
            told = any(item.text in _OF_TOWERS for clause in clauses for item in clause)
            clauses = clauses if told else [*heading, *clauses]
        heading = []
        if len(clauses) == 1 and is_heading(clauses[0]) and number + 1 < len(found):
            heading = clauses  # "Build a tower. At the bottom …"
        elif clauses:
            yield _finished(clauses)


def _goes_on(before: Sequence[list[Words]], after: Sequence[list[Words]]) -> bool:
    """Whether a sentence says of nobody what it says, and the one before nothing of somebody."""
    starts = next(find(after[0], PREDICATES.phrases), None)
    names = is_name([item for clause in before for item in clause])
    return names and starts is not None and not starts.first and is_name(after[0][starts.last :])


def _written(text: str) -> Iterator[list[list[Words]]]:
    """The sentences as they are written, in the parts that commas make."""
    clauses: list[list[Words]] = []
    colon = False
    for part in parts_of(text):
        words = part.words
        if part.mark == ")" and words and words[-1].text in "abcdefgh":
            words = words[:-1]  # "a) red on blue"
        clause = without_courtesy(merged(words))
        if part.mark == ":" and (place := _place_heading(clause)):
            # "stack 1: red" is a sentence of its own.
            yield clauses
            clauses = [place]
        elif clauses and colon and names_place(clause):
            clauses[-1] = [*clauses[-1], *clause]  # "red: stack 1"
        elif clause and not (part.mark == ":" and (is_heading(clause) or _announces(clause))):
            clauses.append(clause)
        colon = part.mark == ":"
        if part.end:
            yield clauses
            clauses = []


def _announces(clause: Sequence[Words]) -> bool:
    """Whether somebody says that a goal follows: "I picture two towers"."""
    rest = [item for item in clause if item.text not in HEADING and item.text not in PLURALS]
    return bool(rest) and is_talk(rest)


def _finished(clauses: Sequence[list[Words]]) -> list[list[Words]]:
    """The clauses of a sentence, each with one relation or one name."""
    parts: list[list[Words]] = []
    denied = False
    clauses = with_only([with_looks(without_contrast(clause)) for clause in with_sides(clauses)])
    for clause in map(with_exceptions, _with_order(clauses)):
        parts += _split_negation(clause, denied)
        # "nothing on red, green or blue"
        denied = any(item.text in _DENYING for item in clause) or (
            denied and not has_phrase(clause)
        )
    towers = as_tower([one for part in parts for one in told_apart(part)])
    if not any(item.text in _TOLD_IN_ORDER for clause in towers for item in clause):
        _check_order(clauses)
    return towers


def _check_order(clauses: Sequence[list[Words]]) -> None:
    """Raises InvalidGoalError for "red in stack1, then blue": beside it, or on it?"""
    for clause in clauses:
        for number, item in enumerate(clause):
            behind = list(takewhile(lambda one: one.text not in JOINS, clause[number + 1 :]))
            related = has_phrase(behind) or any(one.text in _NO_NAMES for one in behind)
            if item.text == "then" and behind and not related:
                raise InvalidGoalError(
                    "say where this goes", behind[0].offset, " ".join(one.text for one in behind)
                )


def _place_heading(clause: list[Words]) -> list[Words] | None:
    """ "in stack 1" for "stack 1" or "a tower in stack 1" before a colon; None for all else."""
    if len(clause) == 1 and (side := _OUTERMOST.get(clause[0].text)):
        clause = [Words(f"{side} stack", clause[0].offset, clause[0].stop)]
    if not names_place(clause):
        clause = [item for item in clause if item.text not in (HEADING | MUTE) - NOUN_VERBS]
    if len(clause) > 1 and clause[0].text in ("in", "on", "at"):
        clause = clause[1:]
    if names_place(clause):
        return [Words("in", clause[0].offset, clause[0].offset), *clause]
    return None


def _with_order(clauses: Sequence[list[Words]]) -> list[list[Words]]:
    """ "in stack 1, from bottom to top: red, blue" with the order behind its place."""
    result: list[list[Words]] = []
    for clause in clauses:
        before = result[-1] if result else []
        ordered = any(item.text in ORDERS for item in clause)
        place = len(before) > 1 and before[0].text in ("in", "on", "at")
        if ordered and place and _place_heading(before[1:]):
            result[-1] = [*before, *clause]
        elif ordered and before and is_heading(before):
            result[-1] = clause  # "please stack, starting from the bottom"
        else:
            result.append(clause)
    return result


def _says_nothing(clause: Sequence[Words]) -> bool:
    if clause and clause[0].text == "for" and is_heading(clause):
        return True  # "for the experiment"
    return says_nothing(clause) or (len(clause) == 1 and clause[0].text.isdigit())


def _split(clauses: Sequence[list[Words]]) -> Iterator[list[Words]]:
    """Once more, at words that join relations."""
    for clause in clauses:
        part: list[Words] = []
        for item in clause:
            if item.text in OPENINGS and all(word.text in _BEFORE_OPENING for word in part):
                # What is before is no relation, and none is missing.
                part = []
            elif item.text == "and" and leaves_out(part):
                # "all but red and blue in stack 1"
                part.append(Words(EXCEPT, item.offset, item.stop))
            elif item.text not in JOINS and not (item.text in OPENINGS and has_phrase(part)):
                part.append(item)
            else:
                if item.text == "and":
                    part = without_both(part)
                if part and not _says_nothing(part):
                    yield part
                part = []
        if part and not _says_nothing(part):
            yield part


def _split_negation(clause: list[Words], denied: bool) -> Iterator[list[Words]]:
    """Once more, with "neither … nor" and "not … or" as a list that is denied.

    Args:
        denied: whether the clause before is.
    """
    texts = [item.text for item in clause]
    neither = "neither" in texts and "nor" in texts
    nothing = "or" in texts and any(text in _NONE for text in texts[: texts.index("or")])
    if nothing or (denied and "or" in texts and NEGATION not in texts and not has_phrase(clause)):
        # What is not on red or blue is on none of them.
        yield from _split(
            [
                [
                    Words("and", item.offset, item.stop) if item.text == "or" else item
                    for item in clause
                ]
            ]
        )
        return
    if not neither and not (NEGATION in texts and "or" in texts[texts.index(NEGATION) :]):
        yield from _split([clause])
        return
    start = texts.index("neither" if neither else NEGATION)
    denial = Words(NEGATION, clause[start].offset, clause[start].stop)
    joined = [
        Words("and", item.offset, item.stop) if item.text in ("nor", "or") else item
        for item in clause
        if item.text not in ("neither", NEGATION)
    ]
    parts = list(_split([joined]))
    with_phrase = [has_phrase(part) for part in parts]
    if neither and start == 0 and with_phrase[0] and not all(with_phrase):
        # "neither red on blue nor green": on green, or the green one?
        yield clause
        return
    for index, part in enumerate(parts):
        # What denies is with every relation, or with the last part.
        last = index == len(parts) - 1 and not any(with_phrase)
        yield [denial, *part] if with_phrase[index] or last else part


def is_heading(words: Sequence[Words]) -> bool:
    """Whether it only says that a goal follows: "the goal for my class", "build a tower"."""
    known = HEADING | MUTE
    if len(words) > 1 and words[0].text in known:
        words = [item for item in words if not item.text.isdigit()]  # "step 2"
    exact = [item.text in known for item in words]
    if len(words) > 1 and any(exact):
        exact = [meant(item.text, known, RIGHT_WORDS) is not None for item in words]
    return all(exact)
