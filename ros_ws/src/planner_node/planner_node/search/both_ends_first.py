# SPDX-License-Identifier: Apache-2.0
"""Plainly from both ends as long as that is the quickest, then with the bounds of patterns."""

from __future__ import annotations

from typing import Final

from .both_ends import both_ends
from .limits import Limits, PartTooLargeError
from .patterns_both_ends import patterns_both_ends
from .state import Problem, State

#: The plain search has this many expansions, some milliseconds, as long as it takes to make the
#: patterns: most problems of six and seven blocks need fewer.
PLAIN_EXPANSIONS: Final = 3000


def both_ends_first(problem: Problem, limits: Limits) -> list[State]:
    """A shortest path: that of :func:`both_ends`, or else of :func:`patterns_both_ends`.

    A goal that is not complete has no other end to search from, and gets patterns at once.
    """
    if problem.target is None:
        return patterns_both_ends(problem, limits)
    try:
        return both_ends(problem, limits.of_a_part(PLAIN_EXPANSIONS))
    except PartTooLargeError:
        return patterns_both_ends(problem, limits)
