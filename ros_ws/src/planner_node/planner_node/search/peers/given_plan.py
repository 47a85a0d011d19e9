# SPDX-License-Identifier: Apache-2.0
"""A plan that another planner made: read, checked, and used as one of our own."""

from __future__ import annotations

import time
from math import inf

from scene_graph import Stacks, apply_move

from ...errors import GivenPlanError
from ...goals.goal import Goal, complete_goal
from ...validator import InvalidPlanError, validate_plan, validate_stability
from ..plan import SearchResult
from ..stability import Stability
from .read_plan import read_moves


def checked_plan(
    text: str, initial: Stacks, goal: Goal | None, stability: Stability | None = None
) -> SearchResult:
    """Another planner's plan, found right by the validator of our own plans.

    Args:
        goal: what it has to lead to; None: whatever it does.
        stability: what may stand on what; None: whatever does.

    Raises:
        GivenPlanError: it cannot be read, is not possible, misses the goal, or puts a block where
            it cannot stand; the message names the step.
    """
    started = time.perf_counter()
    moves = read_moves(text, initial)
    states = [initial]
    for move in moves:
        states.append(apply_move(states[-1], move))
    unstable = stability.unstable(initial, moves) if stability is not None else ()
    try:
        validate_plan(initial, goal or complete_goal(states[-1]), moves, states)
        if stability is not None:
            validate_stability(initial, moves, stability, unstable)
    except InvalidPlanError as error:
        raise GivenPlanError(str(error), error.step) from error
    note = f"unstable: {', '.join(map(str, unstable))}" if unstable else ""
    seconds = time.perf_counter() - started
    return SearchResult(tuple(moves), tuple(states), 0, seconds, inf, unstable, note)
