# SPDX-License-Identifier: Apache-2.0
"""``make eval-replay N=100 BLOCKS=6``: executed tasks carried out once more in MuJoCo.

Each task of ``make eval-tasks`` is executed in pybullet, and what the arm's controller was
commanded is recorded; MuJoCo then gets the same arm, blocks, masses and friction and the same
commands. What holds in one physics engine only is luck.

SOURCE=graph (default) executes with the four running nodes; SOURCE=process with planners,
simulator and controller in one process: quicker, and the same every time. RESUME=1 keeps what was
recorded and judged before; SEED=1007 judges one task's recording again, after executing the task
where there is none, and says all about it.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import rclpy
from rclpy.signals import SignalHandlerOptions
from replay.arm_links import arm_links
from replay.carry_out import carry_out
from replay.compare import Verdict, compare
from replay.environment import EnvironmentProblem, provide_mujoco
from replay.record_in_process import record_in_process
from replay.recording import Recording, RecordingError, load_recording, without_commands
from replay.report import make_rows, verdict_details
from results_file import print_rows, quick, write_result
from tamp_runtime.node_process import prepare_process
from tqdm import tqdm

from motion_node.planner import MotionPlanner
from planner_node.cli.client import PlannerClient
from sim_node.world import World
from tamp_bringup.processes import NodeDiedError, NodeProcesses, use_own_domain
from tamp_bringup.scene_observer import SceneObserver, SimulationError

FIRST_SEED: Final = 1000
#: Tasks on which it is shown that the judge can say no, and that towers do not depend on it.
CONTROLS: Final = 10
#: What a finger presses with then [N]: friction 1.08 carries 0.4 N of a block's 0.8 N.
WEAK_FINGERS: Final = 0.2

Record = Callable[[int], Recording]


@contextmanager
def recorder_in_process(world: World, options: argparse.Namespace) -> Iterator[Record]:
    """Executes without ROS."""
    planner = MotionPlanner(world.arm.urdf.read_text(encoding="utf-8"))
    yield lambda seed: record_in_process(world, planner, seed, options.blocks)


@contextmanager
def recorder_of_graph(world: World, options: argparse.Namespace, folder: Path) -> Iterator[Record]:
    """Executes with the four nodes, which start at the first task."""
    from replay.record_graph import TopicRecorder, record_task

    use_own_domain()
    prepare_process()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    parameters = {"sim_node": {"real_time_factor": float(options.real_time_factor)}}
    try:
        with ExitStack() as stack:
            running: list[Any] = []

            def record(seed: int) -> Recording:
                if not running:
                    processes = stack.enter_context(NodeProcesses(folder / "logs", parameters))
                    observer = stack.enter_context(SceneObserver())
                    planner = stack.enter_context(PlannerClient())
                    recorder = stack.enter_context(TopicRecorder())
                    running.extend((processes, observer, planner, recorder))
                    observer.reset(0, options.blocks, timeout=60.0)
                    observer.confident_graph(timeout=60.0)
                processes, observer, planner, recorder = running
                return record_task(
                    processes, observer, planner, recorder, world, seed, options.blocks
                )

            yield record
    finally:
        rclpy.try_shutdown()


class Judge:
    """Replays recordings in MuJoCo."""

    def __init__(self, world: World) -> None:
        self._links, self._max_velocity = arm_links(world), world.max_velocity

    def verdict(self, recording: Recording, finger_force: float | None = None) -> Verdict:
        """What comes of a recording; ``finger_force``: another limit than the URDF's [N]."""
        from replay.mujoco_world import MujocoWorld

        world = MujocoWorld(recording, self._links, self._max_velocity)
        if finger_force is not None:
            world.limit_fingers(finger_force)
        return compare(recording, carry_out(recording, world))

    def unrest(self, recording: Recording) -> float:
        """How far a block moves at most while the arm is told nothing [m]."""
        from replay.mujoco_world import MujocoWorld

        still = without_commands(recording)
        world = MujocoWorld(still, self._links, self._max_velocity)
        positions = carry_out(still, world).poses[:, :, :3]
        return float(np.linalg.norm(positions - positions[0], axis=2).max())


@dataclass(frozen=True)
class Judged:
    """What is found out about one recording, kept in files beside it."""

    folder: Path
    seed: int
    recording: Recording
    judge: Judge

    def task(self) -> dict[str, Any]:
        """The verdict."""
        return self._kept("task", lambda: self.judge.verdict(self.recording).to_json())

    def still(self) -> dict[str, Any]:
        """How far blocks move by themselves."""
        return self._kept("still", lambda: {"unrest": self.judge.unrest(self.recording)})

    def weak(self) -> dict[str, Any]:
        """The verdict on a hand that cannot carry."""
        weak = WEAK_FINGERS
        return self._kept("weak", lambda: self.judge.verdict(self.recording, weak).to_json())

    def _kept(self, kind: str, find: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        file = self.folder / f"{self.seed}.{kind}.json"
        if not file.exists():
            part = file.with_suffix(".part")
            part.write_text(json.dumps(find(), indent=1))
            part.replace(file)
        return dict(json.loads(file.read_text()))


def record_all(
    options: argparse.Namespace, world: World, seeds: Sequence[int], folder: Path
) -> None:
    """Executes the tasks that are not recorded yet; a running graph would slow the judge down."""
    missing = [seed for seed in seeds if not (folder / f"{seed}.npz").exists()]
    if not missing:
        return
    source = (
        recorder_in_process(world, options)
        if options.source == "process"
        else recorder_of_graph(world, options, folder)
    )
    with source as record:
        for seed in tqdm(missing, "executing", unit="task"):
            record(seed).save(folder / f"{seed}.npz")


def judge_all(options: argparse.Namespace, folder: Path) -> dict[str, list[dict[str, Any]]]:
    """Verdicts of all tasks, and of the controls; what is in ``folder`` is not done again."""
    seeds = range(options.first_seed, options.first_seed + options.n)
    results: dict[str, list[dict[str, Any]]] = {"tasks": [], "still": [], "weak": []}
    with World() as world:
        record_all(options, world, seeds, folder)
        judge = Judge(world)
        progress = tqdm(seeds, "judging", unit="task")
        for seed in progress:
            judged = Judged(folder, seed, load_recording(folder / f"{seed}.npz"), judge)
            results["tasks"].append(judged.task())
            if len(results["still"]) < options.controls:
                results["still"].append(judged.still())
                results["weak"].append(judged.weak())
            same = sum(item["same"] for item in results["tasks"])
            progress.set_postfix_str(f"{same}/{len(results['tasks'])} the same")
            if sentence := results["tasks"][-1]["sentence"]:
                tqdm.write(f"seed {seed}: {sentence}")
    return results


def parse_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, default=100, help="number of tasks")
    parser.add_argument(
        "--blocks", type=int, default=6, choices=range(3, 8), help="blocks in each task"
    )
    parser.add_argument("--source", choices=("graph", "process"), default="graph")
    parser.add_argument("--real-time-factor", type=float, default=1.0)
    parser.add_argument("--resume", action="store_true", help="keep what was done so far")
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED, help="below 1000: to develop")
    parser.add_argument("--seed", type=int, help="one task again; nothing is published")
    options = parser.parse_args()
    if options.n < 1:
        parser.error(f"--n {options.n}: at least one task is needed")
    options.controls = CONTROLS
    if quick():
        options.n, options.controls = min(options.n, 2), 1
    if options.seed is not None:
        options.first_seed, options.n, options.controls = options.seed, 1, 0
    return options


def mujoco_version() -> str:
    """Of the engine that judged."""
    import mujoco

    return str(mujoco.__version__)


def main() -> int:
    options = parse_options()
    folder = Path("runs") / f"eval_replay_{options.blocks}_{options.source}"
    folder.mkdir(parents=True, exist_ok=True)
    forgotten = [*folder.glob("*.npz"), *folder.glob("*.json")]
    if options.seed is not None:
        forgotten = [folder / f"{options.seed}.task.json"]
    for old in () if options.resume else forgotten:
        old.unlink(missing_ok=True)
    started = time.monotonic()
    # Where a script put this into the background, SIGINT is ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        provide_mujoco()
        results = judge_all(options, folder)
    except KeyboardInterrupt:
        print("\nstopped; RESUME=1 goes on with the tasks that are left")
        return 130
    except (EnvironmentProblem, NodeDiedError, RecordingError, SimulationError) as error:
        print(f"\n{error}", file=sys.stderr)
        return 1
    if options.seed is not None:
        print(json.dumps(results["tasks"][0], indent=1))
        return 0
    command = f"make eval-replay N={options.n} BLOCKS={options.blocks} SOURCE={options.source}"
    if options.source == "graph":
        command += f" RTF={options.real_time_factor:g}"
    rows = make_rows(results, options.blocks, options.source)
    print_rows(rows)
    if options.first_seed != FIRST_SEED:
        print(f"seeds from {options.first_seed} on are for developing: nothing is published")
        return 0
    name = "replay" if options.blocks == 6 else f"replay_{options.blocks}"
    again = f"make eval-replay SEED={{seed}} BLOCKS={options.blocks} SOURCE={options.source}"
    details = {"mujoco": mujoco_version(), **verdict_details(results["tasks"], again)}
    path = write_result(name, command, rows, time.monotonic() - started, details)
    print(f"written to {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
