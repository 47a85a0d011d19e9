# SPDX-License-Identifier: Apache-2.0
"""Blocks of mixed shapes and sizes, random goals for them, and plans by brute force.

Nothing here is shared with the planner: what falls and what is unstable is written down once more,
and the best plan is found by Dijkstra's algorithm over all arrangements of the blocks.
"""

from __future__ import annotations

import heapq
import itertools
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from planner_node import Goal
from planner_node.goals import complete_goal
from scene_graph import COLORS, FLAT_TOPPED, PRISM, SPHERE, Stacks, object_name

#: Edges of the blocks, as in the simulator's scene ``mixed_sizes`` [m].
EDGES: Final = (0.03, 0.06)
#: Share of the goals that are relations of a state in which everything stands.
STANDING_GOALS: Final = 0.8
#: A block more than this many times as wide as what it stands on is unstable.
MAX_WIDTH_RATIO: Final = 1.5
#: Shapes that nothing stands on.
POINTED: Final = (SPHERE, PRISM)

#: Shape and edge [m] of every block.
Kinds = Mapping[str, tuple[str, float]]


@dataclass(frozen=True)
class StabilityTask:
    """Blocks, where they are, and what is wanted."""

    kinds: Kinds
    initial: Stacks
    goal: Goal


def random_task(seed: int, blocks: int) -> StabilityTask:
    """One to three of the blocks are spheres or prisms; the places are three to five."""
    rng = random.Random(seed)
    places = rng.randint(3, 5)
    pointed = rng.randint(1, min(3, places - 1, blocks - 1))
    kinds = {}
    for index, color in enumerate(rng.sample(sorted(COLORS), blocks)):
        shape = rng.choice(POINTED if index < pointed else FLAT_TOPPED)
        kinds[object_name(color, shape)] = (shape, rng.uniform(*EDGES))
    initial = _standing(kinds, places, rng)
    standing = rng.random() < STANDING_GOALS
    wanted = _standing(kinds, places, rng) if standing else _any(kinds, places, rng)
    goal = complete_goal(wanted)
    if rng.random() < 0.5:
        count = rng.randint(1, blocks - 1)
        goal = Goal(tuple(sorted(rng.sample(goal.relations, count))))
    return StabilityTask(kinds, initial, goal)


def _any(kinds: Kinds, places: int, rng: random.Random) -> Stacks:
    stacks: list[list[str]] = [[] for _ in range(places)]
    for name in rng.sample(sorted(kinds), len(kinds)):
        rng.choice(stacks).append(name)
    return tuple(map(tuple, stacks))


def _standing(kinds: Kinds, places: int, rng: random.Random) -> Stacks:
    while True:
        state = _any(kinds, places, rng)
        if not any(falls(kinds, low) for stack in state for low in stack[:-1]):
            return state


def falls(kinds: Kinds, support: str) -> bool:
    """Whether what is put on a block falls off."""
    return kinds[support][0] in POINTED


def unstable(kinds: Kinds, block: str, support: str) -> bool:
    """Whether a block is much wider than the one that it stands on; a sphere touches one point."""
    (shape, edge), (_, below) = kinds[block], kinds[support]
    return shape != SPHERE and edge > MAX_WIDTH_RATIO * below


def placements(states: Sequence[Stacks]) -> Iterator[tuple[str, str]]:
    """Every block that a plan puts on another one, with that one."""
    for before, after in itertools.pairwise(states):
        for old, new in zip(before, after):
            if len(new) > max(len(old), 1):
                yield new[-1], new[-2]


def best_plan(task: StabilityTask) -> tuple[int, int] | None:
    """Fewest unstable placements of any plan without falls, and its fewest moves; None: none."""
    wanted = {(item.subject, item.object) for item in task.goal.relations}
    queue: list[tuple[int, int, Stacks]] = [(0, 0, task.initial)]
    done: set[Stacks] = set()
    while queue:
        count, moves, state = heapq.heappop(queue)
        if state in done:
            continue
        done.add(state)
        columns = [(f"stack{index}", *stack) for index, stack in enumerate(state)]
        if wanted <= {pair[::-1] for column in columns for pair in itertools.pairwise(column)}:
            return count, moves
        for source, stack in enumerate(state):
            for target, other in enumerate(state):
                if not stack or source == target or (other and falls(task.kinds, other[-1])):
                    continue
                more = bool(other) and unstable(task.kinds, stack[-1], other[-1])
                after = list(state)
                after[source], after[target] = stack[:-1], (*other, stack[-1])
                heapq.heappush(queue, (count + more, moves + 1, tuple(after)))
    return None
