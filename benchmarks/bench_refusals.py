# SPDX-License-Identifier: Apache-2.0
"""``make bench-refusals``: moves that cannot be, whether the reason is right, and what would help.

Generated tables (seeds from 1000) of which it is known why the move cannot be. The change that is
suggested is made by its words alone, the move is solved anew, and pybullet's meshes say whether
its motion touches an obstacle. Without a node. Each table leaves a file in ``runs/refusals``: a run
that was stopped can be taken up again. Writes ``benchmarks/results/refusals.json``.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pybullet_data
from kept_results import FIRST_SEED, kept, options
from obstacle_oracle import ObstacleOracle
from refusal_tables import KINDS, Refused, followed
from results_file import Row, print_rows, wilson_interval, write_result
from tqdm import tqdm

from motion_node.blocks import read_scene
from motion_node.certificate import Suggestions
from motion_node.dense_check import check
from motion_node.errors import InfeasibleError
from motion_node.nlp.compiled import finish
from motion_node.obstacles import Obstacle
from motion_node.planner import MotionPlanner

#: Problems are built for so many obstacles.
MOST: Final = 4
FOLDER: Final = "refusals"


@dataclass(frozen=True)
class Result:
    """What was said of one table.

    Attributes:
        kind: why the move cannot be, as the table was made.
        reason: empty: the move was not refused.
        right: whether the reason is that for which the table was made.
        feasible: whether it can be once the suggestion is followed; ``objection``: why not.
        refusing, suggesting: time of the processor [s].
    """

    kind: str
    seed: int
    reason: str = ""
    right: bool = False
    violation: float = 0.0
    suggestion: str = ""
    millimetres: float = 0.0
    feasible: bool = False
    objection: str = ""
    refusing: float = 0.0
    suggesting: float = 0.0


class Bench:
    """Planners without obstacles and with them, their problems built."""

    def __init__(self) -> None:
        urdf = (Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf").read_text()
        nowhere = Obstacle("nothing", (0.01, 0.01, 0.01), (-0.5, -0.5, 0.005))
        self._plain = MotionPlanner(urdf)
        self._among = MotionPlanner(urdf, obstacles=[nowhere] * MOST)
        for planner in (self._plain, self._among):
            planner.prepare(3, 1)
        finish()

    def one(self, seed: int) -> Result:
        """The table of a seed."""
        table = KINDS[seed % len(KINDS)](np.random.default_rng(seed))
        begin = time.process_time()
        error = self._refusal(table)
        if error is None:
            return Result(table.kind, seed)
        middle = time.process_time()
        planner = self._planner(table)
        found = Suggestions(planner).suggest(
            table.graph, [table.move], planner.model.home, np.full(2, 0.04), error
        )
        times = (middle - begin, time.process_time() - middle)
        right = any(word in error.constraint for word in table.words)
        told = (table.kind, seed, error.constraint, right, error.violation)
        if found is None:
            return Result(*told, refusing=times[0], suggesting=times[1])
        objection = self._objection(followed(table, found.words))
        size = 1000 * found.change.size
        return Result(*told, found.words, size, not objection, objection, *times)

    def _planner(self, table: Refused) -> MotionPlanner:
        if not table.obstacles:
            return self._plain
        self._among.surround(table.obstacles)
        return self._among

    def _refusal(self, table: Refused) -> InfeasibleError | None:
        planner = self._planner(table)
        try:
            planner.solve(table.graph, [table.move], planner.model.home, np.full(2, 0.04))
        except InfeasibleError as error:
            return error
        return None

    def _objection(self, table: Refused) -> str:
        """Why the move cannot be on a table; empty: it can."""
        planner = self._planner(table)
        try:
            motion = planner.solve(table.graph, [table.move], planner.model.home, np.full(2, 0.04))
        except InfeasibleError as error:
            return str(error)
        scene = read_scene(table.graph)
        if check(planner.model, motion.trajectory, scene, table.obstacles).contacts:
            return "the dense check objects"
        oracle = ObstacleOracle(planner, table.obstacles)
        try:
            touched = bool(table.obstacles) and oracle.touched(motion) <= 0
        finally:
            oracle.close()
        return "a mesh touches an obstacle" if touched else ""


def rows_of(results: list[Result]) -> list[Row]:
    """The published numbers."""
    rows = list[Row]()
    for kind in (*dict.fromkeys(item.kind for item in results), "all"):
        own = [item for item in results if kind in (item.kind, "all")]
        right, helped = sum(item.right for item in own), sum(item.feasible for item in own)
        told = [item.millimetres for item in own if item.suggestion]
        bounds = (">= 0.99", ">= 0.95") if kind == "all" else (None, None)
        rows += [
            Row(kind, "reason right", right / len(own), "", len(own),
                wilson_interval(right, len(own)), bounds[0]),
            Row(kind, "suggested change makes it feasible", helped / len(own), "", len(own),
                wilson_interval(helped, len(own)), bounds[1],
                note=f"{len(own) - len(told)} without a suggestion"),
        ]  # fmt: skip
        if told:
            rows.append(
                Row(kind, "size of the change, median", float(np.median(told)), "mm", len(told),
                    (min(told), max(told)))
            )  # fmt: skip
    for name, values in (
        ("time to refuse, median", [item.refusing for item in results]),
        ("time to find what would help, median", [item.suggesting for item in results]),
    ):
        rows.append(
            Row("all", name, float(np.median(values)), "s", len(values),
                (min(values), max(values)), note="of the processor")
        )  # fmt: skip
    return rows


def main() -> None:
    """Measures, prints and writes."""
    arguments = options(__doc__, 200, 12)
    start, bench = time.perf_counter(), Bench()
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    results = [
        Result(**kept(FOLDER, seed, arguments.resume, lambda own: asdict(bench.one(own))))
        for seed in tqdm(seeds)
    ]
    rows = rows_of(results)
    print_rows(rows)
    told = [
        {"kind": item.kind, "seed": item.seed, "reason": item.reason,
         "violation": round(item.violation, 4), "suggestion": item.suggestion,
         "objection": item.objection, "seconds": round(item.suggesting, 2)}
        for item in results
    ]  # fmt: skip
    if arguments.seed != FIRST_SEED:
        for item in told:
            print(item)
        return
    details = {
        "wrong": [own for own, item in zip(told, results) if not (item.right and item.feasible)],
        "examples": told[: 2 * len(KINDS)],
    }
    path = write_result(
        "refusals", "make bench-refusals", rows, time.perf_counter() - start, details
    )
    print(f"written to {path}")


if __name__ == "__main__":
    main()
