# SPDX-License-Identifier: Apache-2.0
"""Shortest plans without moves that the arm cannot make (3.4) or after which a block falls (5.4.2).

The verdicts of the motion problem's bounds come back as exclusions; what may stand on what is known
beforehand. What is left is searched from both ends where that is enough, and else by A* with the
bound of :mod:`a_star`, which stays a lower bound where moves are missing or cost more. So a plan
that is found is shortest among those that are possible as far as anybody knows, and puts as little
as possible where it is unstable.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from scene_graph import UP, Move, Stacks, apply_move, base_name, format_stacks

from ..errors import ImpossibleError, UnreachableError
from ..goals.goal import Goal
from ..validator import validate_plan
from .a_star import Following, a_star, moves_left
from .both_ends import both_ends
from .conditions import Condition, Conditions
from .limits import DEFAULT_MAX_EXPANSIONS, Limits, PartTooLargeError
from .plan import SearchResult
from .stability import Stability
from .state import ANY, Problem, State

#: What a placement that is unstable costs: more than any number of moves.
_UNSTABLE: Final = 1 << 40
#: Expansions from both ends, a second or two, before A* is tried.
_FROM_BOTH_ENDS: Final = 400_000
#: The first of the symbols for blocks that only differ in what can stand on what.
_FIRST_KIND: Final = 0x2000


@dataclass(frozen=True)
class Exclusion:
    """A move that cannot be made.

    Attributes:
        block: that it takes.
        source, under: the stack it takes it from, and the blocks below it there; None: any.
        target, onto: the stack it puts it on, and the blocks there before; None: any.
        state: the only arrangement that it is excluded in; None: any.
        reason: why, in words.
        told: whether a sentence names it; else it goes without saying.
    """

    block: str
    source: int | None = None
    under: tuple[str, ...] = ()
    target: int | None = None
    onto: tuple[str, ...] = ()
    state: Stacks | None = None
    reason: str = ""
    told: bool = True

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
    stability: Stability | None = None,
) -> SearchResult:
    """A shortest plan without excluded moves; validated.

    Args:
        stability: nothing is put where it falls; of the plans that are left those with the fewest
            unstable placements are looked for, or those without where it requires so.

    Raises:
        ImpossibleError: proven: there is none, and some moves were excluded.
        UnreachableError: proven: there is none.
        SearchLimitError, SearchCancelledError: see :func:`planner_node.search.search`.
    """
    limits = Limits(initial, goal, max_expansions, cancelled)
    named = frozenset().union(*[item.names for item in exclusions])
    problem = _Named(initial, goal, named, stability)
    try:
        path = _cheapest(problem, exclusions, limits)
    except UnreachableError as error:
        listed = tuple(dict.fromkeys(str(item) for item in exclusions if item.told))
        if not listed:
            raise
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


def _cheapest(problem: _Named, exclusions: Sequence[Exclusion], limits: Limits) -> list[State]:
    """From both ends as long as nothing but unstable placements is left out, then by A*.

    Both ends find the shortest stable plan sooner, and prove sooner that there is none. What they
    cannot do is to count unstable placements.
    """
    unstable = {pair for pair, price in problem.prices.items() if price != 1}
    falling = {pair for pair, price in problem.prices.items() if not price}
    if unstable and problem.target is not None and not exclusions:
        part = limits.of_a_part(_FROM_BOTH_ENDS)
        try:
            try:
                return both_ends(problem, part, unstable)
            except UnreachableError:
                if falling == unstable:
                    raise
                both_ends(problem, part, falling)  # raises where there is no plan at all
        except PartTooLargeError:
            pass
    return a_star(problem, limits, _possible(problem, exclusions), _cost_left(problem))


class _Named(Problem):
    """A problem in which blocks have symbols of their own where it matters which is which.

    Attributes:
        names: a block for every symbol but ANY; several share one that differ in nothing that is
            asked.
        prices: of putting one symbol on another, both as one string, where it is not 1; 0: it
            cannot be put there.
    """

    def __init__(
        self, initial: Stacks, goal: Goal, names: frozenset[str], stability: Stability | None
    ) -> None:
        super().__init__(initial, goal)
        there = sorted(name for stack in initial for name in stack)
        known = [name for name in there if name in goal.names | names]
        self.symbols = {name: chr(0x100 + index) for index, name in enumerate(known)}
        prices = _prices(there, stability)
        self._symbol_of = {name: ANY for name in there} | _kinds(there, prices) | self.symbols
        self.names: dict[str, str] = {}
        for name, symbol in self._symbol_of.items():
            self.names.setdefault(symbol, name)
        self.prices = {
            self._symbol_of[block] + self._symbol_of[support]: price
            for (block, support), price in prices.items()
        }
        self.start = self.encoded(initial)

    def encoded(self, stacks: Sequence[Sequence[str]]) -> State:
        """Stacks of names as a state."""
        return tuple("".join(self._symbol_of[n] for n in stack) for stack in stacks)


def _prices(names: Sequence[str], stability: Stability | None) -> dict[tuple[str, str], int]:
    """What it costs to put a block on another, where it is not 1."""
    if stability is None:
        return {}
    prices = {}
    for block in names:
        for support in names:
            objection = stability.objection(block, support)
            if objection is not None:
                forbidden = objection.falls or stability.require
                prices[block, support] = 0 if forbidden else _UNSTABLE + 1
    return prices


def _kinds(names: Sequence[str], prices: Mapping[tuple[str, str], int]) -> dict[str, str]:
    """The same symbol for blocks on which, and which on others, can be put the same."""
    if not prices:
        return {}
    kinds: dict[tuple[object, ...], str] = {}
    symbols = {}
    for name in names:
        on = tuple(prices.get((name, other)) for other in names)
        under = tuple(prices.get((other, name)) for other in names)
        symbols[name] = kinds.setdefault((on, under), chr(_FIRST_KIND + len(kinds)))
    return symbols


def _possible(problem: _Named, exclusions: Sequence[Exclusion]) -> Following:
    """The states after moves that are not excluded, and what these cost."""
    names, prices = problem.names, problem.prices
    places = range(len(problem.start))

    def possible(state: State) -> Iterator[tuple[State, int]]:
        stacks = tuple(tuple(names[symbol] for symbol in stack) for stack in state)
        for source in places:
            if not state[source]:
                continue
            top, lowered = state[source][-1], list(state)
            lowered[source] = state[source][:-1]
            for target in places:
                price = prices.get(top + state[target][-1:], 1)
                if target == source or not price:
                    continue
                move = Move(source, target)
                if any(item.forbids(stacks, move) for item in exclusions):
                    continue
                after = lowered.copy()
                after[target] += top
                yield tuple(after), price

    return possible


def _cost_left(problem: _Named) -> Callable[[State], int]:
    """The moves that are left at least, and the unstable placements that the goal itself asks for.

    A move fulfils one relation of the goal between two blocks, directly on one another, at most:
    so no move lowers the bound by more than it costs.
    """
    moves = moves_left(problem)
    height = sum(map(len, problem.start))
    conditions = Conditions(problem.symbols, len(problem.start), height, problem.goal.rows)
    asked: list[Condition] = [
        conditions.of(relation)
        for relation in dict.fromkeys(problem.goal.relations)
        if relation.predicate == UP
        and problem.prices.get(
            problem.symbols.get(relation.subject, ANY) + problem.symbols.get(relation.object, ANY),
            1,
        )
        > 1
    ]
    if not asked:
        return moves
    return lambda state: moves(state) + _UNSTABLE * sum(not item.holds(state) for item in asked)


def _move_between(before: State, after: State) -> Move:
    changes = [len(new) - len(old) for old, new in zip(before, after)]
    return Move(changes.index(-1), changes.index(1))
