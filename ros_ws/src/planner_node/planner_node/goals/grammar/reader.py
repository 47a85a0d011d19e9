# SPDX-License-Identifier: Apache-2.0
"""What a text may mean by the grammar: all that it says in its cheapest readings."""

from __future__ import annotations

from typing import Final

from ...errors import InvalidGoalError, PlannerError
from . import clausal, relational, rows, sentences  # noqa: F401  their rules
from ..parsed import Parsed, Said
from .discourse import Discourse
from .lattice import lattice_of
from .nominal import GRAMMAR
from .tokens import tokens_of

_LITERALS: Final = GRAMMAR.literals()
#: Readings whose costs differ by less than this are as good as one another.
_AS_GOOD: Final = 0.45
#: How much dearer a reading may be than one that makes no sense.
_TOLERATED: Final = 0.9


def parse_goal(text: str) -> Parsed:
    """Reads a goal; of several readings all that are as good as the best.

    Raises:
        InvalidGoalError: there is none, or the best do not make sense.
    """
    lattice = lattice_of(tokens_of(text), _LITERALS)
    parses = [found for found in GRAMMAR.parses("TEXT", lattice) if found[0] == len(lattice)]
    best: float | None = None
    error: PlannerError | None = None
    readings: dict[tuple[Said, ...], float] = {}
    for _, joined, cost in parses:
        limit = parses[0][2] + _TOLERATED if best is None else best + _AS_GOOD
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
            readings.setdefault(said, cost)
    if not readings:
        raise error or InvalidGoalError("it is not understood")
    return Parsed(tuple(readings))
