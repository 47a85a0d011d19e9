# SPDX-License-Identifier: Apache-2.0
"""A plan that is not much longer than a shortest one, with the proof of how much at most.

Below: the blocks are split into parts that are small enough for shortest plans; the moves that
every part needs by itself add up to a bound. So do those of parts that share blocks, each counted
for as many parts as a block is in. Above: the best of many constructed plans, out of
which blocks are taken and put back where they cost fewer moves, see
:mod:`~planner_node.search.reinsertion`.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import combinations
from typing import Final

from scene_graph import Move, Stacks

from ..goals.goal import complete_goal
from .construct import constructed
from .ends import encoded_word, start_word
from .groups import complete_groups, group_sizes
from .limits import Limits, PartTooLargeError
from .patterns import pattern_count
from .patterns_both_ends import patterns_both_ends, states_along
from .patterns_first import patterns_first
from .reinsertion import shortened
from .state import Problem, State

#: A plan of this many times the proven bound is good enough.
ENOUGH: Final = 1.05
#: Blocks whose shortest plan is found at once.
WHOLE: Final = 10
#: Constructed plans each way, and those of them that are looked at further.
CONSTRUCTED: Final = 30
KEPT: Final = 8
#: Moves of plans that are looked at for each block, see :func:`shortened`.
WORK_OF_A_BLOCK: Final = 20_000
#: The share of it that goes to all that are kept; the rest goes to the shortest of them.
FIRST_SHARE: Final = 0.6
#: Patterns of a group of the split that is tried for the bound.
GUIDE_PATTERNS: Final = 16_000
#: Up to so many places three groups in turn are looked at together, of so many blocks each, as long
#: as there are no more states than that.
FEW_PLACES: Final = 3
CIRCLE: Final = 4
CIRCLE_EXPANSIONS: Final = 60_000


def bounded(problem: Problem, limits: Limits) -> list[State]:
    """A path with a proven bound where the goal is complete and the blocks are many.

    Elsewhere it is a shortest one, as :func:`patterns_both_ends` gives it.
    """
    names = [name for stack in problem.initial for name in stack]
    target = problem.goal.state(names, len(problem.initial))
    if target is None or len(problem.start) <= 2 or len(names) <= WHOLE:
        return patterns_both_ends(problem, limits)
    least = _least(problem, target, limits)
    limits.prove_at_least(least)
    work = WORK_OF_A_BLOCK * len(names)

    def shorter(moves: list[Move], share: float) -> list[Move]:
        return shortened(problem.initial, target, moves, ENOUGH * least, int(share * work), limits)

    plans = [
        shorter(moves, FIRST_SHARE / KEPT)
        for moves in _constructed(problem.initial, target, limits)
    ]
    return states_along(problem.start, shorter(min(plans, key=len), 1.0 - FIRST_SHARE))


def _constructed(initial: Stacks, target: Stacks, limits: Limits) -> list[list[Move]]:
    """The shortest of many constructed plans."""
    plans = []
    for seed in range(CONSTRUCTED):
        limits.poll()
        plans.append(constructed(initial, target, random.Random(seed)))
        # Every move can be undone: a plan from the goal to the start is one, read backwards.
        back = constructed(target, initial, random.Random(seed))
        plans.append([Move(move.target, move.source) for move in reversed(back)])
    return sorted(plans, key=len)[:KEPT]


def _least(problem: Problem, target: Stacks, limits: Limits) -> int:
    """Moves that every plan has: those that parts of the blocks need by themselves.

    Parts that share no block add up. Where every block is in three parts of a circle, their sum
    counts every move three times.
    """
    places = len(problem.start)
    assert problem.target is not None
    start, goal = start_word(problem), encoded_word(problem, problem.target)
    names = list(problem.symbols)

    def solved(blocks: Sequence[int], expansions: int | None = None) -> int:
        part = {names[block] for block in blocks}
        initial, wanted = _only(problem.initial, part), _only(target, part)
        if initial == wanted:
            return 0
        within = limits.of_a_part(expansions)
        try:
            return len(patterns_first(Problem(initial, complete_goal(wanted)), within)) - 1
        except PartTooLargeError:
            return within.at_least or 0

    groups, _ = complete_groups(
        start, goal, places, group_sizes(places, len(names), GUIDE_PATTERNS)
    )
    alone = [solved(group.named) for group in groups]
    gains = {}
    for one, other in combinations(range(len(groups)), 2):
        pair = (*groups[one].named, *groups[other].named)
        if len(pair) <= WHOLE:
            gains[one, other] = solved(pair) - alone[one] - alone[other]
    least = sum(alone) + _best_matching(gains, frozenset(range(len(groups))))
    if places > FEW_PLACES:
        return least
    sizes = group_sizes(places, len(names), pattern_count(places, CIRCLE, 0))
    if len(sizes) < 4:
        return least
    circle = [group.named for group in complete_groups(start, goal, places, sizes)[0]]
    total = sum(
        solved([*circle[index - 2], *circle[index - 1], *circle[index]], CIRCLE_EXPANSIONS)
        for index in range(len(circle))
    )
    return max(least, -(-total // 3))


def _best_matching(gains: dict[tuple[int, int], int], left: frozenset[int]) -> int:
    """The largest sum of gains of pairs of which no two share a group."""
    if not left:
        return 0
    one = min(left)
    best = _best_matching(gains, left - {one})
    for other in left - {one}:
        if (one, other) in gains:
            rest = _best_matching(gains, left - {one, other})
            best = max(best, gains[one, other] + rest)
    return best


def _only(stacks: Stacks, names: set[str]) -> Stacks:
    return tuple(tuple(name for name in stack if name in names) for stack in stacks)
