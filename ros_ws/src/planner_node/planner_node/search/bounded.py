# SPDX-License-Identifier: Apache-2.0
"""A plan that is not much longer than a shortest one, with the proof of how much at most.

Below: the blocks are split into parts that are small enough for shortest plans; the moves that
every part needs by itself add up to a bound. Above: the best of many constructed plans, whose
stretches are replaced by shortest ones until it is within :data:`ENOUGH` times the bound.
"""

from __future__ import annotations

import random
from itertools import combinations
from typing import Final

from scene_graph import Move, Stacks, apply_move

from ..goals.goal import Goal, complete_goal
from .construct import constructed, window_of
from .ends import encoded_word, start_word
from .groups import complete_groups, group_sizes
from .limits import Limits, PartTooLargeError
from .patterns_both_ends import moves_along, patterns_both_ends, states_along
from .state import Problem, State
from .wanted import Wanted

#: A plan of this many times the proven bound is good enough.
ENOUGH: Final = 1.25
#: Blocks whose shortest plan is found at once.
WHOLE: Final = 10
#: Constructed plans each way, and those of them that are looked at further.
CONSTRUCTED: Final = 150
KEPT: Final = 4
#: The rounds: plans that go on, and blocks that their stretches move at most. The patterns of many
#: blocks on three places are few enough for long stretches.
ROUNDS: Final = ((6, 6), (3, 8), (2, 10), (1, 10))
ROUNDS_ON_THREE: Final = ((3, 6), (2, 9), (2, 12), (1, 13))
#: States after which a stretch is left as it is.
MAX_STRETCH_EXPANSIONS: Final = 60_000
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
    plans = [
        plan
        for one, other in ((problem.initial, target), (target, problem.initial))
        for plan in _constructed(one, other, limits)
    ]
    # Every move can be undone: a plan from the goal to the start is one, read backwards.
    plans = [plan if plan[0] == problem.initial else plan[::-1] for plan in plans]
    # One of each, as several are often the same.
    plans = list(dict.fromkeys(plans))
    for kept, most_blocks in ROUNDS_ON_THREE if len(problem.start) == 3 else ROUNDS:
        plans = sorted(plans, key=len)[:kept]
        if len(plans[0]) - 1 <= ENOUGH * least:
            break
        plans = [_shortened(plan, most_blocks, limits) for plan in plans]
    best = min(plans, key=len)
    return states_along(problem.start, moves_along(best))


def _constructed(initial: Stacks, target: Stacks, limits: Limits) -> list[tuple[Stacks, ...]]:
    """The shortest of many constructed plans, as states."""
    plans = []
    for seed in range(CONSTRUCTED):
        limits.poll()
        plans.append(constructed(initial, target, random.Random(seed)))
    return [tuple(_states(initial, plan)) for plan in sorted(plans, key=len)[:KEPT]]


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
        needed = Goal(wanted.relations_among(part))
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


def _shortened(states: tuple[Stacks, ...], most_blocks: int, limits: Limits) -> tuple[Stacks, ...]:
    """The plan with every stretch that can be replaced by a shorter one replaced."""
    first = 0
    while first < len(states) - 1:
        last, start, end = window_of(states, first, most_blocks)
        moves: list[Move] = []
        if start != end:
            part = limits.of_a_part(MAX_STRETCH_EXPANSIONS)
            try:
                moves = moves_along(patterns_both_ends(Problem(start, complete_goal(end)), part))
            except PartTooLargeError:
                # It stays as it is.
                first += max(1, (last - first) // 3)
                continue
        if len(moves) < last - first:
            states = (*states[:first], *_states(states[first], moves), *states[last + 1 :])
        elif last == len(states) - 1:
            break
        first += max(1, len(moves) // 3)
    return states


def _states(initial: Stacks, moves: list[Move]) -> list[Stacks]:
    states = [initial]
    for move in moves:
        states.append(apply_move(states[-1], move))
    return states


def _only(stacks: Stacks, names: set[str]) -> Stacks:
    return tuple(tuple(name for name in stack if name in names) for stack in stacks)
