# SPDX-License-Identifier: Apache-2.0
"""Shortest plans without the moves that the arm was found unable to make (3.4).

The verdicts of the motion problem's bounds come back as exclusions; what is left is searched by A*
with the bound of :mod:`a_star`, which stays a lower bound where moves are missing. So a plan that
is found is shortest among those that are possible as far as anybody knows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from scene_graph import Move, Stacks, apply_move, base_name, format_stacks

from ..errors import ImpossibleError, UnreachableError
from ..goals.goal import Goal
from ..validator import validate_plan
from .a_star import Successors, a_star
from .limits import DEFAULT_MAX_EXPANSIONS, Limits
from .plan import SearchResult
from .state import Problem, State, successors


@dataclass(frozen=True)
class Exclusion:
    """A move that cannot be made.

    Attributes:
        block: that it takes.
        source, under: the stack it takes it from, and the blocks below it there; None: any.
        target, onto: the stack it puts it on, and the blocks there before; None: any.
        state: the only arrangement that it is excluded in; None: any.
        reason: why, in words.
    """

    block: str
    source: int | None = None
    under: tuple[str, ...] = ()
    target: int | None = None
    onto: tuple[str, ...] = ()
    state: Stacks | None = None
    reason: str = ""

    def forbids(self, stacks: Stacks, move: Move) -> bool:
        """Whether it is this move in this arrangement."""
        source = stacks[move.source]
        if not source or source[-1] != self.block or self.state not in (None, stacks):
            return False
        if self.source is not None and (move.source, source[:-1]) != (self.source, self.under):
            return False
        return self.target is None or (move.target, stacks[move.target]) == (
            self.target,
            self.onto,
        )

    @property
    def names(self) -> frozenset[str]:
        """The blocks that it speaks of."""
        stacks = self.state or ()
        return frozenset([self.block, *self.under, *self.onto, *(n for s in stacks for n in s)])

    def __str__(self) -> str:
        """Such as "red_box cannot be put on stack2: clearance of hand to wall, 12 mm missing"."""
        words = [f"{self.block} cannot be"]
        if self.target is None:
            words.append(f"taken from {_on(self.source, self.under)}")
        elif self.source is None:
            words.append(f"put on {_on(self.target, self.onto)}")
        else:
            words.append(
                f"moved from {_on(self.source, self.under)} to {_on(self.target, self.onto)}"
            )
        where = f" in {format_stacks(self.state)}" if self.state else ""
        return f"{' '.join(words)}{where}: {self.reason}"


def _on(stack: int | None, blocks: Sequence[str]) -> str:
    base = base_name(stack or 0)
    return f"{blocks[-1]} on {base}" if blocks else base


def plan_avoiding(
    initial: Stacks,
    goal: Goal,
    exclusions: Sequence[Exclusion],
    max_expansions: int = DEFAULT_MAX_EXPANSIONS,
    cancelled: Callable[[], bool] = lambda: False,
) -> SearchResult:
    """A shortest plan without excluded moves; validated.

    Raises:
        ImpossibleError: proven: there is none.
        SearchLimitError, SearchCancelledError: see :func:`planner_node.search.search`.
    """
    limits = Limits(initial, goal, max_expansions, cancelled)
    problem = _Named(initial, goal, frozenset().union(*[item.names for item in exclusions]))
    try:
        path = a_star(problem, limits, _possible(problem, exclusions))
    except UnreachableError as error:
        listed = tuple(dict.fromkeys(str(item) for item in exclusions))
        raise ImpossibleError(
            f"impossible: no sequence of moves that the arm can make leads from "
            f"{format_stacks(initial)} to '{goal}'; excluded: {'; '.join(listed)}",
            limits.expanded,
            limits.seconds(),
            listed,
        ) from error
    moves = tuple(_move_between(before, after) for before, after in pairwise(path))
    states = [initial]
    for move in moves:
        states.append(apply_move(states[-1], move))
    validate_plan(initial, goal, moves, states)
    return SearchResult(moves, tuple(states), limits.expanded, limits.seconds())


class _Named(Problem):
    """A problem in which the blocks of exclusions have symbols of their own."""

    def __init__(self, initial: Stacks, goal: Goal, names: frozenset[str]) -> None:
        super().__init__(initial, goal)
        known = sorted({name for stack in initial for name in stack} & (goal.names | names))
        self.symbols = {name: chr(0x100 + index) for index, name in enumerate(known)}
        self.start = self.encoded(initial)

    def encoded(self, stacks: Sequence[Sequence[str]]) -> State:
        """Stacks of names as a state."""
        return tuple("".join(self.symbols.get(n, "*") for n in stack) for stack in stacks)


def _possible(problem: _Named, exclusions: Sequence[Exclusion]) -> Successors:
    """The states after moves that are not excluded."""
    names = {symbol: name for name, symbol in problem.symbols.items()}

    def possible(state: State) -> Iterator[tuple[State, str]]:
        stacks = tuple(tuple(names.get(symbol, symbol) for symbol in stack) for stack in state)
        for after, symbol in successors(state):
            move = _move_between(state, after)
            if not any(item.forbids(stacks, move) for item in exclusions):
                yield after, symbol

    return possible


def _move_between(before: State, after: State) -> Move:
    changes = [len(new) - len(old) for old, new in zip(before, after)]
    return Move(changes.index(-1), changes.index(1))
