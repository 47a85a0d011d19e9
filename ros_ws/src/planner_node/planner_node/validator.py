# SPDX-License-Identifier: Apache-2.0
"""An independent check of plans: every move is carried out with plain lists, then the goal is read.

It shares nothing with the search, so that a defect there cannot hide itself. It stands between the
search and everything that is published.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from scene_graph import (
    ABOVE,
    FRONT,
    LEFT,
    NOT,
    PREDICATES,
    PRISM,
    SPHERE,
    UP,
    Move,
    Relation,
    Rows,
    base_index,
)

from .errors import PlannerError
from .goals.goal import Goal

if TYPE_CHECKING:
    from .search.stability import Figure, Stability, Unstable


class InvalidPlanError(PlannerError):
    """A plan is not one: ``step`` is the move that fails, from 0, or the number of all moves."""

    def __init__(self, problem: str, step: int) -> None:
        super().__init__(problem)
        self.step = step


def validate_plan(
    initial: Sequence[Sequence[str]],
    goal: Goal,
    moves: Sequence[Move],
    states: Sequence[Sequence[Sequence[str]]] | None = None,
) -> None:
    """Raises InvalidPlanError unless the moves lead from a state to one that fulfils the goal.

    Args:
        states: those that the plan says it goes through, the initial one first; None: it does not.
    """
    stacks = [list(stack) for stack in initial]
    if states is not None and len(states) != len(moves) + 1:
        raise InvalidPlanError(
            f"a plan of {len(moves)} moves comes with {len(states)} states", len(moves)
        )
    _compare(stacks, states, 0)
    for step, move in enumerate(moves):
        known = range(len(stacks))
        if move.source not in known or move.target not in known:
            raise InvalidPlanError(f"move {step + 1}, {move}, names no place of the table", step)
        if move.source == move.target:
            raise InvalidPlanError(f"move {step + 1}, {move}, ends where it starts", step)
        if not stacks[move.source]:
            raise InvalidPlanError(f"move {step + 1}, {move}, takes from an empty place", step)
        stacks[move.target].append(stacks[move.source].pop())
        _compare(stacks, states, step + 1)
    for relation in goal.relations:
        if not _holds(relation, stacks, goal.rows):
            raise InvalidPlanError(
                f"after the last move '{relation.words}' is not true", len(moves)
            )
    for count in goal.counts:
        true = [relation for relation in count.relations if _holds(relation, stacks, goal.rows)]
        if not count.least <= len(true) <= count.most:
            raise InvalidPlanError(f"after the last move '{count}' is not true", len(moves))


def validate_stability(
    initial: Sequence[Sequence[str]],
    moves: Sequence[Move],
    stability: Stability,
    told: Iterable[Unstable],
) -> None:
    """Raises InvalidPlanError where a plan puts a block where it may not, or does not tell of it.

    Args:
        moves: of a plan that :func:`validate_plan` found right.
        told: what the plan says that it puts where it is unstable.
    """
    left = {(item.step, item.block, item.support) for item in told}
    stacks = [list(stack) for stack in initial]
    for step, move in enumerate(moves):
        block = stacks[move.source].pop()
        support = stacks[move.target][-1] if stacks[move.target] else ""
        stacks[move.target].append(block)
        upper, lower = stability.figures.get(block), stability.figures.get(support)
        falls = lower is not None and lower.shape in (SPHERE, PRISM)
        if not falls and not _too_wide(upper, lower, stability.max_width_ratio):
            continue
        if falls or stability.require or (step, block, support) not in left:
            raise InvalidPlanError(
                f"move {step + 1}, {move}, puts {block} on {support}, where it is unstable", step
            )
        left.remove((step, block, support))
    if left:
        raise InvalidPlanError(f"the plan is said to put {min(left)} where it does not", len(moves))


def _too_wide(upper: Figure | None, lower: Figure | None, ratio: float) -> bool:
    if upper is None or lower is None or upper.shape == SPHERE:
        return False
    if 0.0 in (lower.long, lower.short):
        return False
    return upper.long > ratio * lower.long or upper.short > ratio * lower.short


def _compare(
    stacks: list[list[str]], states: Sequence[Sequence[Sequence[str]]] | None, step: int
) -> None:
    if states is not None and [list(stack) for stack in states[step]] != stacks:
        raise InvalidPlanError(
            f"the state after {step} moves is not the one that they lead to", step
        )


def _holds(relation: Relation, stacks: list[list[str]], rows: Rows) -> bool:
    subject, object_ = (_spot(name, stacks) for name in (relation.subject, relation.object))
    if subject is None or object_ is None:
        return False
    if relation.predicate.startswith(NOT):
        positive = relation.predicate.removeprefix(NOT)
        return not _holds(Relation(relation.subject, positive, relation.object), stacks, rows)
    if relation.predicate == UP:
        return subject == (object_[0], object_[1] + 1)
    if relation.predicate == ABOVE:
        return subject[0] == object_[0] and subject[1] > object_[1]
    several = bool(rows.rows)
    if relation.predicate == LEFT:
        columns = rows.columns if several else range(len(stacks))
        return columns[subject[0]] < columns[object_[0]]
    if relation.predicate == FRONT:
        return several and rows.rows[subject[0]] < rows.rows[object_[0]]
    return PREDICATES[relation.predicate].holds(rows.spot(*subject), rows.spot(*object_))


def _spot(name: str, stacks: list[list[str]]) -> tuple[int, int] | None:
    place = base_index(name)
    if place is not None:
        return (place, -1) if place < len(stacks) else None
    for index, stack in enumerate(stacks):
        if name in stack:
            return index, stack.index(name)
    return None
