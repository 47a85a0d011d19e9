# SPDX-License-Identifier: Apache-2.0
"""``make eval-tasks FAMILY=six N=200``: random tasks of a family, from pixels to a tower.

The four nodes run as processes; success is judged by the simulator's ground truth. Families:
three, four, five, six and seven blocks in the plain world (BLOCKS=6 means six), disturbed, and
varied, whose tasks have a scene each; varied_masks is the same with the masks of a detector.
Ctrl-C stops when the running task has ended; a second one, or a kill, interrupts it, and it counts
as failed. RESUME=1 goes on with the tasks that have not begun: nothing is run twice. JOBS=2 runs
two graphs side by side; times are then those of a busy machine. SEED= runs a task again and shows
its record; nothing goes into benchmarks/results then. What a failed task needs to be run again, and
what it left behind, is in runs/eval_tasks_NAME/SEED.
BASELINE=FOLDER times another checkout's code on the same tasks in turns.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import side_by_side
from baseline_tasks import Baseline, BaselineError, ratio_rows
from results_file import print_rows, quick, source_commit, write_result
from tamp_runtime.node_process import prepare_process
from tasks.campaign import Campaign, Settings
from tasks.draw import Task, draw_task, unknown_parameters
from tasks.family import Family, UnknownFamilyError, family_named, family_of
from tasks.record import CampaignRunsError, Records
from tasks.report import campaign_seconds, command_of, make_details, make_rows
from tasks.stopping import Stop

from tamp_bringup.processes import NodeDiedError
from tamp_bringup.scene_observer import SimulationError

FIRST_SEED: Final = 1000
#: Tasks between two changes of the code, where two are timed in turns.
TURN: Final = 5
#: Where campaigns are kept; Baseline reads those of plain families by their number of blocks.
RUNS: Final = Path("runs")
#: What is not printed of the record of a task that is run again, since it is long.
_LONG: Final = ("graph_seconds", "other_graph_seconds", "task", "truth_before", "truth_after")


class OtherTasksError(RuntimeError):
    """What has been measured is of other tasks; the sentence says what to do."""


def folder_of(family: Family) -> Path:
    """The folder of a family's campaign."""
    return RUNS / f"eval_{family.result}"


def task_of(family: Family, seed: int) -> Task:
    """The task of a seed, as the campaign had it where it is kept there, else drawn."""
    records, drawn = Records(folder_of(family)), draw_task(family, seed)
    kept = records.read(seed).get("task") if records.has_begun(seed) else None
    if kept is None or kept == as_written(drawn):
        return drawn
    print(f"task {seed} is run as it is kept in {records.path(seed)}; drawn anew it is another")
    return Task.from_json(kept)


def as_written(task: Task) -> dict[str, Any]:
    """What a record holds of a task."""
    content: dict[str, Any] = json.loads(json.dumps(task.to_json()))
    return content


def check_same_tasks(records: Records, family: Family, seeds: Sequence[int]) -> None:
    """Raises OtherTasksError if the records are of tasks that the family does not hold any more."""
    for seed in seeds:
        if records.has_begun(seed):
            kept = records.read(seed).get("task")
            if kept is not None and kept != as_written(draw_task(family, seed)):
                raise OtherTasksError(
                    f"task {seed} in {records.folder} is not what the family {family.name} has by "
                    "that seed today; begin anew without RESUME=1"
                )


def check_parameters(task: Task) -> None:
    """Raises OtherTasksError if a node would pass over what the task asks of it."""
    nodes = {*task.parameters, "sim_node"}
    known = {
        node: [spec.name for spec in import_module(f"{node}.parameters").PARAMETERS]
        for node in nodes
    }
    if unknown := unknown_parameters(task, known):
        raise OtherTasksError(
            f"the family {task.family} needs parameters that the nodes of this checkout do not "
            f"have: {', '.join(unknown)}"
        )
    if task.disturbance and find_spec("sim_node.cli") is None:
        raise OtherTasksError(f"the family {task.family} needs sim/disturb, which is not there")


def run_in_turns(
    campaign: Campaign, seeds: Sequence[int], baseline: Baseline, baseline_n: int
) -> None:
    """Runs all tasks of this code, with the first ones of the other in between."""
    for done in range(0, len(seeds), TURN):
        if done < baseline_n:
            baseline.run(min(done + TURN, baseline_n))
        campaign.run(seeds[done : done + TURN], seeds)


def parse_arguments() -> tuple[argparse.Namespace, Family]:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--family", default="", help="from which the tasks are drawn")
    parser.add_argument("--n", type=int, help="number of tasks; 20, or with --seed 1")
    parser.add_argument("--blocks", type=int, help="the plain family of so many blocks, 3 to 7")
    parser.add_argument("--seed", type=int, help="run this task, and publish nothing")
    parser.add_argument(
        "--real-time-factor", type=float, help="0: as fast as it goes; 1, in a quick run 0"
    )
    parser.add_argument("--resume", action="store_true", help="keep the tasks done so far")
    parser.add_argument("--baseline", type=Path, help="another checkout, set up, to time in turns")
    parser.add_argument("--baseline-n", type=int, default=10, help="tasks that it runs")
    side_by_side.add_arguments(parser)
    options = parser.parse_args()
    if options.family and options.blocks:
        parser.error("a family says how many blocks its tasks have: leave out BLOCKS or FAMILY")
    try:
        family = family_named(options.family) if options.family else family_of(options.blocks or 6)
    except UnknownFamilyError as error:
        parser.error(str(error))
    if options.baseline and options.jobs > 1:
        parser.error("two codes are timed in turns, not side by side: leave out JOBS")
    if options.baseline and (family.has_own_scenes or options.seed is not None):
        parser.error("another code is timed on the tasks of a plain family: leave out BASELINE")
    options.n = options.n or (20 if options.seed is None else 1)
    if min(options.n, options.jobs) < 1:
        parser.error("N and JOBS have to be 1 or more")
    if quick():
        options.n = min(options.n, 2)
    if options.real_time_factor is None:
        options.real_time_factor = 0.0 if quick() else 1.0
    return options, family


def run(
    options: argparse.Namespace, family: Family, records: Records, seeds: Sequence[int]
) -> Baseline | None:
    """Runs the tasks that have not begun; returns the other code, if there is one.

    Raises:
        KeyboardInterrupt: the operator stopped it.
    """
    single = options.seed is not None
    stop = Stop()
    settings = Settings(family, options.real_time_factor, options.share or 0, source_commit())
    draw = (
        (lambda seed: task_of(family, seed)) if single else (lambda seed: draw_task(family, seed))
    )
    campaign = Campaign(settings, records, stop, draw)
    if options.share is not None:
        stop.listen()
        campaign.run(side_by_side.share_of(seeds, options), seeds)
        return None
    with records.lock() as lock:
        if not options.resume:
            records.forget()
        elif not single:
            check_same_tasks(records, family, seeds)
        for seed in records.interrupt_all_begun():
            print(f"task {seed} was interrupted while it ran; it counts as failed")
        check_parameters(draw(seeds[0]))
        if options.jobs > 1:
            if not side_by_side.run_shares(options.jobs, [lock]):
                raise KeyboardInterrupt
            return None
        stop.listen()
        if options.baseline is None:
            campaign.run(seeds)
            return None
        baseline = Baseline(options.baseline, family.blocks[0], options.real_time_factor)
        if not options.resume:
            baseline.forget()
        run_in_turns(campaign, seeds, baseline, options.baseline_n)
        return baseline


def main() -> int:
    options, family = parse_arguments()
    single = options.seed is not None
    first = options.seed if single else FIRST_SEED
    seeds = range(first, first + options.n)
    records = Records(folder_of(family) / "again" if single else folder_of(family))
    prepare_process()
    started = time.monotonic()
    try:
        baseline = run(options, family, records, seeds)
    except KeyboardInterrupt:
        print("\nstopped; RESUME=1 goes on with the tasks that have not begun")
        return 130
    except (
        BaselineError, CampaignRunsError, NodeDiedError, OtherTasksError, SimulationError
    ) as error:  # fmt: skip
        print(f"\n{error}", file=sys.stderr)
        return 1
    if options.share is not None:
        return 0
    results = [records.read(seed) for seed in seeds]
    if single:
        return show(results, records)
    rows = make_rows(results, family, options.jobs)
    if baseline:
        rows += ratio_rows(results, baseline.results(), baseline.commit)
    command = (
        f"make eval-tasks FAMILY={family.name} N={options.n} RTF={options.real_time_factor:g}"
        + (f" JOBS={options.jobs}" if options.jobs > 1 else "")
        + (f" BASELINE=CHECKOUT_OF_{baseline.commit}" if baseline else "")
    )
    path = write_result(
        family.result,
        command,
        rows,
        campaign_seconds(results, options.jobs, time.monotonic() - started),
        make_details(results, family, options.real_time_factor),
    )
    print_rows(rows)
    for result in results:
        if not result["success"]:
            print(f"failed: {command_of(family, result['seed'], options.real_time_factor)}")
    print(f"written to {path}")
    return 0


def show(results: Sequence[dict[str, Any]], records: Records) -> int:
    """Prints what became of tasks that were run again; 1 if one of them failed."""
    for result in results:
        brief = {key: value for key, value in result.items() if key not in _LONG}
        print(json.dumps(brief, indent=1, ensure_ascii=False))
        print(f"all of it: {records.path(result['seed'])}, {records.kept(result['seed'])}")
    return int(not all(result["success"] for result in results))


if __name__ == "__main__":
    sys.exit(main())
