# SPDX-License-Identifier: Apache-2.0
"""``make bench-motion``: how quickly motions are found, and how quick they are.

Random scenes and plans (seeds from 1000), without a node. Beside rai's KOMO and TOPP-RA, in one run
and in turns, where ``PEERS=`` names a virtual environment with ``robotic`` and ``toppra``; without
it these rows are left out. Writes ``benchmarks/results/motion.json``.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import pybullet_data
from joint_starts import Gap, gap_to_joint
from motion_in_graph import PERIOD, MotionInGraph
from motion_peers import Peers
from motion_scenes import BASES, random_heights, random_moves, scene
from numpy.typing import NDArray
from results_file import Row, print_rows, quick, write_result
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from tqdm import tqdm

from motion_node.correcting import corrected
from motion_node.errors import InfeasibleError
from motion_node.nlp.compiled import finish
from motion_node.phases import PICK
from motion_node.planner import Motion, MotionPlanner
from motion_node.timing.limits import JointLimits
from scene_graph import Move, SceneGraph, SceneObject

Array = NDArray[np.float64]

FIRST_SEED: Final = 1000
BLOCKS: Final = 6
#: Moves, required median [s], and required ratio to rai.
LENGTHS: Final = ((1, 0.010, None), (3, 0.020, 0.06), (6, 0.035, 0.06), (12, 0.070, 0.06))
#: Of these moves durations are looked at.
TIMED: Final = 6
#: Of these moves the path problem is solved undivided, too, from so many starting points.
UNDIVIDED: Final = (1, 3, 6)
STARTS: Final = 6
#: Of these moves one is corrected under way, for a block that was shifted so far [m], in the first
#: part of the way to it.
CORRECTED: Final = 3
SHIFT: Final = 0.05
LATEST: Final = 0.6
#: Points of TOPP-RA's grid: more change its durations by less than one in a hundred.
GRID: Final = 225
#: Between two samples of a trajectory [s].
SAMPLING: Final = 0.001
#: What Franka allows the Panda's joints [rad/s³].
JERK: Final = np.array([15000.0, 7500.0, 10000.0, 12500.0, 15000.0, 20000.0, 20000.0])


@dataclass(frozen=True)
class Problem:
    """A scene with moves in it."""

    heights: tuple[int, ...]
    graph: SceneGraph
    moves: list[Move]


def random_problem(moves: int, seed: int) -> Problem:
    """Blocks a little beside their places and turned, and a random walk."""
    rng = np.random.default_rng([seed, moves])
    heights = random_heights(rng, BLOCKS)
    graph = scene(heights, rng)
    return Problem(heights, graph, random_moves(graph, moves, rng))


def solve(planner: MotionPlanner, problem: Problem) -> Motion | None:
    """The motion from home with open fingers; None if there is none."""
    fingers = np.full(2, planner.arm.gripper.finger_travel)
    try:
        return planner.solve(problem.graph, problem.moves, planner.model.home, fingers)
    except InfeasibleError:
        return None


def time_rows(planner: MotionPlanner, peers: Peers | None, count: int) -> list[Row]:
    """How long it takes to find motions, alone and beside rai."""
    rows, failed, total = list[Row](), 0, 0
    for moves, required, ratio in LENGTHS:
        ours, ratios, infeasible = list[float](), list[float](), 0
        for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc=f"{moves} moves"):
            problem = random_problem(moves, seed)
            motion = solve(planner, problem)
            total += 1
            if motion is None:
                failed += 1
                continue
            ours.append(motion.seconds)
            if peers is None:
                continue
            seconds, feasible = peers.komo(problem.heights, BASES, problem.moves)
            infeasible += not feasible
            ratios.append(motion.seconds / seconds)
        name = f"{moves} moves" if moves > 1 else "1 move"
        rows.append(
            Row(name, "time to find the motion, median", statistics.median(ours), "s", len(ours),
                (min(ours), max(ours)), f"<= {required}",
                note="all clearances; alone, without a node")
        )  # fmt: skip
        if ratios:
            rows.append(
                Row(name, "time ratio to rai's KOMO, median", statistics.median(ratios), "",
                    len(ratios), (min(ratios), max(ratios)),
                    None if ratio is None else f"<= {ratio}",
                    note="theirs with arm and table kept from colliding, and without the blocks; "
                    f"{infeasible} of {len(ratios)} of theirs infeasible")
            )  # fmt: skip
    return [
        *rows,
        Row("all of these", "plans without a motion", failed, "", total, required="== 0"),
    ]


def duration_rows(planner: MotionPlanner, peers: Peers | None, count: int) -> list[Row]:
    """How long the arm takes for six moves, and what limits it keeps."""
    limits = limits_of(planner)
    whole, moving, stretched, ratios = list[float](), list[float](), list[float](), list[float]()
    jerky, broken = list[float](), list[list[str]]()
    for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc="durations"):
        motion = solve(planner, random_problem(TIMED, seed))
        if motion is None:
            continue
        trajectory = motion.trajectory
        q = np.stack([path.q for path in motion.paths])
        whole.append(trajectory.duration)
        moving.append(sum(i.end - i.start for i in trajectory.intervals if not i.gripping))
        stretched.append(sum(stretched_duration(path, limits) for path in q))
        if peers is not None:
            ratios.append(moving[-1] / peers.toppra(q, limits, GRID))
        broken.append(broken_limits(planner, motion))
        jerky.append(jerk(motion))
    name, done = f"{TIMED} moves", len(whole)
    rows = [
        Row(name, "duration, fingers included, median", statistics.median(whole), "s", done,
            (min(whole), max(whole)), "<= 13"),
        Row(name, "of this the arm moves, median", statistics.median(moving), "s", done,
            (min(moving), max(moving))),
        Row(name, "the same if each way were only stretched in time, median",
            statistics.median(stretched), "s", done, (min(stretched), max(stretched)),
            note="the trivial way to keep limits: that of this project before"),
        Row(name, "trajectories beyond a limit of velocity or acceleration",
            sum("velocity" in b or "acceleration" in b for b in broken), "", done,
            required="== 0", note="sampled every millisecond by scipy"),
        Row(name, "trajectories that do not begin and end at rest",
            sum("rest" in b for b in broken), "", done,
            required="== 0"),
        Row(name, "trajectories beyond the Panda's limit of jerk",
            sum("jerk" in b for b in broken), "", done, required="== 0",
            note=f"acceleration's changes within a millisecond; at most {max(jerky):.2f} of it"),
    ]  # fmt: skip
    if ratios:
        rows.append(
            Row(name, "duration of the ways as a multiple of TOPP-RA's, median",
                statistics.median(ratios), "", done, (min(ratios), max(ratios)), "<= 1.03",
                note="the same paths and limits, its grid of 225 points; its accelerations jump, "
                "ours do not")
        )  # fmt: skip
    return rows


def joint_rows(planner: MotionPlanner, count: int) -> list[Row]:
    """What is lost by solving the path problem phase by phase, between the switches of P2."""
    rows, every = list[Row](), list[Gap]()
    for moves in UNDIVIDED:
        planner.undivided(len(BASES)).problem(2 * moves + 1)
        finish()
        found = list[Gap]()
        for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc=f"{moves} moves, undivided"):
            motion = solve(planner, random_problem(moves, seed))
            if motion is not None:
                rng = np.random.default_rng([seed, 2])
                found.append(gap_to_joint(planner, motion, STARTS, rng))
        every += found
        name = f"{moves} moves" if moves > 1 else "1 move"
        rows += _gap_rows(name, found, "<= 0.03")
    worst = max(gap.cost for gap in every)
    return [
        *rows,
        Row("all of these", "cost above that of the joint problem, worst", worst, "", len(every),
            required="<= 0.03", note="the joint problem from the best of several starting points"),
        Row("all of these", "plans whose cost is more than 3 % above that of the joint problem",
            sum(gap.cost > 0.03 for gap in every), "", len(every)),
    ]  # fmt: skip


def _gap_rows(name: str, found: Sequence[Gap], required: str) -> list[Row]:
    costs, durations = [gap.cost for gap in found], [gap.duration for gap in found]
    return [
        Row(name, "cost above that of the joint problem, median", statistics.median(costs), "",
            len(costs), (min(costs), max(costs)), required,
            note=f"all phases and switches at once, the best of {STARTS} starting points and ours"),
        Row(name, "duration above that of the joint problem, median",
            statistics.median(durations), "", len(durations), (min(durations), max(durations)),
            note="of the paths that cost least, timed alike; fingers included"),
    ]  # fmt: skip


def correction_rows(planner: MotionPlanner, count: int) -> list[Row]:
    """How long it takes to correct a motion under way for the next block, which was shifted."""
    next_switch, whole, refused, jumps = list[float](), list[float](), 0, 0.0
    for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc="corrections"):
        problem = random_problem(CORRECTED, seed)
        motion = solve(planner, problem)
        if motion is None:
            continue
        rng = np.random.default_rng([seed, 1])
        picks = [phase for phase in motion.phases if phase.kind == PICK]
        first = {phase.object_name: phase for phase in reversed(picks)}
        ways = [i for i in motion.trajectory.intervals if i.phase in first.values()]
        ways = [way for way in ways if not way.gripping]
        way = ways[rng.integers(len(ways))]
        at = way.start + float(rng.uniform(0.0, LATEST)) * (way.end - way.start)
        turn = rng.uniform(-np.pi, np.pi)
        step = SHIFT * np.array([np.cos(turn), np.sin(turn)])
        graph = shifted(problem.graph, way.phase.object_name, step)
        try:
            for seconds, to_next_switch in ((next_switch, True), (whole, False)):
                begin = time.process_time()
                found = corrected(planner, motion, at, graph, problem.moves, to_next_switch)
                seconds.append(time.process_time() - begin)
        except InfeasibleError:
            refused += 1
            continue
        _, before = motion.trajectory.sample(at)
        _, after = found.trajectory.sample(0.0)
        jumps = max(jumps, float(np.abs(after.arm - before.arm).max()))
    name = f"{1000 * SHIFT:.0f} mm shift of the next block"
    return [
        Row(name, "time to correct the way to it, median", statistics.median(next_switch), "s",
            len(next_switch), (min(next_switch), max(next_switch)), "<= 0.02",
            note="of the processor; from the state of motion, warm started, timed"),
        Row(name, "time to correct all that is left, median", statistics.median(whole), "s",
            len(whole), (min(whole), max(whole)),
            note=f"of the processor; of {CORRECTED} moves"),
        Row(name, "not corrected without a stop", refused, "", count,
            note=f"in the first {LATEST:.0%} of a way to a block, at random"),
        Row(name, "largest jump of a joint's velocity", jumps, "rad/s", len(whole),
            required="<= 1e-6"),
    ]  # fmt: skip


def shifted(graph: SceneGraph, name: str, step: Array) -> SceneGraph:
    """A block, and what stands on it, a little elsewhere."""
    stack = next(own for own in graph.stacks() if name in own)
    names = stack[stack.index(name) :]

    def moved(item: SceneObject) -> SceneObject:
        x, y, z = item.position_world
        there = (x + float(step[0]), y + float(step[1]), z)
        return replace(item, position_world=there) if item.name in names else item

    return replace(graph, objects=tuple(map(moved, graph.objects)))


def stretched_duration(q: Array, limits: JointLimits) -> float:
    """Of one path whose steps all take the same time, as little as the limits allow [s]."""
    spline = CubicSpline(np.linspace(0.0, 1.0, len(q)), q, bc_type="clamped")
    dense = np.linspace(0.0, 1.0, 1000)
    speed = (np.abs(spline(dense, 1)).max(axis=0) / limits.velocity).max()
    acceleration = (np.abs(spline(dense, 2)).max(axis=0) / limits.acceleration).max()
    return float(max(speed, np.sqrt(acceleration)))


def sampled(motion: Motion) -> tuple[Array, Array]:
    """Velocities and accelerations of the arm as a controller interpolates them, densely."""
    trajectory = motion.trajectory
    cubic = CubicHermiteSpline(
        trajectory.times, trajectory.positions.arm, trajectory.velocities.arm
    )
    times = np.append(np.arange(0.0, trajectory.duration, SAMPLING), trajectory.duration)
    return cubic(times, 1), cubic(times, 2)


def limits_of(planner: MotionPlanner) -> JointLimits:
    """Those that trajectories are timed for."""
    settings = planner.timing
    return JointLimits(
        settings.velocity_scale * planner.limits.velocity,
        settings.acceleration_scale * planner.limits.acceleration,
    )


def jerk(motion: Motion) -> float:
    """Largest change of acceleration within a sample, as a share of what the Panda may."""
    _, accelerations = sampled(motion)
    return float((np.abs(np.diff(accelerations, axis=0)).max(axis=0) / SAMPLING / JERK).max())


def broken_limits(planner: MotionPlanner, motion: Motion) -> list[str]:
    """Of velocity, acceleration, jerk and rest at both ends, what a trajectory does not keep."""
    limits, (speeds, accelerations) = limits_of(planner), sampled(motion)
    kept = {
        "velocity": (np.abs(speeds) <= limits.velocity * (1 + 1e-6)).all(),
        "acceleration": (np.abs(accelerations) <= limits.acceleration * (1 + 1e-6)).all(),
        "jerk": jerk(motion) <= 1,
        "rest": np.abs(speeds[[0, -1]]).max() <= 1e-9,
    }
    return [name for name, holds in kept.items() if not holds]


def graph_rows(planner: MotionPlanner, count: int) -> list[Row]:
    """What a running node takes longer, whose arm tells its joints all the while."""
    rows = list[Row]()
    with MotionInGraph() as running:
        for moves, *_ in LENGTHS:
            running.seconds(f"first of {moves}", *_asked(random_problem(moves, 0)))
            ours, ratios = list[float](), list[float]()
            for seed in tqdm(range(FIRST_SEED, FIRST_SEED + count), desc=f"{moves}, in the graph"):
                problem = random_problem(moves, seed)
                seconds = running.seconds(f"{moves} from {seed}", *_asked(problem))
                running.quiet = True
                alone = solve(planner, problem)
                running.quiet = False
                if alone is not None:
                    ours.append(seconds)
                    ratios.append(seconds / alone.seconds)
            name = f"{moves} moves" if moves > 1 else "1 move"
            rows += [
                Row(name, "time to find the motion in the running graph, median",
                    statistics.median(ours), "s", len(ours), (min(ours), max(ours)),
                    note=f"joint states {1.0 / PERIOD:.0f} times a second"),
                Row(name, "of this to the time alone, median", statistics.median(ratios), "",
                    len(ratios), (min(ratios), max(ratios)), "<= 1.3", note="in turns"),
            ]  # fmt: skip
    return rows


def _asked(problem: Problem) -> tuple[SceneGraph, list[Move]]:
    return problem.graph, problem.moves


def prepared_planner(lengths: Sequence[int]) -> MotionPlanner:
    """With its problems built, as a node that has been running has them."""
    urdf = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    planner = MotionPlanner(urdf.read_text())
    for moves in lengths:
        planner.prepare(len(BASES), moves)
    finish()
    for moves in lengths:
        solve(planner, random_problem(moves, 0))
    return planner


def main() -> None:
    """Measures, prints and writes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", type=Path, help="virtual environment with robotic and toppra")
    arguments = parser.parse_args()
    try:
        peers = Peers(arguments.peers) if arguments.peers else None
    except FileNotFoundError as error:
        parser.error(str(error))
    start, count = time.perf_counter(), 5 if quick() else 50
    try:
        planner = prepared_planner([moves for moves, *_ in LENGTHS])
        rows = time_rows(planner, peers, count) + duration_rows(planner, peers, count)
        rows += joint_rows(planner, count)
        rows += correction_rows(planner, count) + graph_rows(planner, count)
    finally:
        if peers is not None:
            peers.close()
    if peers is None:
        print("rai and TOPP-RA are left out; PEERS=FOLDER names an environment with both")
    print_rows(rows)
    path = write_result("motion", "make bench-motion PEERS=/path/to/venv", rows,
                        time.perf_counter() - start)  # fmt: skip
    print(f"written to {path}")


if __name__ == "__main__":
    main()
