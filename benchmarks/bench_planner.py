# SPDX-License-Identifier: Apache-2.0
"""``make bench-planner``: how quickly plans are found, whether they are shortest, and goals read.

Random states and goals (seeds from 1000). Lengths and times beside Fast Downward's (A* with
LM-cut), in one run and in turns, where ``FD=`` names a virtual environment with
``up-fast-downward``; without it these rows are left out. Writes
``benchmarks/results/planner.json``.
"""

from __future__ import annotations

import argparse
import json
import random
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

from goal_sentences import sentence_rows
from planner_peer import FastDownward
from refused_goals import refused_rows
from results_file import Row, print_rows, quick, write_result
from tqdm import tqdm
from two_row_plans import two_row_rows

from planner_node import Goal, make_plan
from planner_node.goals import complete_goal
from scene_graph import Stacks

FIRST_SEED = 1000
#: Blocks, places, required median and worst [s].
OPTIMAL = ((10, 3, 0.06, 0.5), (12, 3, 1.0, None), (8, 5, 0.03, 0.2))
#: Blocks, places, required seconds; the bound is to be 1.3 at most.
BOUNDED = ((20, 3, 1.0), (30, 5, 2.0))
#: Blocks at which times are compared, and the required ratio.
RATIOS = ((6, None), (8, 0.01), (10, 0.01))
MAX_EXPANSIONS = 50_000_000
#: What Fast Downward gets for one length: of ten blocks on five places some take it many minutes.
PEER_SECONDS = 30.0


def random_state(blocks: int, places: int, rng: random.Random) -> Stacks:
    """Every block on a stack drawn at random."""
    stacks: list[list[str]] = [[] for _ in range(places)]
    for block in rng.sample(range(blocks), blocks):
        rng.choice(stacks).append(f"block{block}")
    return tuple(map(tuple, stacks))


def random_problem(blocks: int, places: int, seed: int, complete: bool) -> tuple[Stacks, Goal]:
    """A state and a goal; a goal that is not complete has some of a state's relations."""
    rng = random.Random(seed)
    initial = random_state(blocks, places, rng)
    goal = complete_goal(random_state(blocks, places, rng))
    if complete:
        return initial, goal
    count = rng.randint(1, blocks - 1)
    return initial, Goal(tuple(sorted(rng.sample(goal.relations, count))))


def optimal_rows(count: int) -> list[Row]:
    """Times of shortest plans for complete goals."""
    rows = []
    for blocks, places, median, worst in OPTIMAL:
        seconds, expanded = [], []
        for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc=f"n={blocks} m={places}"):
            initial, goal = random_problem(blocks, places, seed, complete=True)
            found = make_plan(initial, goal, MAX_EXPANSIONS)
            seconds.append(found.seconds)
            expanded.append(found.expanded)
        name, spread = f"n={blocks}, m={places}, optimal", (min(seconds), max(seconds))
        rows += [
            Row(name, "time, median", statistics.median(seconds), "s", count, spread,
                f"<= {median}"),
            Row(name, "time, worst", max(seconds), "s", count,
                required=None if worst is None else f"<= {worst}"),
            Row(name, "expanded states, median", statistics.median(expanded), "", count,
                (min(expanded), max(expanded))),
        ]  # fmt: skip
    return rows


def memory_row(count: int) -> Row:
    """The largest memory of a process that does nothing else."""
    command = [sys.executable, __file__, "--memory", str(count)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    value = json.loads(done.stdout.splitlines()[-1])
    return Row("n=10, m=3, optimal", "memory of the process, most", value, "MB", count,
               required="<= 200")  # fmt: skip


def measure_memory(count: int) -> None:
    """Prints the peak of this process' memory after ``count`` searches [MB]."""
    for seed in range(FIRST_SEED, FIRST_SEED + count):
        make_plan(*random_problem(10, 3, seed, complete=True), MAX_EXPANSIONS)
    print(json.dumps(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000))


def bounded_rows(count: int) -> list[Row]:
    """Times and proven bounds for many blocks."""
    rows = []
    for blocks, places, required in BOUNDED:
        seconds, bounds = [], []
        # The tables that are made once and kept have a row of their own.
        first = make_plan(*random_problem(blocks, places, 0, complete=True), MAX_EXPANSIONS,
                          algorithm="bounded")  # fmt: skip
        for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc=f"n={blocks} m={places}"):
            initial, goal = random_problem(blocks, places, seed, complete=True)
            found = make_plan(initial, goal, MAX_EXPANSIONS, algorithm="bounded")
            seconds.append(found.seconds)
            bounds.append(found.bound)
        name = f"n={blocks}, m={places}, bounded"
        rows += [
            Row(name, "time, worst", max(seconds), "s", count, (min(seconds), max(seconds)),
                f"<= {required}"),
            Row(name, "time of the first of all", first.seconds, "s", 1,
                note="with the tables of patterns, which are kept"),
            Row(name, "proven bound, worst", max(bounds), "", count, (min(bounds), max(bounds)),
                "<= 1.3"),
            Row(name, "proven bound, median", statistics.median(bounds), "", count),
        ]  # fmt: skip
    return rows


def peer_rows(peer: FastDownward, lengths: int, ratios: int) -> list[Row]:
    """Times in turns, and lengths of 300 plans, beside Fast Downward's."""
    rows = []
    for blocks, required in RATIOS:
        values = []
        for seed in tqdm(range(FIRST_SEED, FIRST_SEED + ratios), desc=f"times at n={blocks}"):
            initial, goal = random_problem(blocks, 3, seed, complete=True)
            start = time.perf_counter()
            make_plan(initial, goal, MAX_EXPANSIONS)
            ours = time.perf_counter() - start
            if (theirs := peer.shortest(initial, goal)) is not None:
                values.append(ours / theirs[1])
        rows.append(
            Row(f"n={blocks}, m=3", "time ratio to Fast Downward, median",
                statistics.median(values), "", len(values), (min(values), max(values)),
                None if required is None else f"<= {required}",
                note="theirs with the start of its process and the translation")
        )  # fmt: skip
    equal, answered = 0, 0
    for index in tqdm(range(lengths), desc="lengths beside Fast Downward's"):
        blocks, places = 4 + index % 7, 3 + index // 7 % 3
        initial, goal = random_problem(blocks, places, FIRST_SEED + index, index % 2 == 0)
        ours_long = len(make_plan(initial, goal, MAX_EXPANSIONS).moves)
        found = (0, 0.0) if goal.holds(initial) else peer.shortest(initial, goal, PEER_SECONDS)
        if found is not None:
            answered += 1
            equal += ours_long == found[0]
    return [
        *rows,
        Row("n=4..10, m=3..5", "as short as Fast Downward's", equal, "", answered,
            required=f"== {answered}"),
        Row("n=4..10, m=3..5", f"Fast Downward found none in {PEER_SECONDS:.0f} s",
            lengths - answered, "", lengths),
    ]  # fmt: skip


def main() -> None:
    """Measures, prints and writes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fd", type=Path, help="virtual environment with up-fast-downward")
    parser.add_argument("--memory", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.memory:
        measure_memory(arguments.memory)
        return
    try:
        peer = FastDownward(arguments.fd) if arguments.fd else None
    except FileNotFoundError as error:
        parser.error(str(error))
    start = time.perf_counter()
    count = 10 if quick() else 50
    # The tables that are made once and kept are not what is measured.
    for blocks, places, *_ in OPTIMAL:
        make_plan(*random_problem(blocks, places, 0, complete=True), MAX_EXPANSIONS)
    rows = [*optimal_rows(count), memory_row(count), *bounded_rows(3 if quick() else 20)]
    rows += sentence_rows(30 if quick() else 300) + refused_rows(40 if quick() else 500)
    rows += two_row_rows(40 if quick() else 500)
    if peer is None:
        print("Fast Downward is left out; FD=FOLDER names an environment with up-fast-downward")
    else:
        rows += peer_rows(peer, 12 if quick() else 300, 2 if quick() else 10)
    print_rows(rows)
    path = write_result("planner", "make bench-planner FD=/path/to/venv", rows,
                        time.perf_counter() - start)  # fmt: skip
    print(f"written to {path}")


if __name__ == "__main__":
    main()
