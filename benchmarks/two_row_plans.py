# SPDX-License-Identifier: Apache-2.0
"""Plans among two rows of places beside brute force: four objects on six places (5.4.3).

In half of the tasks a tower hides what stands behind it, and the planner is told only what is
seen. What it does first, and after that with all that is seen then, is compared with the fewest
moves that there are, which are found by trying all of them. What hides what, and what a goal says,
is written down here once more.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from results_file import Row
from tqdm import tqdm

from planner_node import Goal, Scene, make_plan, parse_goal, resolve_goal
from planner_node.loop import uncover_in
from planner_node.settings import Settings
from scene_graph import (
    HIDDEN,
    ONE_ROW,
    Place,
    Rows,
    SceneGraph,
    SceneObject,
    Stacks,
    front_relations,
    hidden_name,
    in_rows,
    rows_of,
    up_relations,
)

FIRST_SEED: Final = 1000
NAMES: Final = ("red_box", "blue_box", "green_box", "yellow_box")
EDGE: Final = 0.045
#: From so many blocks on a tower of the front row hides what is behind it.
HIDES: Final = 3
POSITIONS: Final = tuple((x, y, 0.0) for x in (0.58, 0.42) for y in (-0.15, 0.0, 0.15))
CAMERA: Final = (1.45, 0.0, 0.85)


@dataclass(frozen=True)
class RowTask:
    """Where the blocks are, and what is wanted: a text, and a test that needs no planner."""

    initial: Stacks
    text: str
    holds: Callable[[Stacks], bool]


def places() -> tuple[Place, ...]:
    """Two rows of three; a tower up to ``HIDES`` blocks high hides nothing."""
    bare = in_rows(POSITIONS, CAMERA)
    clear = (HIDES - 0.5) * EDGE
    return tuple(
        replace(
            near,
            clear=tuple(clear if far.index == near.index + 3 else math.inf for far in bare),
        )
        for near in bare
    )


def random_task(seed: int) -> RowTask:
    """A random state, in every second one of which a tower hides a place, and a random goal."""
    rng = random.Random(seed)
    while True:
        initial, wanted = _state(rng), _state(rng)
        if bool(hidden_in(initial)) == bool(seed % 2):
            break
    at = {name: (i, level) for i, stack in enumerate(wanted) for level, name in enumerate(stack)}
    parts: list[tuple[str, Callable[[Stacks], bool]]] = []
    for one, (stack, level) in at.items():
        below = wanted[stack][level - 1] if level else f"stack{stack}"
        parts.append((f"{one} on {below}", _stands(one, below)))
        for other, (there, _) in at.items():
            if stack < 3 <= there:
                parts.append((f"{one} in front of {other}", _in_front(one, other)))
                parts.append((f"{other} behind {one}", _in_front(one, other)))
            if stack % 3 < there % 3:
                parts.append((f"{one} left of {other}", _left(one, other)))
    if rng.random() < 0.5:
        chosen = [part for part in parts if " on " in part[0]]
    else:
        chosen = rng.sample(parts, rng.randint(1, 4))
    return RowTask(
        initial,
        ", ".join(text for text, _ in chosen),
        lambda state: all(holds(state) for _, holds in chosen),
    )


def _state(rng: random.Random) -> Stacks:
    stacks: list[list[str]] = [[] for _ in POSITIONS]
    for name in rng.sample(NAMES, len(NAMES)):
        rng.choice(stacks).append(name)
    return tuple(map(tuple, stacks))


def _stands(one: str, below: str) -> Callable[[Stacks], bool]:
    def holds(state: Stacks) -> bool:
        columns = [(f"stack{index}", *stack) for index, stack in enumerate(state)]
        return any((below, one) in pairwise(column) for column in columns)

    return holds


def _in_front(one: str, other: str) -> Callable[[Stacks], bool]:
    return lambda state: _index(state, one) < 3 <= _index(state, other)


def _left(one: str, other: str) -> Callable[[Stacks], bool]:
    return lambda state: _index(state, one) % 3 < _index(state, other) % 3


def _index(state: Stacks, name: str) -> int:
    return next(index for index, stack in enumerate(state) if name in stack)


def hidden_in(state: Stacks) -> list[int]:
    """The places that towers hide."""
    return [index + 3 for index in range(3) if len(state[index]) >= HIDES]


def fewest(initial: Stacks, holds: Callable[[Stacks], bool], fixed: list[int]) -> int:
    """By brute force; ``fixed``: the places that nothing is taken from or put on."""
    layer, seen, depth = [initial], {initial}, 0
    while not any(map(holds, layer)):
        following = [new for state in layer for new in _neighbours(state, fixed) if new not in seen]
        layer = list(dict.fromkeys(following))
        seen.update(layer)
        depth += 1
    return depth


def _neighbours(state: Stacks, fixed: list[int]) -> Iterator[Stacks]:
    for source, target in ((p, q) for p in range(6) for q in range(6) if p != q):
        if state[source] and source not in fixed and target not in fixed:
            after = [list(stack) for stack in state]
            after[target].append(after[source].pop())
            yield tuple(map(tuple, after))


def scene_of(state: Stacks) -> Scene:
    """What perception says of a state."""
    hidden = hidden_in(state)
    shown = tuple(
        (hidden_name(index),) if index in hidden else stack for index, stack in enumerate(state)
    )
    objects = []
    for index, stack in enumerate(shown):
        x, y, _ = POSITIONS[index]
        for level, name in enumerate(stack):
            color = HIDDEN if index in hidden else name.partition("_")[0]
            centre = (x, y, (level + 0.5) * EDGE)
            objects.append(SceneObject(name, color, "box", centre, size=(EDGE,) * 3))
    relations = up_relations(shown) | front_relations(shown, rows_of(places()))
    return Scene(SceneGraph(tuple(objects), relations, places()), shown)


@dataclass(frozen=True)
class RowAnswer:
    """What the planner made of a task.

    Attributes:
        looks, least_looks: moves to see what is hidden, and the fewest that there are.
        moves, least_moves: the same, of the plan from what is seen then.
        right: whether all is seen after the first moves, and the goal holds in the end.
        seconds: of all planning.
    """

    looks: int
    least_looks: int
    moves: int
    least_moves: int
    right: bool
    seconds: float


def answer(task: RowTask) -> RowAnswer:
    """Plans as the closed loop does, and by brute force."""
    state, fixed = task.initial, hidden_in(task.initial)
    looks = least_looks = 0
    start = time.perf_counter()
    if fixed:
        found = uncover_in(scene_of(state), None, Settings(), lambda: False)
        looks = len(found.moves)
        for move in found.moves:
            after = [list(stack) for stack in state]
            after[move.target].append(after[move.source].pop())
            state = tuple(map(tuple, after))
    seen = not set(fixed) & set(hidden_in(state))
    goal: Goal = resolve_goal(parse_goal(task.text), NAMES, 6).on(rows_of(places()))
    plan = make_plan(state, goal)
    seconds = time.perf_counter() - start
    if fixed:
        least_looks = fewest(
            task.initial, lambda other: not set(fixed) & set(hidden_in(other)), fixed
        )
    return RowAnswer(
        looks,
        least_looks,
        len(plan.moves),
        fewest(state, task.holds, []),
        seen and task.holds(plan.states[-1]),
        seconds,
    )


def two_row_rows(count: int) -> list[Row]:
    """Optimal plans of so many tasks."""
    assert rows_of(places()) == Rows((0, 0, 0, 1, 1, 1), (0, 1, 2, 0, 1, 2)) != ONE_ROW
    answers = [answer(random_task(FIRST_SEED + index)) for index in tqdm(range(count), desc="rows")]
    name = "two rows: 4 objects on 6 places"
    optimal = sum(
        item.right and item.looks == item.least_looks and item.moves == item.least_moves
        for item in answers
    )
    covered = [item for item in answers if item.least_looks]
    few = sum(item.looks == item.least_looks for item in covered)
    seconds = [item.seconds for item in answers]
    return [
        Row(name, "as short as brute force's", optimal, "", count, required=f"== {count}"),
        Row(name, "what is hidden uncovered with the fewest moves", few, "", len(covered),
            required=f"== {len(covered)}"),
        Row(name, "time, worst", max(seconds), "s", count, (min(seconds), max(seconds))),
    ]  # fmt: skip
