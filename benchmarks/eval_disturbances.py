# SPDX-License-Identifier: Apache-2.0
"""``make eval-disturbances``: tasks of five blocks, disturbed at a random moment or by nobody.

Of each kind of the fault campaign's world N tasks, with the planner's ``verify`` as VERIFY=watch
says (or end,watch), and QUIET tasks that nobody disturbs, each with verify end and watch in turns.
Judged by ground truth, by what a refusal names, and by whether the arm took another block before
it was noticed. All kinds take turns, so that MINUTES=15 measures as many of each as there is time
for, and tells of these. Stops cleanly on Ctrl-C, too; RESUME=1 goes on; JOBS=2 runs graphs side by
side. KIND= and SEED= run single tasks again, which writes nothing into benchmarks/results.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import campaign
from faults.fault import Ending
from faults.moment_report import command_of, details, is_good, make_rows
from faults.random_moment import KINDS, NOTHING, MomentResult, run_at_random_moment, to_json
from faults.setting import Graph, Setting
from results_file import print_rows, quick, write_result
from tqdm import tqdm

from planner_node.settings import END, VERIFY, WATCH
from tamp_bringup.processes import NodeDiedError
from tamp_bringup.scene_observer import SimulationError

FIRST_SEED: Final = 1000
FOLDER: Final = Path("runs") / "eval_disturbances"
AGAIN: Final = FOLDER / "again"
QUICK: Final = ("swap",)
#: What a task of verify watch took on two cores, most of them carrying some nine moves out [s].
TASK_SECONDS: Final = 30.0


@dataclass(frozen=True)
class Task:
    """One task that is to be run."""

    kind: str
    verify: str
    trial: int
    seed: int
    folder: Path = FOLDER

    @property
    def path(self) -> Path:
        """Where its result is kept."""
        return self.folder / f"{self.kind}_{self.verify}_{self.seed}.json"


def plan_tasks(
    kinds: Sequence[str], verify: Sequence[str], n: int, quiet: int, seed: int | None
) -> list[Task]:
    """The tasks; those that are compared come in turns."""
    if seed is not None:
        return [Task(kind, way, 0, seed, AGAIN) for kind in kinds for way in verify]
    tasks = []
    for trial in range(max(n, quiet)):
        for kind in kinds:
            if kind != NOTHING and trial < n:
                first = FIRST_SEED + 1000 * (1 + list(KINDS).index(kind))
                tasks += [Task(kind, way, trial, first + trial) for way in verify]
        if NOTHING in kinds and trial < quiet:
            tasks += [Task(NOTHING, way, trial, FIRST_SEED + trial) for way in (END, WATCH)]
    return tasks


def run_tasks(real_time_factor: float, minutes: float, tasks: Sequence[Task], share: int) -> None:
    """Runs those whose results are not there yet; each result goes into its file.

    Args:
        minutes: after which none is begun any more; 0: all are.
    """
    until = time.monotonic() + 60.0 * minutes if minutes else float("inf")
    left = [task for task in tasks if not task.path.exists()]
    folder, done = FOLDER / f"graph{share}", len(tasks) - len(left)
    with tqdm(total=len(tasks), initial=done, unit="task", position=share) as progress:
        while left and time.monotonic() < until:
            with Graph(folder, (), real_time_factor) as setting:
                whole = True
                while left and whole and time.monotonic() < until:
                    task, *left = left
                    progress.set_postfix_str(f"{task.kind}, {task.verify}")
                    result, whole = _try(setting, task)
                    if not is_good(result):
                        tqdm.write(f"{result['ending']}: {result['message']}")
                        tqdm.write(f"    {command_of(result)}")
                    task.path.write_text(json.dumps(result, indent=1, ensure_ascii=False))
                    progress.update()


def _try(setting: Setting, task: Task) -> tuple[dict[str, Any], bool]:
    """What became of a task, and whether the graph can go on."""
    names = task.kind, task.verify, task.trial, task.seed
    try:
        return to_json(run_at_random_moment(setting, *names)), True
    except (NodeDiedError, SimulationError) as error:
        died = Ending.NODE_DIED.value
        return to_json(
            MomentResult(*names, "", happened=True, ending=died, message=str(error))
        ), False


def told_duration(tasks: Sequence[Task], options: argparse.Namespace) -> str:
    """How many tasks are to be run, and for about how long, in words."""
    left = [task for task in tasks if not (options.resume and task.path.exists())]
    minutes = len(left) * TASK_SECONDS / options.jobs / 60.0
    told = f"{len(left)} tasks of about {TASK_SECONDS:g} s: {minutes:.0f} min"
    if options.minutes and options.minutes < minutes:
        told += f"; those that can be begun within {options.minutes:g} min"
    return told


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", default="", help=f"of {', '.join((*KINDS, NOTHING))}: a,b")
    parser.add_argument("--verify", default=WATCH, help=f"of {', '.join(VERIFY)}: a,b")
    parser.add_argument("--n", type=int, default=30, help="disturbed tasks of each kind")
    parser.add_argument("--quiet", type=int, default=100, help="tasks that nobody disturbs")
    parser.add_argument("--seed", type=int, help="one task a kind with this seed")
    parser.add_argument("--real-time-factor", type=float, default=1.0)
    parser.add_argument("--minutes", type=float, default=0.0, help="begin no task after; 0: all")
    campaign.add_arguments(parser)
    options = parser.parse_args()
    options.kinds = options.kind.split(",") if options.kind else [*KINDS, NOTHING]
    options.verify = options.verify.split(",")
    for given, known in ((options.kinds, (*KINDS, NOTHING)), (options.verify, VERIFY)):
        if unknown := [name for name in given if name not in known]:
            parser.error(f"there is no {', '.join(unknown)}; there are {', '.join(known)}")
    if quick():
        options.n, options.quiet = min(options.n, 1), min(options.quiet, 1)
        options.kinds = [*QUICK, NOTHING] if not options.kind else options.kinds
    return options


def main() -> int:
    options = parse_arguments()
    tasks = plan_tasks(options.kinds, options.verify, options.n, options.quiet, options.seed)
    single = bool(options.kind or options.seed is not None)
    started = time.monotonic()
    if options.share is None and not options.report:
        print(told_duration(tasks, options), flush=True)
    run = partial(run_tasks, options.real_time_factor, options.minutes)
    records = campaign.run_campaign(tasks, options, run)
    if isinstance(records, int):
        return records
    rows = make_rows(records)
    print_rows(rows)
    if single:
        for record in records:
            print(json.dumps(record, indent=1, ensure_ascii=False))
        return 0
    command = (
        f"make eval-disturbances VERIFY={','.join(options.verify)} N={options.n} "
        f"QUIET={options.quiet} RTF={options.real_time_factor:g}"
        + (f" MINUTES={options.minutes:g}" if options.minutes else "")
        + (f" JOBS={options.jobs}" if options.jobs > 1 else "")
    )
    seconds = sum(record["wall_seconds"] for record in records) / options.jobs
    path = write_result(
        "disturbances", command, rows, max(seconds, time.monotonic() - started), details(records)
    )
    print(f"written to {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
