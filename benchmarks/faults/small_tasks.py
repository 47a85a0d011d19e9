# SPDX-License-Identifier: Apache-2.0
"""Small tasks by seed: a layout, and a goal one or two moves away."""

from __future__ import annotations

import numpy as np

from scene_graph import Stacks
from sim_node.layouts import random_layout

BLOCKS = 4


def first_layout(seed: int) -> Stacks:
    """Where the blocks stand when a trial begins."""
    return random_layout(seed, BLOCKS)


def some_moves_away(stacks: Stacks, moves: int, seed: int) -> Stacks:
    """A state that takes exactly so many moves, 1 or 2, each of another block if that can be."""
    rng = np.random.default_rng([seed, moves])
    state, moved = stacks, ""
    for _ in range(moves):
        sources = [place for place, stack in enumerate(state) if stack and stack[-1] != moved]
        if not sources:  # one tower, and its top has moved already: nothing else can
            break
        source = int(rng.choice(sources))
        target = int(rng.choice([place for place in range(len(state)) if place != source]))
        moved = state[source][-1]
        state = moved_to(state, source, target)
    return state


def moved_to(stacks: Stacks, source: int, target: int) -> Stacks:
    """The state after the top of one stack went to another."""
    changed = [list(stack) for stack in stacks]
    changed[target].append(changed[source].pop())
    return tuple(tuple(stack) for stack in changed)


def without_top(stacks: Stacks, seed: int) -> Stacks:
    """The same, with the top of some stack taken away."""
    rng = np.random.default_rng([seed, 7])
    source = int(rng.choice([place for place, stack in enumerate(stacks) if stack]))
    return tuple(stack[:-1] if place == source else stack for place, stack in enumerate(stacks))


def other_layout(stacks: Stacks, seed: int) -> Stacks:
    """The same blocks somewhere else: the stacks turned by one place, each upside down or not."""
    upside_down = bool(np.random.default_rng([seed, 8]).integers(2))
    turned = stacks[1:] + stacks[:1]
    return tuple(stack[::-1] if upside_down else stack for stack in turned)


def two_blocks_swapped(stacks: Stacks, seed: int) -> Stacks:
    """The same stacks, with two blocks in one another's place."""
    names = sorted(name for stack in stacks for name in stack)
    first, second = np.random.default_rng([seed, 9]).choice(names, 2, replace=False)
    other = {str(first): str(second), str(second): str(first)}
    return tuple(tuple(other.get(name, name) for name in stack) for stack in stacks)
