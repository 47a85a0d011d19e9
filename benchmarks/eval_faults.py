# SPDX-License-Identifier: Apache-2.0
"""``make eval-faults``: faults of every kind in every phase, and what becomes of the task.

Each trial is a small task on a running graph in a DDS domain of its own. The fault is injected by
relays between the nodes, to their processes, by clients or in the world; the answer is judged by
ground truth and by whether it names the cause; then a plain task must succeed. Stops cleanly on
Ctrl-C; RESUME=1 goes on; JOBS=3 runs three graphs side by side, which mostly wait.
ONLY=NAME (or part of one), PHASE= and SEED= run single trials again, which writes nothing into
benchmarks/results.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import traceback
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any, Final

import campaign
from faults.catalogue import CATALOGUE, UnknownFaultError, faults_named
from faults.fault import Fault, Parameters, Phase
from faults.numbered import numbered_table, tests_that_name
from faults.report import command_of, dictionary, make_rows, problems
from faults.setting import Graph, Setting
from faults.topics import groups_of
from faults.trial import TrialResult, last_lines, run_trial, to_json
from results_file import print_rows, quick, write_result
from tqdm import tqdm

from tamp_bringup.scene_observer import SimulationError

FIRST_SEED: Final = 1000
TESTS: Final = Path(__file__).resolve().parent.parent / "tests"
FOLDER: Final = Path("runs") / "eval_faults"
#: A trial that is run again by its seed leaves the campaign's results as they are.
AGAIN: Final = FOLDER / "again"
#: The kinds of a quick run: one that needs no relay, and two that share theirs.
QUICK: Final = ("cancelled", "joints-lost-2s", "trajectory-nan")


@dataclass(frozen=True)
class Task:
    """One trial that is to be run."""

    fault: Fault
    phase: Phase
    trial: int
    seed: int
    folder: Path = FOLDER

    @property
    def path(self) -> Path:
        """Where its result is kept."""
        return self.folder / f"{self.fault.name}_{self.phase.value}_{self.trial}.json"

    @property
    def graph(self) -> tuple[tuple[str, ...], Parameters]:
        """The groups of relays and the nodes' parameters that it needs."""
        return tuple(sorted(groups_of(self.fault.topics))), self.fault.parameters


def seed_of(fault: Fault, trial: int) -> int:
    """The seed of a trial: of its own for each kind, whatever else the catalogue holds."""
    return FIRST_SEED + 10 * (zlib.crc32(fault.name.encode()) % 10_000) + trial


def plan_tasks(
    faults: Iterable[Fault], trials: int, phase: Phase | None, seed: int | None
) -> list[Task]:
    """The trials in the order in which the graph is started anew least often."""
    tasks = []
    for fault in faults:
        if phase is not None and seed is not None:
            tasks.append(Task(fault, phase, 0, seed, AGAIN))
            continue
        for trial in range(trials):
            moment = fault.phase_of(trial)
            if phase is not None and moment != phase:
                continue
            if seed is None:
                tasks.append(Task(fault, moment, trial, seed_of(fault, trial)))
            else:
                tasks.append(Task(fault, moment, trial, seed, AGAIN))
    return sorted(tasks, key=lambda task: task.graph)


def run_tasks(real_time_factor: float, tasks: Sequence[Task], share: int) -> None:
    """Runs those whose results are not there yet; each result goes into its file.

    Args:
        share: which of the shares of JOBS these are; names the folder of the nodes' logs.
    """
    left = [task for task in tasks if not task.path.exists()]
    folder, done = FOLDER / f"graph{share}", len(tasks) - len(left)
    with tqdm(total=len(tasks), initial=done, unit="trial", position=share) as progress:
        for (groups, parameters), alike in groupby(left, key=lambda task: task.graph):
            waiting = list(alike)
            while waiting:
                with Graph(folder, groups, real_time_factor, parameters) as setting:
                    waiting = _until_poisoned(setting, waiting, progress)


def _until_poisoned(setting: Setting, tasks: list[Task], progress: Any) -> list[Task]:
    """Runs trials on a graph as long as it stays whole; returns those that are left."""
    while tasks:
        task, *tasks = tasks
        progress.set_postfix_str(f"{task.fault.name} in {task.phase.value}")
        result = _try(setting, task)
        bad = problems(to_json(result))
        if bad:
            result = replace(result, logs=last_lines(setting))
            tqdm.write(f"{', '.join(bad)}: {result.message or result.poisoned}")
            tqdm.write(f"    {command_of(to_json(result))}")
        task.path.write_text(json.dumps(to_json(result), indent=1, ensure_ascii=False))
        progress.update()
        if result.poisoned:
            return tasks
    return []


def _try(setting: Setting, task: Task) -> TrialResult:
    try:
        return run_trial(setting, task.fault, task.phase, task.trial, task.seed)
    except SimulationError as error:
        problem = f"the trial could not begin: {error}"
    except Exception:  # a defect of the campaign, or a node that is gone: say so and go on
        problem = traceback.format_exc(limit=-3)
    name, phase = task.fault.name, task.phase.value
    return TrialResult(
        name, phase, task.trial, task.seed, setting.goal, ending="node died", message=problem,
        poisoned=problem,
    )  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="names of faults, or parts of them: a,b,c")
    parser.add_argument("--phase", type=Phase, choices=list(Phase), help="only this phase")
    parser.add_argument("--seed", type=int, help="one trial a kind with this seed")
    parser.add_argument("--trials", type=int, default=5, help="of each kind")
    parser.add_argument("--real-time-factor", type=float, default=4.0)
    campaign.add_arguments(parser)
    options = parser.parse_args()
    try:
        faults = faults_named(options.only)
    except UnknownFaultError as error:
        parser.error(str(error))
    if quick():
        faults = tuple(fault for fault in faults if options.only or fault.name in QUICK)
        options.trials = min(options.trials, 1)
    tasks = plan_tasks(faults, options.trials, options.phase, options.seed)
    if not tasks:
        parser.error("no trial fits; which phases a fault has stands in docs/results.md")
    single = bool(options.only or options.phase or options.seed is not None)
    started = time.monotonic()
    trials = campaign.run_campaign(tasks, options, partial(run_tasks, options.real_time_factor))
    if isinstance(trials, int):
        return trials
    rows = make_rows(trials)
    bad = [trial for trial in trials if problems(trial)]
    for trial in bad:
        print(f"{', '.join(problems(trial))}: {trial['message']}\n    {command_of(trial)}")
    print_rows(rows)
    if single:
        for trial in trials:
            print(json.dumps({**trial, "logs": "…"}, indent=1, ensure_ascii=False))
        return 1 if bad else 0
    entries = dictionary(trials)
    details = {
        "kinds": len(CATALOGUE),
        "numbered": numbered_table(entries, tests_that_name(TESTS)),
        "dictionary": entries,
    }
    seconds = sum(trial["trial_seconds"] for trial in trials)
    path = write_result(
        "faults",
        f"make eval-faults TRIALS={options.trials}",
        rows,
        max(seconds, time.monotonic() - started),
        details,
    )
    print(f"written to {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
