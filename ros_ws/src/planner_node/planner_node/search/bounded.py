# SPDX-License-Identifier: Apache-2.0
"""A plan that is not much longer than a shortest one, with the proof of how much at most.

Below: the blocks are split into parts that are small enough for shortest plans; the moves that
every part needs by itself add up to a bound. Above: the best of many constructed plans, out of
which blocks are taken and put back where they cost fewer moves, see
:mod:`~planner_node.search.reinsertion`.
"""

from __future__ import annotations

import random
from itertools import combinations
from typing import Final

from scene_graph import Move, Stacks

from ..goals.goal import Goal
from .construct import constructed
from .ends import encoded_word, start_word
from .groups import complete_groups, group_sizes
from .limits import Limits
from .patterns_both_ends import patterns_both_ends, states_along
from .reinsertion import shortened
from .state import Problem, State
from .wanted import Wanted

#: A plan of this many times the proven bound is good enough.
ENOUGH: Final = 1.05
#: Blocks whose shortest plan is found at once.
WHOLE: Final = 10
#: Constructed plans each way, and those of them that are looked at further.
CONSTRUCTED: Final = 30
KEPT: Final = 8
#: Moves of plans that are looked at for each block, see :func:`shortened`.
WORK_OF_A_BLOCK: Final = 12_000
#: The share of it that goes to all that are kept; the rest goes to the shortest of them.
FIRST_SHARE: Final = 0.6
#: Patterns of a group of the split that is tried for the bound.
GUIDE_PATTERNS: Final = 16_000


def bounded(problem: Problem, limits: Limits) -> list[State]:
    """A path with a proven bound where the goal is complete and the blocks are many.

    Elsewhere it is a shortest one, as :func:`patterns_both_ends` gives it.
    """
    names = [name for stack in problem.initial for name in stack]
    target = problem.goal.state(names, len(problem.initial))
    if target is None or len(problem.start) <= 2 or len(names) <= WHOLE:
        return patterns_both_ends(problem, limits)
    least = _least(problem, limits)
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


def _least(problem: Problem, limits: Limits) -> int:
    """Moves that every plan has: those that parts of the blocks need by themselves."""
    wanted, places = Wanted(problem), len(problem.start)
    assert problem.target is not None
    start, goal = start_word(problem), encoded_word(problem, problem.target)
    sizes = group_sizes(places, wanted.blocks, GUIDE_PATTERNS)
    groups, _ = complete_groups(start, goal, places, sizes)
    names = list(problem.symbols)

    def solved(blocks: tuple[int, ...]) -> int:
        part = {names[block] for block in blocks}
        initial = _only(problem.initial, part)
        needed = Goal(wanted.relations_among(part), rows=problem.goal.rows)
        if needed.holds(initial):
            return 0
        return len(patterns_both_ends(Problem(initial, needed), limits.of_a_part())) - 1

    alone = [solved(group.named) for group in groups]
    gains = {}
    for one, other in combinations(range(len(groups)), 2):
        pair = (*groups[one].named, *groups[other].named)
        if len(pair) <= WHOLE:
            gains[one, other] = solved(pair) - alone[one] - alone[other]
    return sum(alone) + _best_matching(gains, frozenset(range(len(groups))))


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
