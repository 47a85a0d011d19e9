# SPDX-License-Identifier: Apache-2.0
"""The oracular action model M on scene graphs with bases (A.2.3): z̃₁ = M(z₀, (p, q)).

Its form on stacks is :func:`scene_graph.apply_move`.
"""

from __future__ import annotations

from collections.abc import Callable

from scene_graph import UP, ImpossibleMoveError, Move, Relation, base_index, base_name

#: The relations after a move, from those before it; raises ImpossibleMoveError.
GraphModel = Callable[[frozenset[Relation], Move], frozenset[Relation]]


def apply_to_graph(relations: frozenset[Relation], move: Move) -> frozenset[Relation]:
    """The relations after a move, in the five steps of A.2.3.

    Raises:
        ImpossibleMoveError: if the source is empty or is the target.
    """
    source, target = move.source, move.target
    if source == target:
        raise ImpossibleMoveError(f"move {move} ends where it starts", source, target)
    moved = _top(relations, source)  # (1)
    below = _top(relations, target)  # (2)
    if base_index(moved) is not None:
        raise ImpossibleMoveError(f"move {move} takes from an empty stack", source, target)
    kept = {item for item in relations if moved not in (item.subject, item.object)}  # (3)
    return frozenset(kept | {Relation(moved, UP, below)})  # (4), (5)


def _top(relations: frozenset[Relation], stack: int) -> str:
    """The top object of a stack, or its base if it is empty."""
    on = {item.object: item.subject for item in relations if item.predicate == UP}
    top = base_name(stack)
    while top in on:
        top = on[top]
    return top
