# SPDX-License-Identifier: Apache-2.0
"""``make bench-execution``: random moves and stops in the simulator's world, without nodes.

The executive carries them out as in the node; blocks are held by friction alone. Single moves onto
towers of all heights: where the block ends, and what touched what by the physics' contacts. Plans
of three moves that are stopped at random moments: when the arm rests, and whether all blocks stand
where the report says. Blocks are where the physics says: perception has benchmarks of its own.
Seeds from 1000; each case leaves a file in ``runs/execution``, so that a run can be taken up again.
Writes ``benchmarks/results/execution.json``.
"""

from __future__ import annotations

import statistics
import time
from pathlib import Path
from typing import Any, Final

import numpy as np
import pybullet_data
from kept_results import FIRST_SEED, kept, options
from motion_scenes import random_moves
from results_file import Row, print_rows, write_result
from tamp_runtime.motion_report import ArmPlace, MotionState
from tqdm import tqdm
from watched_world import Stop, carry_out, tilt

from motion_node.planner import MotionPlanner
from scene_graph import Move, Stacks, apply_move
from sim_node.ground_truth import true_scene_graph
from sim_node.layouts import random_layout
from sim_node.world import World

#: A block that was moved makes towers of 1 to so many.
HIGHEST: Final = 7
#: Blocks and moves of plans that are stopped.
BLOCKS: Final = 6
MOVES: Final = 3
#: A block is upright up to this tilt [deg], and placed up to this distance [mm].
UPRIGHT: Final = 2.0
PLACED: Final = 4.0
REST: Final = 0.5
FOLDER: Final = "execution"


class Bench:
    """A world and a planner."""

    def __init__(self) -> None:
        urdf = (Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf").read_text()
        self._planner = MotionPlanner(urdf)
        for moves in (1, MOVES):
            self._planner.prepare(3, moves)

    def move(self, seed: int) -> dict[str, Any]:
        """One move onto a tower that is as high as the seed says afterwards."""
        rng, height = np.random.default_rng([seed, 5]), 1 + seed % HIGHEST
        with World() as world:
            layout, move = _move_onto(height, rng)
            world.reset(layout, seed)
            name = layout[move.source][-1]
            report, touched = carry_out(world, self._planner, true_scene_graph(world), [move])
            x, y, z = world.block_pose(name)[0]
            place = world.config.stack_positions[move.target]
            edge = world.block(name).size[2]
            wanted = (*place[:2], (height - 0.5) * edge)
            stacks = true_scene_graph(world).stacks()
            return {
                "seed": seed,
                "height": height,
                "state": report.state.name,
                "message": report.message,
                "away": 1000 * float(np.linalg.norm(np.subtract((x, y, z), wanted))),
                "tilt": tilt(world, name),
                "stands": stacks == apply_move(layout, move),
                "touched": sorted(touched),
            }

    def stopped(self, seed: int) -> dict[str, Any]:
        """A plan that is stopped at a random moment."""
        rng = np.random.default_rng([seed, 6])
        with World() as world:
            world.reset(random_layout(seed, BLOCKS), seed)
            graph = true_scene_graph(world)
            moves = random_moves(graph, MOVES, rng)
            home, fingers = self._planner.model.home, np.full(2, 0.04)
            duration = self._planner.solve(graph, moves, home, fingers).trajectory.duration
            stop = Stop(float(rng.uniform(0.0, duration)))
            report, touched = carry_out(world, self._planner, graph, moves, stop)
            wanted = graph.stacks()
            for move in moves[: report.moves_done]:
                wanted = apply_move(wanted, move)
            return {
                "seed": seed,
                "after": stop.after,
                "state": report.state.name,
                "message": report.message,
                "home": report.arm is ArmPlace.HOME and not report.held,
                "rest": stop.rested - stop.asked,
                "stands": true_scene_graph(world).stacks() == wanted,
                "tilt": max(tilt(world, name) for name in world.names),
                "touched": sorted(touched),
            }


def _move_onto(height: int, rng: np.random.Generator) -> tuple[Stacks, Move]:
    """A layout and a move of it that makes a tower of a height."""
    names = [name for stack in random_layout(int(rng.integers(1 << 30)), HIGHEST) for name in stack]
    blocks = int(rng.integers(height, HIGHEST + 1))
    source, target, other = (int(index) for index in rng.permutation(3))
    under = int(rng.integers(0, blocks - height + 1))
    shares = {target: height - 1, source: 1 + under, other: blocks - height - under}
    left = iter(names)
    layout = tuple(tuple(next(left) for _ in range(shares[index])) for index in range(3))
    return layout, Move(source, target)


def move_rows(found: list[dict[str, Any]]) -> list[Row]:
    """Of single moves."""
    away, n = [item["away"] for item in found], len(found)
    tilts = [item["tilt"] for item in found]
    placed = sum(
        item["state"] == MotionState.SUCCEEDED.name
        and item["stands"]
        and item["away"] <= PLACED
        and item["tilt"] <= UPRIGHT
        for item in found
    )
    name = "random moves, towers 1 to 7 high"
    return [
        Row(name, "placed within 4 mm and upright", placed, "", n, required=f"== {n}",
            note=f"in the simulator, of where the place and the tower's height say; upright: less "
            f"than {UPRIGHT:g} deg; at most {max(tilts):.2f} deg"),
        Row(name, "distance of a block from its place, median", statistics.median(away), "mm", n,
            (min(away), max(away))),
        Row(name, "in which anything touched but the fingers their block",
            sum(bool(item["touched"]) for item in found), "", n, required="== 0",
            note="by the physics' contacts in each of its steps; a held block may touch what it "
            "is taken off and put on"),
    ]  # fmt: skip


def stop_rows(found: list[dict[str, Any]]) -> list[Row]:
    """Of plans that were stopped."""
    name, n = "stopped at random moments", len(found)
    # An arm that never came to rest counts, and so does one that was never asked.
    rests = [item["rest"] if item["rest"] < np.inf else np.inf for item in found]
    dropped = [
        item for item in found if not (item["stands"] and item["home"] and item["tilt"] < UPRIGHT)
    ]
    return [
        Row(name, "time until the arm rests, longest", max(rests), "s", len(rests),
            (min(rests), max(rests)), f"<= {REST}",
            note="simulated; from the request until no joint is faster than 0.02 rad/s"),
        Row(name, "time until the arm rests, median", statistics.median(rests), "s", len(rests),
            (min(rests), max(rests))),
        Row(name, "in which a block fell, or stays in the hand", len(dropped), "", n,
            required="== 0",
            note="every block stands upright where the report's number of moves done says, and the "
            "arm is at home with an empty hand"),
        Row(name, "in which anything touched but the fingers their block",
            sum(bool(item["touched"]) for item in found), "", n),
    ]  # fmt: skip


def main() -> None:
    """Measures, prints and writes."""
    arguments = options(__doc__, 200, 14)
    start, bench, resume = time.perf_counter(), Bench(), arguments.resume
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    moved = [
        kept(f"{FOLDER}/moves", seed, resume, bench.move) for seed in tqdm(seeds, desc="moves")
    ]
    stopped = [
        kept(f"{FOLDER}/stops", seed, resume, bench.stopped) for seed in tqdm(seeds, desc="stops")
    ]
    rows = move_rows(moved) + stop_rows(stopped)
    print_rows(rows)
    odd = [
        item
        for item in (*moved, *stopped)
        if item["touched"] or not item["stands"] or not item.get("home", True)
        or item.get("rest", 0.0) > REST or item.get("away", 0.0) > PLACED
    ]  # fmt: skip
    if arguments.seed != FIRST_SEED:
        for item in odd:
            print(item)
        return
    seconds = time.perf_counter() - start
    path = write_result("execution", "make bench-execution", rows, seconds, {"odd": odd})
    print(f"written to {path}")


if __name__ == "__main__":
    main()
