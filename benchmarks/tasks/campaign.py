# SPDX-License-Identifier: Apache-2.0
"""Runs the tasks of a campaign one after the other; each has its record from when it begins."""

from __future__ import annotations

import json
import shutil
import sys
import time
import traceback
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, Final

import yaml
from faults.askers import answer_from_result
from tqdm import tqdm

from planner_node.cli.unavailable import PlannerUnavailableError
from scene_graph import GraphStatus, SceneGraph
from sim_node.layouts import format_layout
from tamp_bringup.processes import NodeDiedError
from tamp_bringup.scene_observer import SceneObserver, SimulationError
from tamp_bringup.task_runner import run_task
from tasks.draw import Task
from tasks.family import Family
from tasks.graph import START_SECONDS, Graph
from tasks.record import Records, Tally
from tasks.report import command_of, progress_text
from tasks.stopping import Stop

#: Who failed where the campaign itself has a defect.
CAMPAIGN: Final = "campaign"

Result = dict[str, Any]


@dataclass(frozen=True)
class Settings:
    """What a campaign is run with.

    Attributes:
        real_time_factor: of the simulators; 0: as fast as they go.
        share: which of the shares of JOBS this is.
        commit: of the code.
    """

    family: Family
    real_time_factor: float
    share: int = 0
    commit: str = ""


class Campaign:
    """The tasks of a campaign, or a share of them.

    Args:
        draw: the task of a seed.
    """

    def __init__(
        self, settings: Settings, records: Records, stop: Stop, draw: Callable[[int], Task]
    ) -> None:
        self._settings, self._records, self._stop = settings, records, stop
        self._draw = draw
        self._stack = ExitStack()
        self._shared: Graph | None = None

    def run(self, seeds: Sequence[int], all_seeds: Sequence[int] | None = None) -> None:
        """Runs those tasks that have not begun yet, and leaves a record of each.

        Args:
            all_seeds: those of all shares, for the running share of successes.

        Raises:
            KeyboardInterrupt: the operator stopped it; a task that ran then has its record.
            NodeDiedError, SimulationError: the graph does not start; no task had begun then.
        """
        settings, records = self._settings, self._records
        left = [seed for seed in seeds if not records.has_begun(seed)]
        tally, counted = Tally(records), all_seeds or seeds
        with (
            self._stack,
            tqdm(total=len(seeds), initial=len(seeds) - len(left), unit="task",
                 position=settings.share) as progress,
        ):  # fmt: skip
            for seed in left:
                progress.set_postfix_str(progress_text(*tally.count(counted)))
                self._run_one(self._draw(seed))
                progress.set_postfix_str(progress_text(*tally.count(counted)), refresh=False)
                progress.update()
                content = records.read(seed)
                if failure := content["failure"]:
                    command = command_of(settings.family, seed, settings.real_time_factor)
                    module = failure["module"] or "unknown"
                    _say(f"seed {seed}: failed in {module}: {failure['reason']}")
                    _say(f"    again: {command}    kept: {records.kept(seed)}")
                self._stop.check()

    def _run_one(self, task: Task) -> None:
        if not self._has_own_graph(task) and self._shared is None:
            self._shared = self._stack.enter_context(
                self._graph(task, f"logs_{self._settings.share}")
            )
        records, seed = self._records, task.seed
        with self._stop.task():
            records.begin(
                seed,
                {
                    "task": task.to_json(),
                    "drawn": dict(task.drawn),
                    "commit": self._settings.commit,
                    "began": datetime.now(timezone.utc).isoformat(timespec="seconds"),
                },
            )
            try:
                result = self._result(task)
            except KeyboardInterrupt:
                records.interrupt(seed)
                raise
            records.end(seed, result)
        if not result["success"] and self._shared:
            # The next task shall not suffer from what is left of this one.
            self._stack.close()
            self._shared = None

    def _result(self, task: Task) -> Result:
        """What became of a task; never raises but KeyboardInterrupt."""
        kept = self._records.kept(task.seed)
        shutil.rmtree(kept, ignore_errors=True)
        try:
            if self._shared:
                return self._on_shared_graph(self._shared, task)
            with self._graph(task, f"{task.seed}/logs") as graph:
                result = measure(graph, task)
            if result["success"]:
                shutil.rmtree(kept / "logs")
            return result
        except NodeDiedError as error:
            return _failed(error.node.removesuffix("_node"), str(error))
        except SimulationError as error:
            return _failed("sim", str(error))
        except Exception:  # a defect of the campaign: say so and go on
            return _failed(CAMPAIGN, traceback.format_exc(limit=-3))

    def _on_shared_graph(self, graph: Graph, task: Task) -> Result:
        """Runs a task; where it fails, its part of the nodes' logs is kept."""
        sizes, result = graph.log_sizes(), None
        try:
            result = measure(graph, task)
        finally:
            if result is None or not result["success"]:
                kept = self._records.kept(task.seed)
                graph.keep_logs(kept / "logs", sizes)
                write_parameters(self._parameters(task), kept)
        return result

    def _has_own_graph(self, task: Task) -> bool:
        return task.scene is not None or bool(task.parameters)

    def _graph(self, task: Task, logs: str) -> Graph:
        parameters = self._parameters(task)
        if self._has_own_graph(task):
            write_parameters(parameters, self._records.kept(task.seed))
        return Graph(self._records.folder / logs, parameters)

    def _parameters(self, task: Task) -> dict[str, dict[str, Any]]:
        """Those of the nodes; writes the scene file that they name."""
        parameters: dict[str, dict[str, Any]] = defaultdict(dict)
        for node, values in task.parameters.items():
            parameters[node] |= values
        simulator = parameters["sim_node"]
        simulator["real_time_factor"] = self._settings.real_time_factor
        if task.scene is not None:
            simulator["scene"] = str(write_scene(task, self._records.kept(task.seed)))
            simulator["layout"] = format_layout(task.layout)
            simulator["seed"] = task.seed
        return dict(parameters)


def write_scene(task: Task, folder: Path) -> Path:
    """The task's scene file, with its absolute path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = (folder / "scene.yaml").resolve()
    head = f"# Task {task.seed} of the family {task.family}.\n"
    path.write_text(head + yaml.safe_dump(dict(task.scene or {}), sort_keys=False))
    return path


def write_parameters(parameters: Mapping[str, Any], folder: Path) -> None:
    """The nodes' parameters, by node, beside what else is kept of a task."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "parameters.json").write_text(json.dumps(parameters, indent=1))


def measure(graph: Graph, task: Task) -> Result:
    """Runs a task on a graph: from the reset of the scene to the judgement.

    Raises:
        SimulationError: the simulator refuses the task's layout, or does not answer.
        KeyboardInterrupt: after the running goal was cancelled and the arm rests.
    """
    observer = graph.observer
    begun = time.monotonic()
    initial = observer.reset(task.seed, layout=task.layout, timeout=START_SECONDS)
    observer.graph_times.clear()
    if task.disturbance:
        disturb(task.disturbance)
    wall, simulated = time.monotonic(), observer.simulated_seconds
    result = run_task(
        graph.planner, observer, initial, task.goal, check_alive=graph.processes.check
    ).to_json()
    ended = time.monotonic()
    simulated = observer.simulated_seconds - simulated
    return result | {
        "wall_seconds": round(ended - begun, 4),
        "simulated_seconds": round(simulated, 4),
        "real_time_factor": round(simulated / (ended - wall), 4),
        **frames_of(observer),
        "truth_before": poses(initial),
        "truth_after": poses(observer.truth),
        "answer": _answer(graph),
    }


def disturb(request: Mapping[str, Any]) -> None:
    """Asks the simulator to let something go wrong; raises SimulationError if it refuses."""
    from tamp_interfaces.srv import Disturb

    from sim_node.cli.client import DisturbClient, SimulatorUnavailableError

    with DisturbClient() as simulator:
        try:
            answer = simulator.disturb(Disturb.Request(**request), timeout=START_SECONDS)
        except SimulatorUnavailableError as error:
            raise SimulationError(str(error)) from error
    if not answer.success:
        raise SimulationError(f"the disturbance was refused: {answer.message}")


def frames_of(observer: SceneObserver) -> dict[str, Any]:
    """Image → graph times by what the graphs were worth [s]."""
    confident: list[float] = []
    others: dict[str, list[float]] = defaultdict(list)
    for status, seconds in list(observer.graph_times):
        rounded = round(seconds, 6)
        if status == GraphStatus.CONFIDENT:
            confident.append(rounded)
        else:
            others[_status_name(status)].append(rounded)
    return {"graph_seconds": confident, "other_graph_seconds": dict(others)}


def poses(truth: SceneGraph | None) -> list[dict[str, Any]]:
    """Where the blocks are in the ground truth."""
    return [
        {
            "name": item.name,
            "position_world": list(item.position_world),
            "quaternion_world": list(item.quaternion_world),
            "size": list(item.size),
        }
        for item in (truth.objects if truth else ())
    ]


def _answer(graph: Graph) -> Mapping[str, Any] | None:
    """What the planner said, in full; None if it never answered."""
    with suppress(PlannerUnavailableError, TimeoutError, RuntimeError):
        return vars(answer_from_result(graph.planner.result(timeout=0.5)))
    return None


def _say(sentence: str) -> None:
    """Above the progress bar, at once."""
    tqdm.write(sentence, file=sys.stderr)


def _failed(module: str, reason: str) -> Result:
    return {"success": False, "failure": {"module": module, "reason": reason}}


def _status_name(status: int) -> str:
    with suppress(ValueError):
        return GraphStatus(status).name
    return f"STATUS_{status}"
