# SPDX-License-Identifier: Apache-2.0
"""Planning on codes: images of start and goal in, moves out, judged by the rules."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from planner_node.action_models import ActionModel
from planner_node.search.on_models import ModelPlan, ModelSearch, NoModelPlanError
from scene_graph import ImpossibleMoveError, Move, Stacks, apply_move

#: States that a search may find before it gives up; 2,520 are real.
MAX_STATES: Final = 6000


@dataclass
class Plans:
    """What became of tasks.

    Attributes:
        valid: plans whose moves are possible and lead to the goal, by the rules.
        lengths: of the valid ones, moves.
        states, hallucinated: on all plans found, and how many of them are no state's code.
        seconds: of each search.
        failures: a sentence for each task without a valid plan.
    """

    n: int = 0
    valid: int = 0
    shortest: int = 0
    states: int = 0
    hallucinated: int = 0
    lengths: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)


def pairs(count: int, states: int, seed: int) -> NDArray[np.int64]:
    """Pairs of different states as indices, shape (count, 2)."""
    rng = np.random.default_rng([seed, states])
    starts = rng.integers(states, size=count)
    ends = (starts + rng.integers(1, states, size=count)) % states
    return np.stack([starts, ends], axis=1)


def plan_all(
    model: ActionModel[bytes],
    search: ModelSearch[bytes],
    tasks: NDArray[np.int64],
    starts: NDArray[np.uint8],
    goals: NDArray[np.uint8],
    layouts: Sequence[Stacks],
    real: Collection[bytes],
    distances: Mapping[tuple[int, int], int] | None = None,
) -> Plans:
    """Plans for pairs of states.

    Args:
        tasks: shape (n, 2).
        starts, goals: the codes of pictures of every state, shape (s, b); other pictures each.
        layouts: of the states, for the verdict.
        real: the codes of all states, to tell which ones on a plan are of none.
        distances: least numbers of moves, to tell which plans are shortest.
    """
    plans = Plans(len(tasks))
    for start, goal in tasks.tolist():
        begun = time.perf_counter()
        try:
            found = search(model, starts[start].tobytes(), goals[goal].tobytes(), MAX_STATES)
        except NoModelPlanError as error:
            plans.seconds.append(time.perf_counter() - begun)
            plans.failures.append(f"{start} to {goal}: {error}")
            continue
        plans.seconds.append(time.perf_counter() - begun)
        _judge(plans, found, layouts[start], layouts[goal], real, f"{start} to {goal}")
        if distances is not None and len(found.moves) == distances[start, goal]:
            plans.shortest += 1
    return plans


def _judge(
    plans: Plans,
    found: ModelPlan[bytes],
    start: Stacks,
    goal: Stacks,
    real: Collection[bytes],
    task: str,
) -> None:
    plans.states += len(found.states)
    plans.hallucinated += sum(state not in real for state in found.states)
    ended = carried_out(start, found.moves)
    if ended == goal:
        plans.valid += 1
        plans.lengths.append(len(found.moves))
    elif ended is None:
        plans.failures.append(f"{task}: {' '.join(map(str, found.moves))} is not possible")
    else:
        plans.failures.append(f"{task}: {' '.join(map(str, found.moves))} ends elsewhere")


def carried_out(start: Stacks, moves: Sequence[Move]) -> Stacks | None:
    """The state after moves by the rules; None: one of them is impossible."""
    try:
        for move in moves:
            start = apply_move(start, move)
    except ImpossibleMoveError:
        return None
    return start


def majority(codes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The most frequent code of each state's pictures, shape (s, r, b) -> (s, b)."""
    chosen = []
    for rows in codes:
        seen = [row.tobytes() for row in rows]
        chosen.append(rows[seen.index(max(seen, key=seen.count))])
    return np.stack(chosen)
