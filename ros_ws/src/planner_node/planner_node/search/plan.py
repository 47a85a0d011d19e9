# SPDX-License-Identifier: Apache-2.0
"""From a state and a goal to a shortest plan, or to the reason why there is none (5.2.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

from scene_graph import Move, Stacks, apply_move

from ..errors import ContradictoryGoalError, UnreachableError
from ..goals.contradictions import check_contradictions
from ..goals.goal import Goal
from ..validator import validate_plan
from .algorithms import AUTO, algorithm_named
from .blame import excluding_parts
from .limits import DEFAULT_MAX_EXPANSIONS, Limits
from .stability import Unstable
from .state import Problem, State


@dataclass(frozen=True)
class SearchResult:
    """A plan; a shortest one but for algorithms that say otherwise by ``bound``.

    Attributes:
        moves: empty if the goal already holds.
        states: the initial state and the one after each move.
        expanded: number of states whose successors were generated.
        seconds: wall time.
        bound: how many times as long as a shortest plan it is at most, proven; 1.0: it is shortest,
            or shortest of those that put nothing where it is unstable.
        unstable: what it puts where it is unstable, as far as that was asked for.
        note: a sentence on these for people; empty where there is nothing to be said.
    """

    moves: tuple[Move, ...]
    states: tuple[Stacks, ...]
    expanded: int
    seconds: float
    bound: float = 1.0
    unstable: tuple[Unstable, ...] = ()
    note: str = ""

    def move_by_move(self) -> tuple[SearchResult, ...]:
        """The same in as many parts as there are moves."""
        return tuple(
            replace(self, moves=(move,), states=states)
            for move, states in zip(self.moves, pairwise(self.states))
        )


def make_plan(
    initial: Stacks,
    goal: Goal,
    max_expansions: int = DEFAULT_MAX_EXPANSIONS,
    cancelled: Callable[[], bool] = lambda: False,
    algorithm: str = AUTO,
) -> SearchResult:
    """A plan that an independent check found right; see :func:`search` for the arguments.

    Raises:
        InvalidPlanError: the search is defective; nothing of its plan may be used.
        ContradictoryGoalError: parts of the goal exclude one another; they are named.
        UnreachableError, SearchLimitError, SearchCancelledError: see :func:`search`.
    """
    check_contradictions(goal, len(initial))
    try:
        found = search(initial, goal, max_expansions, cancelled, algorithm)
    except UnreachableError:
        parts = excluding_parts(initial, goal, Limits(initial, goal, max_expansions, cancelled))
        if parts is None:
            raise
        raise ContradictoryGoalError(
            [part.words for part in parts],
            f"no arrangement of these blocks on {len(initial)} places fulfils all of this",
        ) from None
    validate_plan(initial, goal, found.moves, found.states)
    return found


def search(
    initial: Stacks,
    goal: Goal,
    max_expansions: int = DEFAULT_MAX_EXPANSIONS,
    cancelled: Callable[[], bool] = lambda: False,
    algorithm: str = AUTO,
) -> SearchResult:
    """A shortest sequence of moves from a state to a goal.

    Args:
        cancelled: polled every few milliseconds.
        algorithm: one of :data:`planner_node.search.ALGORITHMS`.

    Raises:
        UnreachableError: proven, by search or as no arrangement of the blocks fulfils the goal.
        SearchLimitError: ``max_expansions`` states were expanded before that.
        SearchCancelledError: ``cancelled`` returned True.
        ValueError: there is no such algorithm.
    """
    find_path = algorithm_named(algorithm)
    limits = Limits(initial, goal, max_expansions, cancelled)
    moves: tuple[Move, ...] = ()
    if not goal.holds(initial):
        path = find_path(Problem(initial, goal), limits)
        moves = tuple(_move_between(before, after) for before, after in pairwise(path))
    states = [initial]
    for move in moves:
        states.append(apply_move(states[-1], move))
    bound = len(moves) / limits.at_least if moves and limits.at_least else 1.0
    note = ""
    if bound > 1.0:
        note = f"{bound:.2f} times as long as the proven least, {limits.at_least} moves"
    return SearchResult(moves, tuple(states), limits.expanded, limits.seconds(), bound, note=note)


def _move_between(before: State, after: State) -> Move:
    changes = [len(new) - len(old) for old, new in zip(before, after)]
    return Move(changes.index(-1), changes.index(1))
