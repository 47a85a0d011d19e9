# SPDX-License-Identifier: Apache-2.0
"""Stacks: the complete symbolic state, equivalent to up-relations with bases (A.2.2)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable

from .errors import ImpossibleMoveError, InconsistentRelationsError
from .moves import Move
from .places import base_index, base_name
from .predicates import LEFT, UP, Spot
from .relations import Relation

#: A state: for each of the m stacks from the left, the names of its objects from the bottom.
Stacks = tuple[tuple[str, ...], ...]


def spots_of(stacks: Stacks, spot: Callable[[int, int], Spot] = Spot) -> dict[str, Spot]:
    """Where every block and every base is; see :class:`Spot`.

    Args:
        spot: makes one of stack and level, see :meth:`.rows.Rows.spot`; as in one row by default.
    """
    spots = {base_name(index): spot(index, -1) for index in range(len(stacks))}
    for index, stack in enumerate(stacks):
        for level, name in enumerate(stack):
            spots[name] = spot(index, level)
    return spots


def up_relations(stacks: Stacks) -> frozenset[Relation]:
    """The scene graph of a state with bases: every object stands on an object or a base (A.2.2)."""
    relations = set()
    for index, stack in enumerate(stacks):
        below = base_name(index)
        for name in stack:
            relations.add(Relation(name, UP, below))
            below = name
    return frozenset(relations)


def left_relations(stacks: Stacks) -> frozenset[Relation]:
    """Left-relations between the bottom objects of neighbouring non-empty stacks (5.2.1)."""
    bottoms = [stack[0] for stack in stacks if stack]
    return frozenset(Relation(a, LEFT, b) for a, b in itertools.pairwise(bottoms))


def stacks_from_relations(relations: Iterable[Relation], stack_count: int) -> Stacks:
    """The state that up-relations with bases describe; other predicates are ignored.

    Raises:
        InconsistentRelationsError: if an object stands on two things or carries two objects, if a
            base is not one of ``stack_count``, or if some objects reach no base.
    """
    above: dict[str, str] = {}
    names: set[str] = set()
    for relation in sorted(set(relations)):
        if relation.predicate != UP:
            continue
        if relation.object in above:
            pair = (above[relation.object], relation.subject)
            raise InconsistentRelationsError(
                f"{pair[0]} and {pair[1]} both stand on {relation.object}", pair
            )
        if relation.subject in names:
            raise InconsistentRelationsError(
                f"{relation.subject} stands on two things", (relation.subject,)
            )
        index = base_index(relation.object)
        if index is not None and index >= stack_count:
            raise InconsistentRelationsError(
                f"{relation.object} does not exist; there are {stack_count} stacks", ()
            )
        above[relation.object] = relation.subject
        names.add(relation.subject)
    stacks = []
    for index in range(stack_count):
        stack: list[str] = []
        below = base_name(index)
        while below in above:
            below = above[below]
            stack.append(below)
        stacks.append(tuple(stack))
    floating = names - {name for stack in stacks for name in stack}
    if floating:
        listed = tuple(sorted(floating))
        raise InconsistentRelationsError(f"{', '.join(listed)} do not stand on any base", listed)
    return tuple(stacks)


def apply_move(stacks: Stacks, move: Move) -> Stacks:
    """The oracular action model on a state: M(z, (p, q)) of A.2.3.

    Raises:
        ImpossibleMoveError: if a stack does not exist, the source is empty or equals the target.
    """
    source, target = move.source, move.target
    if not (0 <= source < len(stacks) and 0 <= target < len(stacks)):
        raise ImpossibleMoveError(
            f"move {move} names a stack that is not among stack0 to stack{len(stacks) - 1}",
            source,
            target,
        )
    if source == target:
        raise ImpossibleMoveError(f"move {move} ends where it starts", source, target)
    if not stacks[source]:
        raise ImpossibleMoveError(f"move {move} takes from an empty stack", source, target)
    moved = list(stacks)
    moved[target] = (*stacks[target], stacks[source][-1])
    moved[source] = stacks[source][:-1]
    return tuple(moved)


def format_stacks(stacks: Stacks) -> str:
    """One line for people: ``[red_box blue_box | - | green_box]``, from the left and the bottom."""
    return "[" + " | ".join(" ".join(stack) or "-" for stack in stacks) + "]"
