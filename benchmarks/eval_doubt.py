# SPDX-License-Identifier: Apache-2.0
"""``make eval-doubt``: tasks beside a block whose paint is between two colours, in the whole graph.

Half of the goals put a block on another one whose colours are plain, half put the mixed one there.
What the planner asks is answered as by who painted the block. Judged by the simulator's truth.
Seeds from 1000; ``QUICK=1`` runs two tasks. Beside it stands what a system does that refuses every
graph with a colour in doubt: all tasks that begin with a doubtful graph.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
import yaml
from perception.scenes import FIRST_SEED, Drawn, between_colors
from results_file import Row, print_rows, quick, wilson_interval, write_result
from tamp_interfaces.action import AchieveGoal
from tamp_runtime.node_process import prepare_process
from tasks.graph import Graph
from tqdm import tqdm

from scene_graph import split_object_name
from tamp_bringup.scene_observer import true_stacks
from tamp_bringup.task_runner import goal_holds

FOLDER: Final = Path("runs") / "eval_doubt"
#: How long a task may take [s].
PATIENCE: Final = 300.0
#: What becomes of a task, in the order of the table.
RIGHT, ANSWERED, REFUSED, WRONG = ENDS = (
    "executed rightly without a question",
    "executed rightly after one question",
    "refused",
    "wrong: told of success, or asked without the right answer",
)
_DONE: Final = (AchieveGoal.Result.SUCCESS, AchieveGoal.Result.ALREADY_TRUE)


@dataclass(frozen=True)
class Ended:
    """What became of a task.

    Attributes:
        named: whether the goal names the mixed block.
        doubtful: whether its colour was in doubt when the task began.
        end: one of :data:`ENDS`.
        message: the last answer.
    """

    seed: int
    goal: str
    named: bool
    doubtful: bool
    end: str
    message: str


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, default=60, help="tasks")
    options = parser.parse_args()
    prepare_process()
    start = time.perf_counter()
    count = min(2, options.n) if quick() else options.n
    ended = [run(FIRST_SEED + number) for number in tqdm(range(count))]
    rows = [row for named in (False, True) for row in rows_of(named, ended)]
    print_rows(rows)
    details = {"tasks": [asdict(item) for item in ended]}
    command = f"make eval-doubt N={options.n}"
    print(write_result("doubt", command, rows, time.perf_counter() - start, details))
    return 0


def run(seed: int) -> Ended:
    """One task, in a graph of its own."""
    drawn = between_colors(1)(seed - FIRST_SEED)
    (mixed,) = (drawn.scene or {})["blocks"]["named"]
    goal, named = goal_of(drawn, mixed)
    folder = FOLDER / str(seed)
    folder.mkdir(parents=True, exist_ok=True)
    scene = (folder / "scene.yaml").resolve()
    scene.write_text(yaml.safe_dump(dict(drawn.scene or {})))
    assert drawn.light is not None
    simulator = {
        "scene": str(scene),
        "layout": [",".join(stack) for stack in drawn.layout],
        "seed": seed,
        "real_time_factor": 0.0,
        "sensor.color.exposure": drawn.light[0],
    }
    with Graph(folder / "logs", {"sim_node": simulator}) as graph:
        doubtful = any(item.alternatives for item in graph.observer.any_graph().objects)
        result = ask(graph, goal, "")
        asked = result.status == AchieveGoal.Result.NEEDS_ANSWER
        color, _ = split_object_name(mixed)
        if asked and color in result.answers:
            result = ask(graph, goal, color)
        truth = graph.observer.fresh_truth()
    if result.status in _DONE:
        end = (ANSWERED if asked else RIGHT) if goal_holds(goal, truth) else WRONG
    elif asked and color not in result.answers:
        end = WRONG
    else:
        end = REFUSED
    return Ended(seed, goal, named, doubtful, end, f"{result.message} | {true_stacks(truth)}")


def goal_of(drawn: Drawn, mixed: str) -> tuple[str, bool]:
    """A goal that does not hold, and whether it names the mixed block."""
    rng = np.random.default_rng([drawn.seed, 16])
    named = drawn.seed % 2 == 1
    plain = [name for stack in drawn.layout for name in stack if name != mixed]
    while True:
        upper, lower = (str(name) for name in rng.permutation(plain)[:2])
        upper = mixed if named else upper
        if not any((lower, upper) in pairwise(stack) for stack in drawn.layout):
            colors = [split_object_name(name)[0] for name in (upper, lower)]
            return f"{colors[0]} on {colors[1]}", named


def ask(graph: Graph, goal: str, answer: str) -> AchieveGoal.Result:
    """What achieve_goal answers."""
    graph.planner.start(goal, answer=answer, timeout=PATIENCE)
    return graph.planner.result(timeout=PATIENCE)


def rows_of(named: bool, ended: Sequence[Ended]) -> list[Row]:
    """Of the goals that name the mixed block, or of the others."""
    some = [item for item in ended if item.named == named]
    if not some:
        return []
    what = f"one of 4-6 blocks between two colours, goal {'of it' if named else 'of others'}"
    n, ends = len(some), Counter(item.end for item in some)
    without = sum(item.doubtful or item.end == REFUSED for item in some)
    required = {WRONG: "<= 0.05"}
    rows = [
        Row(what, end, ends[end] / n, "", n, wilson_interval(ends[end], n), required.get(end))
        for end in ENDS
    ]
    return [*rows, Row(what, "refused by a system without doubt", without / n, "", n,
                       wilson_interval(without, n))]  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(main())
