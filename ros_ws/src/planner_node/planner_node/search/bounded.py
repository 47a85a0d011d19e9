# SPDX-License-Identifier: Apache-2.0
"""A plan that is not much longer than a shortest one, with the proof of how much at most.

Below: the blocks are split into groups that are small enough for tables of all their arrangements,
and the moves are found that two groups need by themselves. Pairs that share no block add up; so
does half of what three pairs need of three groups, as every block is in two of them. Above: the
best of many constructed plans, out of which blocks are taken and put back where they cost fewer
moves, see :mod:`~planner_node.search.reinsertion`.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cache
from itertools import combinations
from typing import Final

from scene_graph import Move, Stacks

from ..goals.goal import complete_goal
from .construct import constructed
from .ends import encoded_word, start_word
from .groups import Group, complete_groups, group_sizes
from .limits import Limits, PartTooLargeError
from .patterns_both_ends import patterns_both_ends, states_along
from .product import ProductSpace
from .reinsertion import shortened
from .state import Problem, State

#: A plan of this many times the proven bound is good enough.
ENOUGH: Final = 1.05
#: Constructed plans each way, and those of them that are looked at further.
CONSTRUCTED: Final = 30
KEPT: Final = 8
#: Moves of plans that are looked at for each block, see :func:`shortened`.
WORK_OF_A_BLOCK: Final = 20_000
#: The share of it that goes to all that are kept; the rest goes to the shortest of them.
FIRST_SHARE: Final = 0.6
#: The largest table of a group, its arrangements times the moves from each; made at the first call.
TABLE: Final = 2_000_000
#: All pairs of so many groups are looked at, of more only neighbours.
ALL_PAIRS: Final = 6
#: States that are looked at of a pair of groups before what is proven by then is its bound.
PART_EXPANSIONS: Final = 60_000


def bounded(problem: Problem, limits: Limits) -> list[State]:
    """A path with a proven bound where the goal is complete and the blocks are many.

    Elsewhere it is a shortest one, as :func:`patterns_both_ends` gives it.
    """
    names = [name for stack in problem.initial for name in stack]
    target = problem.goal.state(names, len(problem.initial))
    if target is None or problem.target is None or len(problem.start) <= 2:
        return patterns_both_ends(problem, limits)
    sizes = _sizes(len(problem.start), len(names))
    if len(sizes) <= 2:
        return patterns_both_ends(problem, limits)
    words = start_word(problem), encoded_word(problem, problem.target)
    groups, _ = complete_groups(*words, len(problem.start), sizes)
    least = _least(problem, target, groups, limits)
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


def _least(problem: Problem, target: Stacks, groups: Sequence[Group], limits: Limits) -> int:
    """Moves that every plan has: those that pairs of groups need by themselves.

    Parts that share no block add up, and so does half of what parts need of which each block is in
    two.
    """
    names = list(problem.symbols)

    def solved(blocks: Sequence[int]) -> int:
        part = {names[block] for block in blocks}
        initial, wanted = _only(problem.initial, part), _only(target, part)
        if initial == wanted:
            return 0
        within = limits.of_a_part(PART_EXPANSIONS)
        try:
            return len(patterns_both_ends(Problem(initial, complete_goal(wanted)), within)) - 1
        except PartTooLargeError:
            return within.at_least or 0

    count = len(groups)
    near = count if count <= ALL_PAIRS else 1
    pairs = {
        (one, other): solved([*groups[one].named, *groups[other].named])
        for one, other in combinations(range(count), 2)
        if other - one <= near or other - one >= count - near
    }
    return -(-_twice(pairs, frozenset(range(count))) // 2)


def _twice(pairs: dict[tuple[int, int], int], left: frozenset[int]) -> int:
    """Twice the most that pairs add up to: each once, or three that share their groups by half."""

    @cache
    def most(left: frozenset[int]) -> int:
        if len(left) < 2:
            return 0
        one, *others = sorted(left)
        best = most(left - {one})
        for other in others:
            if (one, other) in pairs:
                best = max(best, 2 * pairs[one, other] + most(left - {one, other}))
        for second, third in combinations(others, 2):
            three = [(one, second), (one, third), (second, third)]
            if all(pair in pairs for pair in three):
                rest = most(left - {one, second, third})
                best = max(best, sum(pairs[pair] for pair in three) + rest)
        return best

    return most(left)


def _sizes(places: int, blocks: int) -> list[int]:
    """Sizes of the fewest groups whose pairs can be searched by their patterns."""
    largest = TABLE // places**2
    while True:
        sizes = group_sizes(places, blocks, largest)
        pair = [Group(tuple(range(size))) for size in sizes[:2]]
        if ProductSpace.fits(places, pair):
            return sizes
        largest //= 2


def _only(stacks: Stacks, names: set[str]) -> Stacks:
    return tuple(tuple(name for name in stack if name in names) for stack in stacks)
