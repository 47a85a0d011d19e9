# SPDX-License-Identifier: Apache-2.0
"""Breadth-first search (Algorithm A.1) for a shortest sequence of moves to a goal (5.2.2).

Two things make it fast without giving up the shortest plan. Blocks that the goal does not mention
are interchangeable: under one symbol for all of them, 7 blocks have 1,512 states in place of
181,440 for a goal that names two. A complete goal is one state, and since every move can be undone,
the search runs from both ends.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from scene_graph import Move, Stacks, apply_move, base_index, format_stacks

from .errors import SearchCancelledError, SearchLimitError, UnreachableError
from .goals import LEFT_OF, ON, Goal, GoalRelation

DEFAULT_MAX_EXPANSIONS: Final = 1_000_000
#: Expansions between two looks at ``cancelled``; a few milliseconds.
POLL_INTERVAL: Final = 2000

#: A state of the search: a string a stack, one character an object, from the bottom.
_State = tuple[str, ...]
_Parents = dict[_State, "_State | None"]
_Test = Callable[[_State], bool]
#: Stands for every block that the goal does not mention.
_ANY: Final = "*"
_SEPARATOR: Final = "|"
#: Letters beyond ASCII, so that no symbol is one of the two above.
_FIRST_SYMBOL: Final = 0x100


@dataclass(frozen=True)
class SearchResult:
    """A shortest plan.

    Attributes:
        moves: empty if the goal already holds.
        states: the initial state and the one after each move.
        expanded: number of states whose successors were generated.
        seconds: wall time.
    """

    moves: tuple[Move, ...]
    states: tuple[Stacks, ...]
    expanded: int
    seconds: float


def search(
    initial: Stacks,
    goal: Goal,
    max_expansions: int = DEFAULT_MAX_EXPANSIONS,
    cancelled: Callable[[], bool] = lambda: False,
) -> SearchResult:
    """A shortest plan from a state to a goal.

    Args:
        cancelled: polled every few milliseconds.

    Raises:
        UnreachableError: every reachable state was searched; none fulfils the goal.
        SearchLimitError: ``max_expansions`` states were expanded before that.
        SearchCancelledError: ``cancelled`` returned True.
    """
    names = [name for stack in initial for name in stack]
    progress = _Progress(initial, goal, max_expansions, cancelled)
    mentioned = sorted(goal.names & set(names))
    symbols = {name: chr(_FIRST_SYMBOL + index) for index, name in enumerate(mentioned)}
    start = _encode(initial, symbols)
    target = goal.state(names, len(initial))
    if goal.holds(initial):
        path = [start]
    elif target is not None:
        path = _from_both_ends(start, _encode(target, symbols), progress)
    else:
        path = _from_the_start(start, _tests(goal, symbols, len(initial)), progress)
    moves = tuple(_move_between(before, after) for before, after in pairwise(path))
    states = [initial]
    for move in moves:
        states.append(apply_move(states[-1], move))
    return SearchResult(moves, tuple(states), progress.expanded, progress.seconds())


class _Progress:
    """Counts expansions and stops the search."""

    def __init__(
        self, initial: Stacks, goal: Goal, max_expansions: int, cancelled: Callable[[], bool]
    ) -> None:
        self.expanded = 0
        self._initial = initial
        self._goal = goal
        self._max_expansions = max_expansions
        self._cancelled = cancelled
        self._started = time.perf_counter()

    def seconds(self) -> float:
        return time.perf_counter() - self._started

    def count_expansion(self) -> None:
        if self.expanded >= self._max_expansions:
            raise SearchLimitError(
                f"'{self._goal}' was not reached within {self._max_expansions} expanded states; "
                "raise max_expansions, or ask for less",
                self.expanded,
                self.seconds(),
            )
        if self.expanded % POLL_INTERVAL == 0 and self._cancelled():
            raise SearchCancelledError(
                f"the search was cancelled after {self.expanded} states",
                self.expanded,
                self.seconds(),
            )
        self.expanded += 1

    def unreachable(self) -> UnreachableError:
        return UnreachableError(
            f"no sequence of moves leads from {format_stacks(self._initial)} to '{self._goal}': "
            f"all reachable states were searched ({self.expanded} expanded)",
            self.expanded,
            self.seconds(),
        )


def _from_the_start(start: _State, tests: list[_Test], progress: _Progress) -> list[_State]:
    """Algorithm A.1 with the goal tested when a state is found, not when it is expanded."""
    parents: _Parents = {start: None}
    layer = [start]
    while layer:
        found: list[_State] = []
        for state in layer:
            progress.count_expansion()
            for successor in _successors(state):
                if successor in parents:
                    continue
                parents[successor] = state
                found.append(successor)
                for test in tests:
                    if not test(successor):
                        break
                else:
                    return _path(parents, successor)
        layer = found
    raise progress.unreachable()


def _from_both_ends(start: _State, target: _State, progress: _Progress) -> list[_State]:
    """Whole layers in turns from both ends; the first state that both know is on a shortest path.

    Once the layers up to depths d and e are complete and disjoint, no path is shorter than
    d + e + 1, and a state that the next layer shares with the other side gives exactly that.
    """
    near: _Parents = {start: None}
    far: _Parents = {target: None}
    near_layer, far_layer = [start], [target]
    while near_layer and far_layer:
        forward = len(near_layer) <= len(far_layer)
        ours, theirs, layer = (near, far, near_layer) if forward else (far, near, far_layer)
        found: list[_State] = []
        for state in layer:
            progress.count_expansion()
            for successor in _successors(state):
                if successor in ours:
                    continue
                ours[successor] = state
                found.append(successor)
                if successor in theirs:
                    return _path(near, successor) + _path(far, successor)[-2::-1]
        if forward:
            near_layer = found
        else:
            far_layer = found
    raise progress.unreachable()


def _successors(state: _State) -> Iterator[_State]:
    for source, stack in enumerate(state):
        if not stack:
            continue
        top = stack[-1]
        lowered = (*state[:source], stack[:-1], *state[source + 1 :])
        for target, other in enumerate(state):
            if target != source:
                yield (*lowered[:target], other + top, *lowered[target + 1 :])


def _path(parents: _Parents, end: _State) -> list[_State]:
    """From the root to ``end``."""
    path = []
    state: _State | None = end
    while state is not None:
        path.append(state)
        state = parents[state]
    return path[::-1]


def _move_between(before: _State, after: _State) -> Move:
    changes = [len(new) - len(old) for old, new in zip(before, after)]
    return Move(changes.index(-1), changes.index(1))


def _encode(stacks: Stacks, symbols: Mapping[str, str]) -> _State:
    return tuple("".join(symbols.get(name, _ANY) for name in stack) for stack in stacks)


def _tests(goal: Goal, symbols: Mapping[str, str], stack_count: int) -> list[_Test]:
    """One test a relation on encoded states, the strictest first."""
    order = sorted(goal.relations, key=lambda item: item.predicate != ON)
    return [_test(item, symbols, stack_count) for item in order]


def _test(relation: GoalRelation, symbols: Mapping[str, str], stack_count: int) -> _Test:
    on = relation.predicate == ON
    subject = symbols.get(relation.subject, "")
    object_ = symbols.get(relation.object, "")
    base = base_index(relation.object)
    if base is not None and subject and base < stack_count:
        if on:
            return lambda state: state[base][:1] == subject
        return lambda state: subject in state[base]
    if not subject or not object_:
        return lambda _state: False
    if on:
        # The separator keeps the top of one stack apart from the bottom of the next.
        return lambda state: object_ + subject in _SEPARATOR.join(state)
    if relation.predicate == LEFT_OF:
        return lambda state: _is_left(state, subject, object_)
    return lambda state: _is_above(state, subject, object_)


def _is_left(state: _State, subject: str, object_: str) -> bool:
    for stack in state:
        if object_ in stack:
            return False
        if subject in stack:
            return True
    return False


def _is_above(state: _State, subject: str, object_: str) -> bool:
    for stack in state:
        if object_ in stack:
            return subject in stack[stack.index(object_) + 1 :]
    return False
