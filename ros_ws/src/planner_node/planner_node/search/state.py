# SPDX-License-Identifier: Apache-2.0
"""States as short strings, the moves between them, and the test for the goal.

Blocks that the goal does not mention are interchangeable: under one symbol for all of them, 7
blocks have 1,512 states in place of 181,440 for a goal that names two.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Final

from scene_graph import UP, Stacks

from ..goals.goal import Goal
from .conditions import Condition, Conditions, State

#: How a state was first reached: the one before it, None for the first.
Parents = dict[State, "State | None"]

#: Stands for every block that the goal does not mention.
ANY: Final = "*"
#: Letters beyond ASCII, so that no symbol is the one above.
_FIRST_SYMBOL: Final = 0x100


class Problem:
    """What a search algorithm is asked: the way from ``start`` to a state that is a goal.

    Attributes:
        initial, goal: what was asked, in names.
        start: the initial state, encoded.
        symbols: the character of every block that the goal mentions and that is there.
        target: the one state that a complete goal allows, encoded; None for other goals.
    """

    def __init__(self, initial: Stacks, goal: Goal) -> None:
        names = [name for stack in initial for name in stack]
        mentioned = sorted(goal.names & set(names))
        self.initial, self.goal = initial, goal
        self.symbols: Mapping[str, str] = {
            name: chr(_FIRST_SYMBOL + index) for index, name in enumerate(mentioned)
        }
        self.start = _encode(initial, self.symbols)
        target = goal.state(names, len(initial))
        self.target = None if target is None else _encode(target, self.symbols)

    def unmet(self, state: State) -> Condition | None:
        """The first part of the goal that a state does not fulfil; None: it is a goal."""
        for condition in self._conditions:
            if not condition.holds(state):
                return condition
        return None

    @cached_property
    def _conditions(self) -> tuple[Condition, ...]:
        """One a relation or count, the strictest first."""
        height = sum(map(len, self.start))
        conditions = Conditions(self.symbols, len(self.start), height, self.goal.rows)
        order = sorted(self.goal.relations, key=lambda item: item.predicate != UP)
        relations = [conditions.of(item) for item in order]
        return (*relations, *map(conditions.of_count, self.goal.counts))


def successors(state: State) -> Iterator[tuple[State, str]]:
    """The state after every possible move, and the symbol of the block that is moved."""
    for source, stack in enumerate(state):
        if not stack:
            continue
        top = stack[-1]
        lowered = (*state[:source], stack[:-1], *state[source + 1 :])
        for target, other in enumerate(state):
            if target != source:
                yield (*lowered[:target], other + top, *lowered[target + 1 :]), top


def path_to(end: State, parents: Parents) -> list[State]:
    """From the root to ``end``."""
    path = []
    state: State | None = end
    while state is not None:
        path.append(state)
        state = parents[state]
    return path[::-1]


def _encode(stacks: Stacks, symbols: Mapping[str, str]) -> State:
    return tuple("".join(symbols.get(name, ANY) for name in stack) for stack in stacks)
