# SPDX-License-Identifier: Apache-2.0
"""Blocks of mixed shapes and widths, and plans for them by brute force (Dijkstra over all states).

Nothing here is shared with the planner but the words of its answers.
"""

from __future__ import annotations

import heapq
import itertools
import random
from collections.abc import Callable, Mapping

from planner_states import State, neighbours, random_state

from planner_node.goals import Goal
from planner_node.search.stability import Figure, Stability
from scene_graph import Relation, up_relations

#: Such that some are more than 1.5 times as wide as others, and none just so.
WIDTHS = (0.03, 0.04, 0.05, 0.06)
COLORS = ("red", "green", "blue", "yellow", "purple", "orange", "cyan")
MAX_RATIO = 1.45


def random_blocks(count: int, rng: random.Random, unstable: int) -> dict[str, Figure]:
    """``unstable`` of them spheres or prisms."""
    figures = {}
    for index, color in enumerate(rng.sample(COLORS, count)):
        shapes = ("sphere", "prism") if index < unstable else ("box", "cylinder")
        shape, width = rng.choice(shapes), rng.choice(WIDTHS)
        figures[f"{color}_{shape}"] = Figure(shape, width, width)
    return figures


def standing_state(figures: Mapping[str, Figure], places: int, rng: random.Random) -> State:
    """One in which nothing has to fall."""
    while True:
        state = random_state(tuple(figures), places, rng)
        pairs = [pair for stack in state for pair in zip(stack[1:], stack)]
        if not any(price(figures, *pair) is None for pair in pairs):
            return state


def random_problem(
    seed: int, blocks: tuple[int, int] = (3, 5), places: int = 3
) -> tuple[dict[str, Figure], State, Goal]:
    """A start where all stands, and a goal that may ask for what does not."""
    rng = random.Random(seed)
    count = rng.randint(*blocks)
    figures = random_blocks(count, rng, rng.randint(1, 2))
    initial = standing_state(figures, places, rng)
    wanted = (
        standing_state(figures, places, rng)
        if rng.random() < 0.8
        else random_state(tuple(figures), places, rng)
    )
    relations = sorted(up_relations(wanted))
    chosen = relations if rng.random() < 0.5 else rng.sample(relations, rng.randint(1, count))
    return figures, initial, Goal(tuple(sorted(chosen)))


def price(figures: Mapping[str, Figure], block: str, support: str) -> int | None:
    """None: it falls; 1: it is unstable; 0: it stands."""
    upper, lower = figures[block], figures[support]
    if lower.shape in ("sphere", "prism"):
        return None
    return int(upper.shape != "sphere" and upper.long > MAX_RATIO * lower.long)


def placement(before: State, after: State) -> tuple[str, str | None]:
    """What was moved onto what; None: the table."""
    for old, new in zip(before, after):
        if len(new) > len(old):
            return new[-1], new[-2] if len(new) > 1 else None
    raise AssertionError("nothing was put down")


def best(
    figures: Mapping[str, Figure],
    initial: State,
    goal: Goal,
    require: bool = False,
    allowed: Callable[[State, State], bool] = lambda _before, _after: True,
) -> tuple[int, int] | None:
    """Fewest unstable placements, then fewest moves; None: no plan without a fall.

    Args:
        allowed: whether the arm can make the move between two states.
    """
    queue: list[tuple[int, int, State]] = [(0, 0, initial)]
    done: set[State] = set()
    while queue:
        unstable, moves, state = heapq.heappop(queue)
        if state in done:
            continue
        done.add(state)
        if all(holds(state, relation) for relation in goal.relations):
            return unstable, moves
        for after in neighbours(state):
            block, support = placement(state, after)
            cost = 0 if support is None else price(figures, block, support)
            if cost is not None and not (require and cost) and allowed(state, after):
                heapq.heappush(queue, (unstable + cost, moves + 1, after))
    return None


def holds(state: State, relation: Relation) -> bool:
    """The meaning of an up-relation."""
    columns = [(f"stack{index}", *stack) for index, stack in enumerate(state)]
    return any(
        (relation.object, relation.subject) == pair
        for column in columns
        for pair in itertools.pairwise(column)
    )


def rules(figures: Mapping[str, Figure], require: bool = False) -> Stability:
    """What the planner is told."""
    return Stability(figures, require, MAX_RATIO)
