# SPDX-License-Identifier: Apache-2.0
"""A* with a bound on the moves that are left, from what the goal says stands on what."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator

from scene_graph import ABOVE, UP, Relation, base_index

from .limits import Limits
from .state import Parents, Problem, State, path_to, successors

#: What a state leads to: the states after possible moves, and what each move costs.
Following = Callable[[State], Iterable[tuple[State, int]]]


def each_for_one(state: State) -> Iterator[tuple[State, int]]:
    """Every move, at the cost of one."""
    return ((after, 1) for after, _ in successors(state))


def a_star(
    problem: Problem,
    limits: Limits,
    following: Following = each_for_one,
    least: Callable[[State], int] | None = None,
) -> list[State]:
    """Expands the states of least cost + bound first; of equals the one nearest to a goal.

    Args:
        following: fewer states, or higher costs than one, leave the bound a bound.
        least: a bound on the cost that is left, which no move lowers by more than it costs; None:
            that on the moves.
    """
    bound = least or moves_left(problem)
    parents: Parents = {problem.start: None}
    costs = {problem.start: 0}
    expanded: set[State] = set()
    left = bound(problem.start)
    queue = [(left, left, problem.start)]
    while queue:
        _, _, state = heapq.heappop(queue)
        if state in expanded:
            continue
        if problem.unmet(state) is None:
            return path_to(state, parents)
        expanded.add(state)
        limits.count_expansion()
        so_far = costs[state]
        for successor, price in following(state):
            cost = so_far + price
            # The bound is consistent, so that an expanded state has been reached the cheapest way.
            if cost >= costs.get(successor, cost + 1):
                continue
            costs[successor], parents[successor] = cost, state
            left = bound(successor)
            heapq.heappush(queue, (cost + left, left, successor))
    raise limits.unreachable()


def moves_left(problem: Problem) -> Callable[[State], int]:
    """A lower bound on the moves from a state to the goal that a move lowers by one at most.

    A block has to be moved if it is not yet on or above what the goal wants it on or above, if it
    keeps another one from being put directly onto its place, or if it is above such a block. Twice
    it has to be moved if it is on or above the right block and this one has to be moved, or if it
    is above its place with something in between. Other predicates add nothing.

    The bound is consistent: a move takes the top of a stack, so what counts for another block, all
    of it below or beside, still counts after the move, and the block itself counts one less.
    """
    stands = [_Wanted(item, problem) for item in problem.goal.relations if _counts(item, problem)]

    def bound(state: State) -> int:
        # From the level floors[i] on, everything in stack i has to be moved.
        floors = [len(stack) for stack in state]
        twice: set[str] = set()
        kept: list[tuple[str, int, int]] = []
        for item in stands:
            subject_stack, subject_level = _find(state, item.subject)
            stack, level = (item.base, -1) if item.base >= 0 else _find(state, item.object)
            if subject_stack == stack and subject_level > level:
                if not item.directly or subject_level == level + 1:
                    kept.append((item.subject, stack, level))
                    continue
                twice.add(item.subject)
            floors[subject_stack] = min(floors[subject_stack], subject_level)
            if item.directly:
                floors[stack] = min(floors[stack], level + 1)
        for subject, stack, level in kept:
            if level >= floors[stack]:
                twice.add(subject)
        once = sum(len(stack) - floor for stack, floor in zip(state, floors))
        return once + len(twice)

    return bound


class _Wanted:
    """One relation of the goal that puts a block onto something; ``base`` is -1 for a block."""

    def __init__(self, relation: Relation, problem: Problem) -> None:
        self.subject = problem.symbols[relation.subject]
        self.object = problem.symbols.get(relation.object, "")
        index = base_index(relation.object)
        self.base = -1 if index is None else index
        self.directly = relation.predicate == UP


def _counts(relation: Relation, problem: Problem) -> bool:
    """Whether it puts a block that is there onto something that is there."""
    index = base_index(relation.object)
    there = relation.object in problem.symbols if index is None else index < len(problem.start)
    return relation.predicate in (UP, ABOVE) and relation.subject in problem.symbols and there


def _find(state: State, symbol: str) -> tuple[int, int]:
    for index, stack in enumerate(state):
        if symbol in stack:
            return index, stack.index(symbol)
    raise AssertionError(f"{symbol!r} is not in {state}")
