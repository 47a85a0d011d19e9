# SPDX-License-Identifier: Apache-2.0
"""What a text may mean by the grammar: all that it says in its cheapest readings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from scene_graph import PREDICATES

from ...errors import InvalidGoalError, PlannerError
from ..example import EXAMPLE, no_relation
from ..parsed import Changed, Parsed, Said
from ..terms import Kind, Words
from .chart import TooManyReadings
from .discourse import Discourse
from .lattice import lattice_of
from .rules import GRAMMAR
from .sentences import Joined
from .tokens import Token, tokens_of

_LITERALS: Final = GRAMMAR.literals()
#: Readings whose costs differ by less than this are as good as one another.
_AS_GOOD: Final = 0.45
#: How much dearer a reading may be than one that makes no sense.
_TOLERATED: Final = 0.9
#: How many words and signs a goal may have.
_LONGEST: Final = 200
#: And one of which a part is skipped.
_LONGEST_SKIPPED: Final = 80
#: What it costs at least to read words that are not known.
_STRANGE: Final = 2.0
#: A reading of all the words, and what it costs.
_Parse = tuple[float, tuple[Joined, ...]]


def parse_goal(text: str) -> Parsed:
    """Reads a goal; of several readings all that are as good as the best.

    Where it is not read whole, what says nothing of blocks is skipped.

    Raises:
        InvalidGoalError: there is none, or the best do not make sense.
    """
    tokens = tokens_of(text)
    parses = _parses(tokens)
    readings, error = _readings(parses)
    strange = parses[0][0] >= _STRANGE if readings else True
    if strange and len(tokens) <= _LONGEST_SKIPPED:
        skipped = _parses(tokens, skipping=True)
        if not readings or skipped[0][0] < parses[0][0]:
            readings = _readings(skipped)[0] or readings
    if not readings and (error is None or parses[0][0] >= _STRANGE):
        raise _not_understood(text, tokens, bool(parses))
    if not readings:
        assert error is not None
        raise error
    sensible = [said for said in readings if not any(map(_senseless, said))]
    return Parsed(tuple(sensible or readings))


def _readings(parses: Sequence[_Parse]) -> tuple[list[tuple[Said, ...]], PlannerError | None]:
    """What the cheapest parses say that make sense; why the first that does not makes none."""
    best: float | None = None
    error: PlannerError | None = None
    readings: dict[tuple[Said, ...], None] = {}
    for cost, joined in parses:
        limit = parses[0][0] + _TOLERATED if best is None else best + _AS_GOOD
        if cost > limit:
            break
        try:
            if any(how == "or" for how, _ in joined):
                raise InvalidGoalError("one of two is asked for; say which")
            items = [(how, item) for how, listed in joined for item in listed]
            said = Discourse().read(items)
        except PlannerError as caught:
            error = error or caught
            continue
        if said:
            best = cost if best is None else best
            readings[said] = None
    return list(readings), error


def _senseless(said: Said) -> bool:
    """Whether it relates a block to itself, or puts a place somewhere."""
    if isinstance(said, Changed) or said.subject.kind is not Kind.THE:
        return False
    return said.subject.words.text == said.object.words.text or said.subject.is_place


def _parses(tokens: Sequence[Token], skipping: bool = False) -> list[_Parse]:
    """What the whole of some words may mean, the cheapest first."""
    if len(tokens) > _LONGEST:
        raise _too_long(tokens)
    lattice = lattice_of(tokens, _LITERALS, skipping)
    try:
        found: list[Any] = GRAMMAR.parses("TEXT", lattice, max(_TOLERATED, _AS_GOOD))
    except (TooManyReadings, RecursionError):
        raise _too_long(tokens) from None
    return [(cost, joined) for _, joined, cost in found]


def _too_long(tokens: Sequence[Token]) -> InvalidGoalError:
    return InvalidGoalError(
        f"{len(tokens)} words are too long to be read as one goal; say it in shorter parts",
        tokens[0].offset,
        f"{tokens[0].text} … {tokens[-1].text}",
    )


def _not_understood(text: str, tokens: Sequence[Token], parsed: bool) -> InvalidGoalError:
    """The error of the first part of a text that is not understood."""
    parts: list[list[Token]] = [[]]
    for token in tokens:
        if token.text in (",", ".", "?", ":", "-", "and"):
            parts.append([])
        else:
            parts[-1].append(token)
    parts = [part for part in parts if part]
    if not parts:
        return InvalidGoalError(f"the goal is empty; {EXAMPLE}")
    wrong = [part for part in parts if not _parses(part)] or [[parts[0][0], parts[-1][-1]]]
    if wrong[0][0] is parts[0][0] and wrong[0][-1] is not parts[-1][-1] and parsed:
        wrong = [[parts[0][0], parts[-1][-1]]]
    words = wrong[0]
    last = len(words)
    while last and words[last - 1].text in ("the", "a"):
        last -= 1
    for start in range(last):
        if tuple(token.text for token in words[start:last]) in PREDICATES.phrases:
            said = text[words[start].offset : words[last - 1].end]
            return InvalidGoalError(
                f"there is no block or place behind this; {EXAMPLE}", words[start].offset, said
            )
    return no_relation(text, [Words(token.text, token.offset, token.end) for token in words])
