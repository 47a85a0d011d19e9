# SPDX-License-Identifier: Apache-2.0
"""Scenes and plans to move in, drawn at random."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scene_graph import (
    BOX,
    COLORS,
    Move,
    Place,
    SceneGraph,
    SceneObject,
    all_moves,
    apply_move,
    object_name,
    up_relations,
)

BASES = ((0.5, -0.15), (0.5, 0.0), (0.5, 0.15))
EDGE = 0.045


def scene(
    heights: Sequence[int],
    rng: np.random.Generator | None = None,
    *,
    yaw: float = 0.1,
    offset: float = 0.004,
    edge: float = EDGE,
    places: Sequence[tuple[float, float]] = BASES,
) -> SceneGraph:
    """Towers of boxes of the given heights; with ``rng`` a little turned and off their places."""
    names = iter([object_name(color, BOX) for color in COLORS])
    objects, stacks = [], []
    for count, (x, y) in zip(heights, places):
        stack = []
        for level in range(count):
            name = next(names)
            angle, dx, dy = 0.0, 0.0, 0.0
            if rng is not None:
                angle = rng.uniform(-yaw, yaw)
                dx, dy = rng.uniform(-offset, offset, 2)
            objects.append(
                SceneObject(
                    name,
                    name.split("_")[0],
                    BOX,
                    (x + dx, y + dy, (level + 0.5) * edge),
                    (0.0, 0.0, float(np.sin(angle / 2)), float(np.cos(angle / 2))),
                    (edge, edge, edge),
                )
            )
            stack.append(name)
        stacks.append(tuple(stack))
    return SceneGraph(
        tuple(objects),
        up_relations(tuple(stacks)),
        tuple(Place(index, (x, y, 0.0)) for index, (x, y) in enumerate(places)),
    )


def random_heights(rng: np.random.Generator, blocks: int, stacks: int = 3) -> tuple[int, ...]:
    """Uniform over the ways to share blocks out to stacks."""
    bars = np.sort(rng.permutation(blocks + stacks - 1)[: stacks - 1])
    return tuple((np.diff([-1, *bars, blocks + stacks - 1]) - 1).tolist())


def random_moves(graph: SceneGraph, count: int, rng: np.random.Generator) -> list[Move]:
    """A random walk; it does not take the same block twice in a row where it can help it."""
    state, moves = graph.stacks(), list[Move]()
    while len(moves) < count:
        possible = [move for move in all_moves(len(state)) if state[move.source]]
        sensible = [m for m in possible if not moves or m.source != moves[-1].target] or possible
        moves.append(sensible[rng.integers(len(sensible))])
        state = apply_move(state, moves[-1])
    return moves
