# SPDX-License-Identifier: Apache-2.0
"""``make soak-tests`` counts what pytest counts, and can be stopped and continued."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import suite
from suite_report import FailedTest, SuiteRun, make_rows, read_junit, read_run

TESTS = """
import pytest

class TestThing:
    @pytest.mark.parametrize("word", ["a-b", "c d"])
    def test_word(self, word):
        assert word != "c d"

@pytest.fixture
def broken():
    raise RuntimeError("broken")

def test_that_cannot_start(broken): pass
def test_that_passes(): pass
@pytest.mark.skip
def test_that_is_skipped(): pass
"""
SLOW = """
import pathlib, time

def test_slow():
    pathlib.Path("begun").touch()
    time.sleep(1000.0)
"""


def run_pytest(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments],
        cwd=folder, capture_output=True, text=True, timeout=120.0, check=False,
    )  # fmt: skip


def start_campaign(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    """As a script starts it in the background."""
    return subprocess.Popen(
        [sys.executable, suite.__file__, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )


def test_failures_are_named_so_that_pytest_finds_them_again(tmp_path: Path) -> None:
    folder = tmp_path / "some" / "folder"
    folder.mkdir(parents=True)
    (folder / "test_it.py").write_text(TESTS)
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    run_pytest(tmp_path, "--junitxml=out.xml", "-o", "junit_family=xunit1")
    tests, failures = read_junit(tmp_path / "out.xml")
    assert tests == 5
    assert [failure.test for failure in failures] == [
        "some/folder/test_it.py::TestThing::test_word[c d]",
        "some/folder/test_it.py::test_that_cannot_start",
    ]
    for failure, outcome in zip(failures, ("1 failed", "1 error")):
        assert re.search(rf"^.*{outcome} in", run_pytest(tmp_path, failure.test).stdout, re.M)


def test_a_run_survives_its_file(tmp_path: Path) -> None:
    run = SuiteRun(3, True, "abc", 12.5, 7, (FailedTest("test_it.py::test[a b]", "why"),))
    run.write(tmp_path / "run.json")
    assert read_run(tmp_path / "run.json") == run
    assert run.failures[0].again.endswith("--only 'test_it.py::test[a b]'")


def test_rows_hold_only_if_nothing_failed_and_the_quiet_runs_were_quick_enough() -> None:
    failure = FailedTest("test_it.py::test", "why")
    runs = [
        SuiteRun(0, False, "abc", 100.0, 7, ()),
        SuiteRun(1, True, "abc", 900.0, 7, (failure, failure)),
        SuiteRun(2, False, "abc", 361.0, 7, ()),
    ]
    rows = {(row.set, row.metric): row for row in make_rows(runs)}
    assert [(row.value, row.holds) for row in rows.values()] == [
        (0, True), (361.0, False), (2, False), (900.0, None), (7, None),
    ]  # fmt: skip


def test_a_campaign_reports_each_failure_and_the_way_to_it(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text("def test_it(): assert False, 'because'\n")
    campaign = start_campaign(tmp_path, "--runs", "2", "--only", "test_it.py")
    stdout, stderr = campaign.communicate(timeout=240.0)
    assert campaign.returncode == 1, stderr
    assert stdout.count("1 of 1 failed") == 2
    assert stdout.count("benchmarks/suite.py --only test_it.py::test_it") == 2


def test_a_campaign_in_the_background_stops_on_ctrl_c_and_goes_on_later(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text("def test_it(): pass\n")
    assert start_campaign(tmp_path, "--runs", "1", "--only", "test_it.py").wait(120.0) == 0
    first = next(tmp_path.glob("runs/**/run_00.json")).stat().st_mtime_ns
    (tmp_path / "test_it.py").write_text(SLOW)
    campaign = start_campaign(tmp_path, "--runs", "2", "--resume", "--only", "test_it.py")
    deadline = time.monotonic() + 120.0
    while not (tmp_path / "begun").exists():
        assert time.monotonic() < deadline
        time.sleep(0.02)
    os.kill(campaign.pid, signal.SIGINT)
    stdout, stderr = campaign.communicate(timeout=120.0)
    assert campaign.returncode == 130, stderr
    assert "RESUME=1" in stdout
    assert next(tmp_path.glob("runs/**/run_00.json")).stat().st_mtime_ns == first
    assert not list(tmp_path.glob("runs/**/run_01.json"))
