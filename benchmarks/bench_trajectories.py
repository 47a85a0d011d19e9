# SPDX-License-Identifier: Apache-2.0
"""``make bench-trajectories``: a thousand random plans, and what others say of their motions.

Random scenes and plans of 1, 3, 6 and 12 moves in turn (seeds from 1000), without a node. Each is
looked at by the node's dense check, by pybullet's meshes and by a sampler that is scipy's; paths
are compared with the best of 20 starting points, all bounds' derivatives with finite differences.
Each plan leaves a file in ``runs/trajectories``: a run that was stopped can be taken up again.
Writes ``benchmarks/results/trajectories.json``.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np
from bench_motion import LENGTHS, broken_limits, prepared_planner, random_problem, solve
from collision_oracle import replay
from kept_results import FIRST_SEED, kept, options
from numpy.typing import NDArray
from path_starts import best_of_starts
from results_file import Row, print_rows, quick, write_result
from tqdm import tqdm

from motion_node.blocks import read_scene
from motion_node.constraints import AtSwitch, Clearances, default_constraints
from motion_node.dense_check import check
from motion_node.nlp.rows import Rows
from motion_node.planner import MotionPlanner

Array = NDArray[np.float64]

FOLDER: Final = "trajectories"
#: Height above a switch within which a held block may touch what it stands on [m].
VERTICAL: Final = 0.05
#: So many plans of three moves are solved from other starting points, too.
OTHERS: Final = 10
STARTS: Final = 20
#: For derivatives: configurations, and the step of central differences [rad].
POINTS: Final = 20
STEP: Final = 1e-5


def plan(planner: MotionPlanner, seed: int) -> dict[str, Any]:
    """One random plan, and what is said of its motion."""
    problem = random_problem(LENGTHS[seed % len(LENGTHS)][0], seed)
    motion = solve(planner, problem)
    if motion is None:
        return {"seed": seed, "feasible": False}
    checked = check(planner.model, motion.trajectory, read_scene(problem.graph), ())
    gap = planner.settings.phases.place_gap
    touched = ""
    try:
        found = replay(problem.graph, problem.moves, motion, gap, VERTICAL)
        least, what = found.free.distance, found.free.what
    except AssertionError as error:
        least, what, touched = 0.0, str(error), str(error)
    return {
        "seed": seed,
        "feasible": True,
        "contacts": [f"{own.body} to {own.other}" for own in checked.contacts],
        "least": least,
        "what": what,
        "touched": touched,
        "broken": broken_limits(planner, motion),
    }


def plan_rows(found: list[dict[str, Any]]) -> list[Row]:
    """Of all random plans."""
    n, done = len(found), [item for item in found if item["feasible"]]
    good = sum(not item["contacts"] and item["least"] > 0.0 for item in done)
    gaps = [1000 * item["least"] for item in done]
    nearest = min(done, key=lambda item: float(item["least"]))["what"]
    name = "random plans of 1, 3, 6 and 12 moves"
    rows = [
        Row(name, "feasible, dense check included, and nothing touches by the meshes", good, "", n,
            required=f"== {n}"),
        Row(name, "least distance by pybullet's meshes", min(gaps), "mm", len(gaps),
            (min(gaps), max(gaps)), "> 0",
            note=f"every 40 ms, of what is not meant to touch; {nearest}"),
        Row(name, "least distance by pybullet's meshes, median", statistics.median(gaps), "mm",
            len(gaps), (min(gaps), max(gaps))),
    ]  # fmt: skip
    for which in ("velocity", "acceleration", "jerk", "rest"):
        words = "that do not begin and end at rest" if which == "rest" else f"beyond {which}"
        rows.append(
            Row(name, f"trajectories {words}", sum(which in item["broken"] for item in done), "",
                len(done), required="== 0", note="sampled every millisecond by scipy")
        )  # fmt: skip
    return rows


def start_rows(planner: MotionPlanner, count: int) -> list[Row]:
    """How much quicker the best of many starting points is."""
    ratios, solved = list[float](), list[float]()
    for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc="starts"):
        motion = solve(planner, random_problem(3, seed))
        if motion is not None:
            ratio, feasible = best_of_starts(planner, motion, STARTS, np.random.default_rng(seed))
            ratios.append(ratio)
            solved.append(feasible)
    return [
        Row("3 moves", f"duration of the ways as a multiple of the best of {STARTS} starts, median",
            statistics.median(ratios), "", len(ratios), (min(ratios), max(ratios)), "<= 1.1",
            note="each way alone, the quickest of what its starting points lead to, ours among "
            f"them; {statistics.mean(solved):.0%} of the others led to a way")
    ]  # fmt: skip


def derivative_rows(planner: MotionPlanner) -> list[Row]:
    """Jacobians and curvatures of all constraints beside central differences."""
    rng, worst = np.random.default_rng(FIRST_SEED), [0.0, 0.0]
    problem = random_problem(1, FIRST_SEED)
    motion = solve(planner, problem)
    assert motion is not None
    n, clear = planner.model.dimension, Clearances(planner.settings.path.margin, motion.floor)
    count = 0
    for constraint in default_constraints(planner.arm):
        rows = constraint.rows(planner.model, len(problem.graph.places))
        phase = motion.phases[1]
        if constraint.at_switches:
            demand = constraint.at_switch(AtSwitch(planner.arm, phase, clear))
        else:
            way = planner.prepare(3)[1].along(phase, list(motion.paths[1].q), clear)
            demand = constraint.along_path(way)
        parameters = demand.parameters[-1]
        for _ in range(POINTS):
            q = planner.model.home + rng.uniform(-0.4, 0.4, n)
            weights = rng.normal(size=rows.count)
            weights /= np.linalg.norm(weights)

            exact = (
                np.array(rows.jacobian(q, parameters)),
                np.array(rows.curvature(q, parameters, weights)),
            )
            for index, function in enumerate(
                (partial(value, rows, parameters), partial(slope, rows, parameters, weights))
            ):
                columns = [difference(function, q, axis) for axis in np.eye(n)]
                missed = np.abs(exact[index] - np.column_stack(columns)).max(initial=0.0)
                worst[index] = max(worst[index], float(missed))
            count += 1
    name = "all constraints"
    return [
        Row(name, "gradients beside central differences, largest difference", worst[0], "", count,
            required="<= 1e-6",
            note=f"of the fourth order, step {STEP:g} rad, at random configurations"),
        Row(name, "Hessians beside central differences, largest difference", worst[1], "", count,
            required="<= 1e-6", note="of a random combination of rows of length 1"),
    ]  # fmt: skip


def difference(function: Callable[[Array], Array], q: Array, axis: Array) -> Array:
    """A derivative by central differences of the fourth order."""
    near = function(q + STEP * axis) - function(q - STEP * axis)
    far = function(q + 2 * STEP * axis) - function(q - 2 * STEP * axis)
    return (8 * near - far) / (12 * STEP)


def value(rows: Rows, parameters: Array, q: Array) -> Array:
    """Of all rows at a configuration (n,)."""
    return np.array(rows.value(q, parameters)).ravel()


def slope(rows: Rows, parameters: Array, weights: Array, q: Array) -> Array:
    """Gradient (n,) of a combination of rows at a configuration (n,)."""
    return np.asarray(weights @ np.array(rows.jacobian(q, parameters)))


def main() -> None:
    """Measures, prints and writes."""
    arguments = options(__doc__, 1000, 40)
    start = time.perf_counter()
    planner = prepared_planner([moves for moves, *_ in LENGTHS])
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    found = [
        kept(FOLDER, seed, arguments.resume, partial(plan, planner))
        for seed in tqdm(seeds, desc="plans")
    ]
    rows = plan_rows(found) + derivative_rows(planner)
    rows += start_rows(planner, 3 if quick() else OTHERS)
    print_rows(rows)
    odd = [
        item
        for item in found
        if not item["feasible"] or item["contacts"] or item["touched"] or item["broken"]
    ]
    if arguments.seed != FIRST_SEED:
        for item in odd:
            print(item)
        return
    seconds = time.perf_counter() - start
    path = write_result("trajectories", "make bench-trajectories", rows, seconds, {"odd": odd})
    print(f"written to {path}")


if __name__ == "__main__":
    main()
