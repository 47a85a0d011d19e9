# SPDX-License-Identifier: Apache-2.0
"""``make bench-stability``: plans for spheres, prisms and mixed sizes, beside brute force (5.4.2).

Random goals for 4 to 7 blocks of which one to three are spheres or prisms (seeds from 1000). Up to
five blocks, brute force says what can be avoided and how many moves that takes. Beside it stand the
plans of a search that knows nothing of shapes and sizes. Writes
``benchmarks/results/stability.json``.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass

from results_file import Row, print_rows, quick, write_result
from stability_oracle import StabilityTask, best_plan, falls, placements, random_task, unstable
from tqdm import tqdm

from planner_node import (
    Figure,
    PlannerError,
    SearchResult,
    Stability,
    UnreachableError,
    make_plan,
    make_stable_plan,
)

FIRST_SEED = 1000
BLOCKS = (4, 5, 6, 7)
#: Of more blocks there are too many arrangements to try all of them.
MOST_BY_BRUTE_FORCE = 5


@dataclass(frozen=True)
class Answer:
    """What the planner made of a task.

    Attributes:
        found: None: it refused.
        proven: whether a refusal says that there is no plan.
        seconds: wall time.
        plain: what a search makes of it that knows nothing of shapes and sizes; None: no plan.
        plain_seconds: its wall time.
    """

    task: StabilityTask
    found: SearchResult | None
    proven: bool
    seconds: float
    plain: SearchResult | None
    plain_seconds: float

    @property
    def blocks(self) -> int:
        """How many."""
        return len(self.task.kinds)


def answer(task: StabilityTask) -> Answer:
    """Plans with and without stability."""
    rules = Stability(
        {name: Figure(shape, edge, edge) for name, (shape, edge) in task.kinds.items()}
    )
    _planned(task, None)  # makes the tables that are kept, which are not what is measured
    start = time.perf_counter()
    plain, _ = _planned(task, None)
    middle = time.perf_counter()
    found, proven = _planned(task, rules)
    return Answer(task, found, proven, time.perf_counter() - middle, plain, middle - start)


def _planned(task: StabilityTask, rules: Stability | None) -> tuple[SearchResult | None, bool]:
    try:
        if rules is None:
            return make_plan(task.initial, task.goal), True
        return make_stable_plan(task.initial, task.goal, rules), True
    except PlannerError as error:
        return None, isinstance(error, UnreachableError)


def fall_count(task: StabilityTask, found: SearchResult) -> int:
    """Blocks that a plan puts where they fall."""
    return sum(falls(task.kinds, low) for _, low in placements(found.states))


def unstable_count(task: StabilityTask, found: SearchResult) -> int:
    """Blocks that a plan puts where they fall, or on much narrower ones."""
    return fall_count(task, found) + sum(
        not falls(task.kinds, low) and unstable(task.kinds, top, low)
        for top, low in placements(found.states)
    )


def oracle_rows(answers: Sequence[Answer]) -> list[Row]:
    """What brute force says of the plans for few blocks."""
    name, count = f"n=4..{MOST_BY_BRUTE_FORCE}", len(answers)
    avoidable = equal = agreed = plain_avoidable = 0
    for item in tqdm(answers, desc="brute force"):
        best = best_plan(item.task)
        agreed += (best is None) == (item.found is None) and item.proven
        if best is None:
            continue
        if item.plain is not None:
            plain_avoidable += unstable_count(item.task, item.plain) > best[0]
        if item.found is not None:
            avoidable += max(0, unstable_count(item.task, item.found) - best[0])
            equal += (unstable_count(item.task, item.found), len(item.found.moves)) == best

    solved = sum(item.found is not None for item in answers)
    return [
        Row(name, "unstable placements where avoidable", avoidable, "", solved, required="== 0"),
        Row(name, "as short as brute force's stable plan", equal, "", solved,
            required=f"== {solved}"),
        Row(name, "refused as impossible, or not, as brute force says", agreed, "", count,
            required=f"== {count}", note=f"{count - solved} refused"),
        Row(name, "stability ignored: plans with what could be avoided", plain_avoidable, "",
            count),
    ]  # fmt: skip


def all_rows(answers: Sequence[Answer]) -> list[Row]:
    """Of all tasks: falls, lengths and times."""
    name, count = f"n={BLOCKS[0]}..{BLOCKS[-1]}", len(answers)
    solved = [(item, item.found) for item in answers if item.found is not None]
    fallen = sum(fall_count(item.task, found) for item, found in solved)
    untold = sum(unstable_count(item.task, found) != len(found.unstable) for item, found in solved)
    plain = sum(
        unstable_count(item.task, item.plain) > 0 for item in answers if item.plain is not None
    )
    more = [len(f.moves) - len(item.plain.moves) for item, f in solved if item.plain is not None]
    longer = [moves for moves in more if moves > 0]
    seconds = [item.seconds for item in answers]
    plain_seconds = [item.plain_seconds for item in answers]
    limited = sum(item.found is None and not item.proven for item in answers)
    return [
        Row(name, "blocks put where they fall", fallen, "", len(solved), required="== 0"),
        Row(name, "plans that do not tell what is unstable", untold, "", len(solved),
            required="== 0"),
        Row(name, "neither planned nor proven impossible", limited, "", count, required="== 0"),
        Row(name, "stability ignored: plans with falls or much wider on narrower", plain, "",
            count),
        Row(name, "plans that had to be longer than the shortest", len(longer), "",
            len(solved)),
        Row(name, "moves more, where longer, mean",
            statistics.mean(longer or [0]), "", len(longer),
            (min(longer, default=0), max(longer, default=0))),
        Row(name, "time, median", statistics.median(seconds), "s", count,
            (min(seconds), max(seconds))),
        Row(name, "stability ignored: time, median", statistics.median(plain_seconds), "s", count,
            (min(plain_seconds), max(plain_seconds))),
    ]  # fmt: skip


def main() -> None:
    """Measures, prints and writes."""
    start = time.perf_counter()
    count = 40 if quick() else 300
    answers = [
        answer(random_task(FIRST_SEED + index, BLOCKS[index % len(BLOCKS)]))
        for index in tqdm(range(count), desc="plans")
    ]
    few = [item for item in answers if item.blocks <= MOST_BY_BRUTE_FORCE]
    rows = [*oracle_rows(few), *all_rows(answers)]
    print_rows(rows)
    path = write_result("stability", "make bench-stability", rows, time.perf_counter() - start)
    print(f"written to {path}")


if __name__ == "__main__":
    main()
