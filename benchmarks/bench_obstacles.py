# SPDX-License-Identifier: Apache-2.0
"""``make bench-obstacles``: goals on tables with walls, narrow places and places out of reach.

Generated scenes (seeds from 1000), each solved or proven impossible by plans and motions in turns,
without a node; brute force over all arrangements and pybullet's meshes says which it is, and a
scene in which it is not sure is drawn anew. Writes ``benchmarks/results/obstacles.json``.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pybullet_data
from motion_scenes import random_heights, scene
from obstacle_oracle import ObstacleOracle, Reachable
from obstacle_scenes import WIDE, Backtracked, pen, plan_geometrically, wall
from results_file import Row, print_rows, quick, wilson_interval, write_result
from tqdm import tqdm

from motion_node.nlp.compiled import finish
from motion_node.obstacles import Obstacle
from motion_node.planner import MotionPlanner
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import SceneGraph

FIRST_SEED: Final = 1000
BLOCKS: Final = 3
#: Problems are built for so many obstacles.
MOST: Final = 4
#: A scene is drawn anew so often until brute force is sure of it.
DRAWS: Final = 30

Places = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Table:
    """A scene with a goal.

    Attributes:
        kind: what is the matter with it.
        words: one of these stands in the reasons of a right refusal.
    """

    kind: str
    places: Places
    graph: SceneGraph
    obstacles: tuple[Obstacle, ...]
    goal: str
    words: tuple[str, ...]


def _goal(graph: SceneGraph, rng: np.random.Generator) -> str:
    names = list(graph.names)
    first, second = rng.choice(len(names), 2, replace=False)
    place = f"{names[first]} on stack{rng.integers(len(graph.places))}"
    return [place, f"{names[first]} on {names[second]}"][rng.integers(2)]


def walls(rng: np.random.Generator) -> Table:
    """A wall between two places, of any height."""
    graph = scene(random_heights(rng, BLOCKS), places=WIDE)
    y = [-0.1, 0.1][rng.integers(2)]
    length, height = rng.uniform(0.1, 0.5), rng.uniform(0.05, 0.5)
    around = (wall(0.5, y, float(length), float(height)),)
    return Table("a wall", WIDE, graph, around, _goal(graph, rng), ("wall",))


def reach(rng: np.random.Generator) -> Table:
    """A place that is out of reach, or just within it, without anything to move there."""
    x = float(rng.uniform(0.45, 1.0))
    places = (*WIDE[:2], (x, 0.2))
    graph = scene((*random_heights(rng, BLOCKS, 2), 0), places=places)
    post = Obstacle("post", (0.03, 0.03, 0.2), (0.3, -0.45, 0.1))
    return Table("reach", places, graph, (post,), _goal(graph, rng), ("reach",))


def narrow(rng: np.random.Generator) -> Table:
    """Walls before and behind a place, or on both sides of it, leave one direction of the hand."""
    graph = scene(random_heights(rng, BLOCKS), places=WIDE)
    place = WIDE[rng.integers(3)]
    gap, height = float(rng.uniform(0.08, 0.13)), float(rng.uniform(0.1, 0.35))
    around = tuple(
        wall(place[0] + side * gap, place[1], 0.12, height, yaw=np.pi / 2, name=f"{name} wall")
        for side, name in ((-1, "back"), (1, "front"))
    )
    return Table("narrow", WIDE, graph, around, _goal(graph, rng), ("wall",))


def pens(rng: np.random.Generator) -> Table:
    """A place that is walled in."""
    index, height = int(rng.integers(3)), float(rng.uniform(0.04, 0.35))
    heights = [0, 0, 0]
    others = [i for i in range(3) if i != index]
    heights[others[0]], heights[others[1]] = random_heights(rng, BLOCKS, 2)
    graph = scene(heights, places=WIDE)
    return Table("walled in", WIDE, graph, pen(*WIDE[index], height), _goal(graph, rng), ("fence",))


KINDS: Final[tuple[Callable[[np.random.Generator], Table], ...]] = (walls, reach, narrow, pens)


@dataclass
class Result:
    """What came out of one table; ``seconds`` of the processor, one thread."""

    table: Table
    solvable: bool
    came_to: Backtracked
    seconds: float
    least: float

    @property
    def agrees(self) -> bool:
        """With brute force."""
        return (self.came_to.motion is not None) == self.solvable

    @property
    def reasoned(self) -> bool:
        """Whether a refusal names what is the matter."""
        reasons = [item.reason for item in self.came_to.exclusions]
        return bool(reasons) and all(
            any(word in reason for word in self.table.words) for reason in reasons
        )


def one(planner: MotionPlanner, seed: int) -> Result | None:
    """The table of a seed; None if brute force is never sure."""
    kind = KINDS[seed % len(KINDS)]
    for draw in range(DRAWS):
        table = kind(np.random.default_rng([seed, draw]))
        oracle = ObstacleOracle(planner, table.obstacles)
        try:
            reachable = Reachable(oracle, table.places, BLOCKS)
            goal = resolve_goal(parse_goal(table.goal), table.graph.names)
            stacks = table.graph.stacks()
            if goal.holds(stacks) or not reachable.clear:
                continue
            solvable = reachable.solvable(stacks, goal)
            planner.surround(table.obstacles)
            begin = time.process_time()
            came_to = plan_geometrically(planner, table.graph, table.goal)
            seconds = time.process_time() - begin
            least = oracle.touched(came_to.motion) if came_to.motion else np.inf
            return Result(table, solvable, came_to, seconds, least)
        finally:
            oracle.close()
    return None


def rows_of(results: list[Result]) -> list[Row]:
    """The published numbers."""
    rows = list[Row]()
    for kind in (*dict.fromkeys(item.table.kind for item in results), "all"):
        own = [item for item in results if kind in (item.table.kind, "all")]
        right = sum(item.agrees for item in own)
        solved = sum(item.came_to.motion is not None for item in own)
        rows.append(
            Row(kind, "solved or refused as brute force says", right / len(own), "", len(own),
                wilson_interval(right, len(own)), ">= 1",
                note=f"{solved} solved, {len(own) - solved} refused as impossible")
        )  # fmt: skip
    refused = [item for item in results if item.came_to.motion is None]
    reasoned = sum(item.reasoned for item in refused)
    if refused:
        rows.append(
            Row("all", "refusals that name what is in the way", reasoned / len(refused), "",
                len(refused), wilson_interval(reasoned, len(refused)), ">= 1")
        )  # fmt: skip
    times = [item.seconds for item in results]
    excluded = [len(item.came_to.exclusions) for item in results]
    moved = [item.least for item in results if item.came_to.motion is not None]
    return [
        *rows,
        Row("all", "time, plans and motions and verdicts, median", float(np.median(times)), "s",
            len(times), (min(times), max(times)), note="of the processor, one thread"),
        Row("all", "time, longest", max(times), "s", len(times), required="<= 1"),
        Row("all", "moves excluded a scene, mean", float(np.mean(excluded)), "", len(times),
            (min(excluded), max(excluded))),
        Row("all", "motions whose meshes touch an obstacle", sum(v <= 0 for v in moved), "",
            len(moved), required="== 0",
            note=f"by pybullet, every 20 ms; the nearest comes {1000 * min(moved):.0f} mm near"),
    ]  # fmt: skip


def main() -> None:
    """Measures, prints and writes."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    start, count = time.perf_counter(), 8 if quick() else 40
    urdf = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    nowhere = Obstacle("nothing", (0.01, 0.01, 0.01), (-0.5, -0.5, 0.005))
    planner = MotionPlanner(urdf.read_text(), obstacles=[nowhere] * MOST)
    for moves in range(1, 5):
        planner.prepare(3, moves)
    finish()
    plan_geometrically(planner, scene((1, 1, 0), places=WIDE), "red on green")
    found = [one(planner, seed) for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count))]
    results = [item for item in found if item is not None]
    rows = rows_of(results)
    print_rows(rows)
    details = {
        "wrong": [
            {"kind": item.table.kind, "goal": item.table.goal, "solvable": item.solvable,
             "seconds": round(item.seconds, 2),
             "refusal": item.came_to.refusal, "excluded": [str(e) for e in item.came_to.exclusions]}
            for item in results
            if not item.agrees or (item.came_to.motion is None and not item.reasoned)
        ]
    }  # fmt: skip
    path = write_result(
        "obstacles", "make bench-obstacles", rows, time.perf_counter() - start, details
    )
    print(f"written to {path}")


if __name__ == "__main__":
    main()
