# SPDX-License-Identifier: Apache-2.0
"""``make soak-tests RUNS=10``: the whole suite again and again, half of the runs on a busy machine.

Stops cleanly on Ctrl-C; the runs that were finished are kept in runs/suite, and RESUME=1 goes on
from there if the code is still the same. Logs and JUnit files lie beside them.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from results_file import print_rows, quick, source_commit, write_result
from suite_report import FailedTest, SuiteRun, make_rows, read_junit, read_run
from tamp_runtime.executable import listen_to_interrupts
from tqdm import tqdm

FOLDER: Final = Path("runs/suite")
#: Computes for nothing for as long as its parent lives.
BUSY_LOOP: Final = """
import os
parent = os.getppid()
while os.getppid() == parent:
    for _ in range(1_000_000):
        pass
"""
#: How long pytest and its workers may take to tidy up after Ctrl-C [s].
STOP_TIMEOUT: Final = 60.0


@contextlib.contextmanager
def busy_loops(count: int) -> Iterator[None]:
    """Processes that compute for nothing while the block runs."""
    loops = [subprocess.Popen([sys.executable, "-c", BUSY_LOOP]) for _ in range(count)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def command_of(only: list[str], junit: Path) -> list[str]:
    """``make test``, or pytest on single tests."""
    arguments = [f"--junitxml={junit}", "-o", "junit_family=xunit1"]
    if only:
        return ["pytest", *only, *arguments]
    return ["make", "test", f"ARGS={' '.join(arguments)}"]


def run_command(command: list[str], log: Path) -> int:
    """Runs a command with its output in a file; Ctrl-C ends it, and all that it started, first."""
    # A make that this one was started by passes on its variables.
    environment = {name: value for name, value in os.environ.items() if "MAKE" not in name}
    environment.pop("MFLAGS", None)
    with log.open("w") as output:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env=environment,
            start_new_session=True,
        )
    try:
        return process.wait()
    except BaseException:
        for number in (signal.SIGINT, signal.SIGKILL):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(STOP_TIMEOUT)
                break
        raise


def run_suite(number: int, only: list[str], folder: Path) -> SuiteRun:
    """One run; odd ones share the machine with a busy loop for each core."""
    loaded = number % 2 == 1
    junit, log = folder / f"run_{number:02d}.xml", folder / f"run_{number:02d}.log"
    junit.unlink(missing_ok=True)
    started, commit = time.monotonic(), source_commit()
    with busy_loops(len(os.sched_getaffinity(0)) if loaded else 0):
        code = run_command(command_of(only, junit.resolve()), log)
    seconds = time.monotonic() - started
    tests, failures = read_junit(junit) if junit.exists() else (0, ())
    if code != 0 and not failures:  # pytest itself went down
        failures = (FailedTest("", f"ended with exit code {code}, see {log}"),)
    return SuiteRun(number, loaded, commit, round(seconds, 1), tests, failures)


def run_campaign(options: argparse.Namespace, folder: Path) -> list[SuiteRun]:
    """The runs of the campaign, those that are in ``folder`` already included."""
    runs: list[SuiteRun] = []
    progress = tqdm(range(options.runs), unit="run", disable=None)
    for number in progress:
        path = folder / f"run_{number:02d}.json"
        if not path.exists() or read_run(path).commit != source_commit():
            run_suite(number, options.only, folder).write(path)
        run = read_run(path)
        runs.append(run)
        how = "busy machine" if run.loaded else "quiet machine"
        tqdm.write(
            f"run {number + 1} of {options.runs}, {how}: {len(run.failures)} of {run.tests} "
            f"failed, {run.seconds:.0f} s"
        )
        for failure in run.failures:
            tqdm.write(f"  {failure.test}: {failure.message.splitlines()[:1]}")
            tqdm.write(f"    again: {failure.again}")
    return runs


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10, help="runs of the suite")
    parser.add_argument("--resume", action="store_true", help="keep the runs done so far")
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="TEST", help="these tests; nothing is published"
    )
    options = parser.parse_args()
    listen_to_interrupts()  # also in the background of a script
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if quick():
        options.runs, options.only = 2, options.only or ["tests/unit/tamp_runtime"]
    folder = FOLDER / "only" if options.only else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    if not options.resume:
        for old in folder.glob("run_*"):
            old.unlink()
    try:
        runs = run_campaign(options, folder)
    except KeyboardInterrupt:
        print("\nstopped; RESUME=1 goes on with the runs that are left")
        return 130
    rows = make_rows(runs)
    print_rows(rows)
    if not options.only or quick():
        details = {
            "runs": [
                {"loaded": run.loaded, "seconds": run.seconds, "tests": run.tests,
                 "failures": [{"test": f.test, "message": f.message} for f in run.failures]}
                for run in runs
            ]
        }  # fmt: skip
        seconds = sum(run.seconds for run in runs)
        command = f"make soak-tests RUNS={options.runs}"
        print(f"written to {write_result('suite', command, rows, seconds, details)}")
    return int(any(run.failures for run in runs))


if __name__ == "__main__":
    sys.exit(main())
