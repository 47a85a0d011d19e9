# SPDX-License-Identifier: Apache-2.0
"""Shorter plans: blocks are taken out of a plan and put back where they cost the fewest moves.

What a block costs among the moves of all others is found exactly, by dynamic programming over
these moves. A plan gets shorter as long as there are few blocks that are moved too often together.
In C (``reinsertion.c``) where that can be compiled, and else in Python, with less effort.
"""

from __future__ import annotations

import ctypes
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from tamp_runtime.machine_code import address, written

from scene_graph import Move, Stacks

from .group_tables import MOST_PLACES
from .limits import Limits
from .part_bounds import MOST_BLOCKS, Going, spots_by_name

#: Blocks that are taken out together at most, and how far from each other they stand at the end
#: where they are chosen from one stack.
MOST_OUT: Final = 7
NEAR: Final = 2
#: How often a plan goes on that is one move longer, in C and in Python.
WORSE: Final = 0.06
WORSE_IN_PYTHON: Final = 0.02
#: How much less effort there is in Python.
SLOWER: Final = 20
#: Moves of plans that C has room for, and that it looks at between two looks at the limits: some
#: milliseconds.
MOST_STEPS: Final = 1024
CHUNK: Final = 1_000_000

_FILE: Final = Path(__file__).with_suffix(".c")


class Step(NamedTuple):
    """A move, and the block that it moves."""

    block: str
    source: int
    target: int


class _Spot(NamedTuple):
    """Where a block stands: its stack, and how many of the others there are below it."""

    stack: int
    level: int


def shortened(
    initial: Stacks, target: Stacks, moves: Sequence[Move], enough: float, work: int, limits: Limits
) -> list[Move]:
    """A plan from one state to another that is no longer than the one given.

    Args:
        enough: a plan of so many moves is short enough.
        work: how many moves of plans are looked at before it is left as it is.
    """
    names = [name for stack in initial for name in stack]
    fits = len(names) <= MOST_BLOCKS and len(initial) <= MOST_PLACES and len(moves) <= MOST_STEPS
    library = written(_FILE) if fits else None
    if library is None:
        return shortened_in_python(initial, target, moves, enough, work // SLOWER, limits)
    number = {name: index for index, name in enumerate(names)}
    steps = [(number[step.block], *step[1:]) for step in steps_of(initial, moves)]
    plan = np.array(steps, np.uint8).reshape(-1, 3)
    start, goal = (spots_by_name(stacks, names) for stacks in (initial, target))
    room = ctypes.create_string_buffer(library.room())
    with Going(limits, count=False) as going:
        length = library.shorten(
            room, len(names), len(initial),
            address(start), address(goal), address(plan),
            len(plan), ctypes.c_double(enough),
            ctypes.c_long(work), MOST_OUT, NEAR, round(1000 * WORSE), CHUNK, going.on,
        )  # fmt: skip
    return [Move(source, to) for _, source, to in plan[:length].tolist()]


def shortened_in_python(
    initial: Stacks, target: Stacks, moves: Sequence[Move], enough: float, work: int, limits: Limits
) -> list[Move]:
    """As :func:`shortened`."""
    rng = random.Random(0)
    reinsertion = Reinsertion(initial, target)
    current = best = steps_of(initial, moves)
    while len(best) > enough and work > 0:
        limits.poll()
        out = reinsertion.chosen(rng)
        work -= len(out) * len(current)
        changed = reinsertion.again(current, out)
        slack = rng.random() < WORSE_IN_PYTHON
        if changed is not None and len(changed) <= len(current) + slack:
            current = changed
            if len(current) < len(best):
                best = current
    return [Move(step.source, step.target) for step in best]


class Reinsertion:
    """Takes blocks out of plans between two states, and puts them back."""

    def __init__(self, initial: Stacks, target: Stacks) -> None:
        self._initial, self._target = initial, target
        self._names = [name for stack in initial for name in stack]
        self._last = {name: index for index, stack in enumerate(target) for name in stack}

    def chosen(self, rng: random.Random) -> list[str]:
        """Blocks to take out, in the order in which they come back."""
        number = rng.randint(1, MOST_OUT)
        if rng.random() < 0.5:
            return rng.sample(self._names, min(number, len(self._names)))
        one = rng.choice(self._names)
        stack = self._target[self._last[one]]
        level = stack.index(one)
        near = [name for name in stack[max(0, level - NEAR) : level + NEAR + 1] if name != one]
        out = [one, *rng.sample(near, min(number - 1, len(near)))]
        rng.shuffle(out)
        return out

    def again(self, plan: Sequence[Step], out: Sequence[str]) -> list[Step] | None:
        """The plan with these blocks taken out and put back; None: one of them fits nowhere."""
        left = set(out)
        steps = [step for step in plan if step.block not in left]
        for name in out:
            extended = self._with(steps, name, left)
            if extended is None:
                return None
            steps = extended
            left.discard(name)
        return steps

    def _with(self, steps: list[Step], name: str, absent: set[str]) -> list[Step] | None:
        """A block's cheapest way among the steps of others, put between them."""
        start, end = (self._spot(stacks, name, absent) for stacks in (self._initial, self._target))
        heights = [sum(other not in absent for other in stack) for stack in self._initial]
        ways = _cheapest(steps, heights, start, end)
        if ways is None:
            return None
        result: list[Step] = []
        done = 0
        for before, source, target in ways:
            result += steps[done:before]
            result.append(Step(name, source, target))
            done = before
        return result + steps[done:]

    @staticmethod
    def _spot(stacks: Stacks, name: str, absent: set[str]) -> _Spot:
        for index, stack in enumerate(stacks):
            if name in stack:
                below = stack[: stack.index(name)]
                return _Spot(index, sum(other not in absent for other in below))
        raise KeyError(name)


#: The last move of a block on its cheapest way to a spot, with those before it: before which step
#: it is, from where and to where. None: it has not moved.
_Way = tuple["_Way | None", int, int, int]

#: The moves to a spot that cannot be reached.
_FAR: Final = 1 << 20


def _cheapest(
    steps: Sequence[Step], heights: Sequence[int], start: _Spot, end: _Spot
) -> list[tuple[int, int, int]] | None:
    """The fewest moves of one block among the steps of the others; None where there are none.

    Args:
        heights: of the stacks at the start, without the block.

    Returns:
        Before which step each is, from where and to where.
    """
    # Of every stack, for each level: the moves that the block needs to be there, and the last of
    # them. The last level is the top, where the block is free to go.
    cost = [[_FAR] * (height + 1) for height in heights]
    ways: list[list[_Way | None]] = [[None] * (height + 1) for height in heights]
    cost[start.stack][start.level] = 0
    stacks = range(len(heights))
    for index in range(len(steps) + 1):
        tops = [levels[-1] for levels in cost]
        least = min(tops) + 1
        if max(tops) > least:
            source = tops.index(least - 1)
            for stack in stacks:
                if tops[stack] > least:
                    cost[stack][-1] = least
                    ways[stack][-1] = (ways[source][-1], index, source, stack)
        if index < len(steps):
            _, source, target = steps[index]
            # Who stands on the block that moves is in its way.
            cost[source].pop()
            ways[source].pop()
            cost[target].append(_FAR)
            ways[target].append(None)
    if cost[end.stack][end.level] >= _FAR:
        return None
    moves = []
    way = ways[end.stack][end.level]
    while way is not None:
        moves.append(way[1:])
        way = way[0]
    return moves[::-1]


def steps_of(initial: Stacks, moves: Sequence[Move]) -> list[Step]:
    """The moves of a plan with the blocks that they move."""
    stacks = [list(stack) for stack in initial]
    steps = []
    for move in moves:
        stacks[move.target].append(stacks[move.source].pop())
        steps.append(Step(stacks[move.target][-1], move.source, move.target))
    return steps
