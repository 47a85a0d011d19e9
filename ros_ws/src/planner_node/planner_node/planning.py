# SPDX-License-Identifier: Apache-2.0
"""From a state and a goal to a shortest plan, or to the reason why there is none."""

from __future__ import annotations

from collections.abc import Callable

from scene_graph import Stacks

from .contradictions import check_contradictions
from .goals import Goal
from .search import DEFAULT_MAX_EXPANSIONS, SearchResult, search


def make_plan(
    initial: Stacks,
    goal: Goal,
    max_expansions: int = DEFAULT_MAX_EXPANSIONS,
    cancelled: Callable[[], bool] = lambda: False,
) -> SearchResult:
    """A shortest plan (5.2.2); see :func:`planner_node.search.search` for the arguments.

    Raises:
        ContradictoryGoalError: the goal's relations exclude one another.
        UnreachableError, SearchLimitError, SearchCancelledError: see the search.
    """
    check_contradictions(goal, len(initial))
    return search(initial, goal, max_expansions, cancelled)
