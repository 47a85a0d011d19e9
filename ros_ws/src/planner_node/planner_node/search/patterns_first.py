# SPDX-License-Identifier: Apache-2.0
"""A* with the bounds of patterns, state by state; and where that takes long, layers of arrays.

Up to eight blocks or so the bounds are so good that a hundred states are looked at. Each then costs
some microseconds in plain Python, where a layer of arrays costs a millisecond however few states it
has. The distances are those to a goal whose blocks are named anew in its own order, which are the
same for all problems of one shape: nothing but the search is left to be done for each.
"""

from __future__ import annotations

from functools import lru_cache
from heapq import heappop, heappush
from typing import Final

import numpy as np

from .bounded import bounded
from .ends import encoded_word, start_word
from .groups import complete_groups, largest_first
from .limits import Limits, PartTooLargeError
from .packed import word_of
from .patterns import pattern_space
from .state import Parents, Problem, State, path_to

#: What is looked at state by state, some milliseconds, before layers of arrays are the quicker way.
MOST_EXPANSIONS: Final = 1500


def patterns_first(problem: Problem, limits: Limits) -> list[State]:
    """A shortest path: that of :func:`patterns_a_star`, or else of :func:`bounded`.

    A goal that is not complete, or fewer than three places, get the second at once; it is shortest
    but for complete goals of so many blocks that no search would end.
    """
    if problem.target is None or len(problem.start) <= 2:
        return bounded(problem, limits)
    try:
        return patterns_a_star(problem, limits.of_a_part(MOST_EXPANSIONS))
    except PartTooLargeError:
        return bounded(problem, limits)


def patterns_a_star(problem: Problem, limits: Limits) -> list[State]:
    """A shortest path to the one state that a complete goal allows, on three places or more.

    Raises:
        SearchLimitError, SearchCancelledError, PartTooLargeError: see :class:`Limits`.
    """
    target = problem.target
    assert target is not None
    patterns = _Patterns(problem, target)
    group_of, tables, moves = patterns.group_of, patterns.distances, patterns.moves
    places = range(len(problem.start))
    left = patterns.bound
    parents: Parents = {problem.start: None}
    costs = {problem.start: 0}
    expanded: set[State] = set()
    queue = [(left, left, problem.start, patterns.start)]
    while queue:
        total, left, state, indices = heappop(queue)
        if state == target:
            return path_to(state, parents)
        # The bound is consistent, so that a state is reached the shortest way when it is expanded.
        if state in expanded:
            continue
        expanded.add(state)
        limits.count_expansion()
        cost = total - left + 1
        for source in places:
            stack = state[source]
            if not stack:
                continue
            number = group_of[stack[-1]]
            index, table, after = indices[number], tables[number], moves[number]
            others = left - table[index]
            stacks = list(state)
            stacks[source] = stack[:-1]
            for place in places:
                if place == source:
                    continue
                stacks[place] += stack[-1]
                successor = tuple(stacks)
                stacks[place] = state[place]
                if costs.get(successor, cost + 1) <= cost:
                    continue
                costs[successor], parents[successor] = cost, state
                moved = after[source * len(places) + place][index]
                bound = others + table[moved]
                changed = (*indices[:number], moved, *indices[number + 1 :])
                heappush(queue, (cost + bound, bound, successor, changed))
    raise limits.unreachable()


class _Patterns:
    """The groups of one problem.

    Attributes:
        group_of: the number of a symbol's group.
        distances, moves: of every group, see :class:`.patterns.PatternSpace`.
        start: the indices of the start's patterns.
        bound: their distances, added up.
    """

    def __init__(self, problem: Problem, target: State) -> None:
        places, symbols = len(target), list(problem.symbols.values())
        words = start_word(problem), encoded_word(problem, target)
        groups, self.bound = complete_groups(*words, places, largest_first(places, len(symbols)))
        self.group_of: dict[str, int] = {}
        self.distances: list[list[int]] = []
        self.moves: list[list[list[int]]] = []
        start: list[int] = []
        for number, group in enumerate(groups):
            ours = {symbols[block] for block in group.named}
            self.group_of |= dict.fromkeys(ours, number)
            column = [[symbol for symbol in stack if symbol in ours] for stack in target]
            named = {symbol: new for new, symbol in enumerate(s for stack in column for s in stack)}
            word = word_of([[named[s] for s in stack if s in ours] for stack in problem.start])
            start.append(int(pattern_space(places, len(named), 0).index(word)[0]))
            self.distances.append(_distances(places, tuple(map(len, column))))
            self.moves.append(_moves(places, len(named)))
        self.start = tuple(start)


@lru_cache(maxsize=512)
def _distances(places: int, heights: tuple[int, ...]) -> list[int]:
    """As a list, whose items are read one by one more quickly."""
    table: np.ndarray = pattern_space(places, sum(heights), 0).canonical_distances(heights)
    return table.tolist()


@lru_cache(maxsize=16)
def _moves(places: int, blocks: int) -> list[list[int]]:
    return pattern_space(places, blocks, 0).moves.tolist()
