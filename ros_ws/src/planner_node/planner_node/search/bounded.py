# SPDX-License-Identifier: Apache-2.0
"""A plan that is not much longer than a shortest one, with the proof of how much at most.

Below: the moves that parts of the blocks need by themselves, see
:mod:`~planner_node.search.part_bounds`. Above: the best of many constructed plans, out of which
blocks are taken and put back where they cost fewer moves, see
:mod:`~planner_node.search.reinsertion`.
"""

from __future__ import annotations

import random
from math import ceil
from typing import Final

from scene_graph import Move, Stacks

from .construct import constructed
from .ends import encoded_word, start_word
from .groups import Group, complete_groups, group_sizes
from .limits import Limits
from .part_bounds import PartBounds
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
WORK_OF_A_BLOCK: Final = 400_000
#: The share of it that goes to all that are kept; the rest goes to the shortest of them.
FIRST_SHARE: Final = 0.6
#: The largest table of a group, its arrangements times the moves from each; made at the first call.
TABLE: Final = 2_000_000
#: States that are looked at to prove that there is no plan shorter than so.
BOUND_EXPANSIONS: Final = 1_000_000


def bounded(problem: Problem, limits: Limits) -> list[State]:
    """A path with a proven bound where the goal is complete and the blocks are many.

    Elsewhere it is a shortest one, as :func:`patterns_both_ends` gives it.
    """
    names = [name for stack in problem.initial for name in stack]
    target = problem.goal.state(names, len(problem.initial))
    if target is None or problem.target is None or len(problem.start) <= 2:
        return patterns_both_ends(problem, limits)
    places = len(problem.start)
    if _few(places, len(names)):
        return patterns_both_ends(problem, limits)
    bounds = None
    if PartBounds.possible(places, len(names)):
        bounds = PartBounds(problem.initial, target, limits)
        least = bounds.least
    else:
        words = start_word(problem), encoded_word(problem, problem.target)
        _, least = complete_groups(*words, places, _sizes(places, len(names)))
    limits.prove_at_least(least)
    work = WORK_OF_A_BLOCK * len(names)

    def shorter(moves: list[Move], share: float) -> list[Move]:
        return shortened(problem.initial, target, moves, ENOUGH * least, int(share * work), limits)

    plans = [
        shorter(moves, FIRST_SHARE / KEPT)
        for moves in _constructed(problem.initial, target, limits)
    ]
    plan = shorter(min(plans, key=len), 1.0 - FIRST_SHARE)
    if bounds is not None:
        bounds.raise_to(ceil(len(plan) / ENOUGH), BOUND_EXPANSIONS, limits)
        limits.prove_at_least(bounds.least)
    return states_along(problem.start, plan)


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


def _few(places: int, blocks: int) -> bool:
    """Whether a search by the patterns of two groups would end."""
    return len(_sizes(places, blocks)) <= 2


def _sizes(places: int, blocks: int) -> list[int]:
    """Sizes of the fewest groups whose pairs can be searched by their patterns."""
    largest = TABLE // places**2
    while True:
        sizes = group_sizes(places, blocks, largest)
        pair = [Group(tuple(range(size))) for size in sizes[:2]]
        if ProductSpace.fits(places, pair):
            return sizes
        largest //= 2
