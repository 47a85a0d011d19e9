# SPDX-License-Identifier: Apache-2.0
"""A campaign that is stopped, interrupted or killed goes on without running anything twice."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tasks.record import INTERRUPTED, OPERATOR, Records, State

HERE = Path(__file__).resolve().parent
BENCHMARKS = HERE.parents[2] / "benchmarks"
PATIENCE = 120.0


def wait_until(what: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not what():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.01)


class Driver:
    """Campaigns of tasks 1, 2, 3, … that wait for their files."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.records = Records(folder / "records")
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, *arguments: str) -> subprocess.Popen[bytes]:
        path = os.pathsep.join([str(BENCHMARKS), os.environ.get("PYTHONPATH", "")])
        process = subprocess.Popen(
            [sys.executable, str(HERE / "campaign_driver.py"), str(self.folder), *arguments],
            env={**os.environ, "PYTHONPATH": path},
            stderr=(self.folder / "stderr").open("ab"),
            start_new_session=True,
        )
        self.processes.append(process)
        return process

    def let(self, seed: int, failure: str = "") -> None:
        """The task may end."""
        new = self.folder / "new"
        new.write_text(failure)
        new.rename(self.folder / f"go_{seed}")

    def ran(self) -> list[int]:
        path = self.folder / "ran"
        return [int(line) for line in path.read_text().split()] if path.exists() else []

    def wait_for(self, *seeds: int) -> None:
        wait_until(lambda: set(seeds) <= set(self.ran()))

    def said(self) -> str:
        return (self.folder / "stderr").read_text()

    def end(self, process: subprocess.Popen[bytes]) -> int:
        return process.wait(PATIENCE)

    def failure(self, seed: int) -> dict[str, str]:
        failure: dict[str, str] = self.records.read(seed)["failure"]
        return failure


@pytest.fixture
def driver(tmp_path: Path) -> Iterator[Driver]:
    driver = Driver(tmp_path)
    yield driver
    for process in driver.processes:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def test_each_task_has_a_record_as_soon_as_it_has_begun_and_when_it_has_ended(
    driver: Driver,
) -> None:
    process = driver.start("1", "2")
    driver.wait_for(1)
    assert driver.records.state(1) is State.BEGUN
    assert driver.records.read(1)["task"]["goal"]
    assert not driver.records.has_begun(2)
    driver.let(1)
    driver.let(2, "no way")
    assert driver.end(process) == 0
    assert driver.records.state(1) is State.ENDED and driver.records.read(1)["success"]
    assert driver.failure(2) == {"module": "motion", "reason": "no way"}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_first_ctrl_c_lets_the_task_end_and_costs_nothing(
    driver: Driver, number: signal.Signals
) -> None:
    process = driver.start("1", "2")
    driver.wait_for(1)
    process.send_signal(number)
    wait_until(lambda: "stops when this task has ended" in driver.said())
    driver.let(1)
    assert driver.end(process) == 130
    assert driver.records.read(1)["success"]
    assert not driver.records.has_begun(2)
    driver.let(2)
    assert driver.end(driver.start("1", "2")) == 0
    assert driver.ran() == [1, 2]


def test_the_second_ctrl_c_interrupts_the_task_and_it_counts_as_failed(driver: Driver) -> None:
    process = driver.start("1", "2")
    driver.wait_for(1)
    process.send_signal(signal.SIGINT)
    wait_until(lambda: "stops when this task has ended" in driver.said())
    process.send_signal(signal.SIGINT)
    assert driver.end(process) == 130
    assert driver.records.state(1) is State.INTERRUPTED
    assert driver.failure(1) == {"module": OPERATOR, "reason": INTERRUPTED}
    driver.let(1)
    driver.let(2)
    assert driver.end(driver.start("1", "2")) == 0
    assert driver.ran() == [1, 2]
    assert not driver.records.read(1)["success"] and driver.records.read(2)["success"]


def test_sigterm_is_patient_however_often_it_comes(driver: Driver) -> None:
    process = driver.start("1", "2")
    driver.wait_for(1)
    process.send_signal(signal.SIGTERM)
    wait_until(lambda: "stops when this task has ended" in driver.said())
    process.send_signal(signal.SIGTERM)
    driver.let(1)
    assert driver.end(process) == 130
    assert driver.records.read(1)["success"]


def test_a_task_whose_campaign_was_killed_counts_as_failed_and_is_not_run_again(
    driver: Driver,
) -> None:
    process = driver.start("1", "2", "3")
    driver.let(1)
    driver.wait_for(2)
    process.kill()
    driver.end(process)
    assert driver.records.state(2) is State.BEGUN
    for seed in (2, 3):
        driver.let(seed)
    assert driver.end(driver.start("1", "2", "3")) == 0
    assert driver.ran() == [1, 2, 3]
    assert driver.failure(2)["reason"] == INTERRUPTED
    assert [driver.records.read(seed)["success"] for seed in (1, 2, 3)] == [True, False, True]


def test_a_failure_is_told_at_once_with_the_command_that_runs_it_again(driver: Driver) -> None:
    process = driver.start("1", "2")
    driver.let(1, "red_box leans by 12 degrees")
    driver.wait_for(2)
    assert "make eval-tasks FAMILY=six SEED=1 RTF=0" in driver.said()
    assert (driver.records.kept(1) / "parameters.json").exists()
    assert (driver.records.kept(1) / "logs").is_dir()
    driver.let(2)
    driver.end(process)


def test_two_campaigns_at_once_are_refused(driver: Driver) -> None:
    process = driver.start("1")
    driver.wait_for(1)
    assert driver.end(driver.start("1")) == 1
    assert "another process runs the campaign" in driver.said()
    driver.let(1)
    assert driver.end(process) == 0
    assert driver.ran() == [1]


def test_shares_run_all_tasks_once_and_go_on_with_another_number_of_them(driver: Driver) -> None:
    process = driver.start("1", "2", "3", "4", "5", "--jobs", "2")
    driver.wait_for(1, 2)
    process.send_signal(signal.SIGTERM)  # passed on to both
    wait_until(lambda: driver.said().count("stops when this task has ended") == 2)
    driver.let(1)
    driver.let(2)
    assert driver.end(process) == 130
    assert sorted(driver.ran()) == [1, 2]
    for seed in (3, 4, 5):
        driver.let(seed)
    assert driver.end(driver.start("1", "2", "3", "4", "5", "--jobs", "3")) == 0
    assert sorted(driver.ran()) == [1, 2, 3, 4, 5]


def test_shares_whose_parent_was_killed_end_their_tasks_and_hold_the_campaign(
    driver: Driver,
) -> None:
    process = driver.start("1", "2", "3", "4", "--jobs", "2")
    driver.wait_for(1, 2)
    process.kill()
    driver.end(process)
    assert driver.end(driver.start("1", "2", "3", "4")) == 1  # the shares still hold it
    wait_until(lambda: driver.said().count("stops when this task has ended") == 2)
    driver.let(1)
    driver.let(2)

    wait_until(lambda: driver.end(driver.start("1", "2")) == 0)
    assert sorted(driver.ran()) == [1, 2]
    assert driver.records.read(1)["success"] and driver.records.read(2)["success"]
    assert not driver.records.has_begun(3) and not driver.records.has_begun(4)
