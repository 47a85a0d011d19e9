# SPDX-License-Identifier: Apache-2.0
"""Both ends of a search by patterns: keys of start and goals, and the distances of the patterns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from .goal_states import goal_states
from .groups import MAX_PATTERNS, Group, complete_groups, group_sizes, partial_groups
from .limits import Limits
from .packed import Keys, Words, word_of
from .patterns import Distances
from .product import LIKE, ProductSpace
from .state import ANY, Problem, State
from .wanted import Wanted

#: Bounds of so many groups are good ones, however small the groups.
FEW_GROUPS: Final = 2


def start_word(problem: Problem) -> Words:
    """The start with the blocks as :class:`Wanted` counts them."""
    return encoded_word(problem, problem.start)


def encoded_word(problem: Problem, state: State) -> Words:
    """A state with the blocks as :class:`Wanted` counts them."""
    index = {symbol: number for number, symbol in enumerate(problem.symbols.values())}
    index[ANY] = LIKE
    return word_of([[index[symbol] for symbol in stack] for stack in state])


@dataclass(frozen=True)
class Ends:
    """What a search is made of.

    Attributes:
        start, goals: keys in ascending order; goals is None where they are too many to be listed.
        to_goal, to_start: the distances of every group's patterns.
    """

    space: ProductSpace
    start: Keys
    goals: Keys | None
    to_goal: list[Distances]
    to_start: list[Distances]


def prepare(problem: Problem, wanted: Wanted, limits: Limits) -> Ends | None:
    """The best split into groups that was found; None where no split fits."""
    places, like = len(problem.start), sum(stack.count(ANY) for stack in problem.start)
    start = start_word(problem)
    if problem.target is not None and not like:
        goals: Words | None = encoded_word(problem, problem.target)
    else:
        goals = goal_states(wanted, places, like, limits.poll)
    if goals is not None and not len(goals):
        raise limits.impossible()
    candidates: list[tuple[Group, ...]]
    if goals is not None and len(goals) == 1 and not like:
        candidates = [_complete(start, goals, places, wanted.blocks)]
    else:
        candidates = list(partial_groups(wanted, places, like))
    best: tuple[int, ProductSpace, list[Distances]] | None = None
    for groups in candidates:
        limits.poll()
        if not groups or not ProductSpace.fits(places, groups):
            continue
        space = ProductSpace(places, groups)
        to_goal = _distances(space, wanted)
        bound = sum(int(table[index[0]]) for table, index in zip(to_goal, space.indices(start)))
        if best is None or bound > best[0]:
            best = (bound, space, to_goal)
    if best is None:
        return None
    _, space, to_goal = best
    to_start = [item.distances(index) for item, index in zip(space.spaces, space.indices(start))]
    return Ends(
        space,
        space.pack(start),
        None if goals is None else np.unique(space.pack(goals)),
        to_goal,
        to_start,
    )


def _complete(start: Words, goal: Words, places: int, blocks: int) -> tuple[Group, ...]:
    """The best split for one goal state, with larger patterns where small ones are many."""
    sizes = group_sizes(places, blocks)
    if len(sizes) > FEW_GROUPS:
        sizes = group_sizes(places, blocks, MAX_PATTERNS)
    trial = tuple(Group(tuple(range(size))) for size in sizes)
    if not ProductSpace.fits(places, trial):
        return ()
    return complete_groups(start, goal, places, sizes)[0]


def _distances(space: ProductSpace, wanted: Wanted) -> list[Distances]:
    return [
        patterns.distances(
            np.flatnonzero(wanted.holds_among(group.named, patterns.stack, patterns.level))
        )
        for group, patterns in zip(space.groups, space.spaces)
    ]
