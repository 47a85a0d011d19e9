# SPDX-License-Identifier: Apache-2.0
"""What one run of the test suite was: counted from pytest's JUnit file, kept as JSON."""

from __future__ import annotations

import json
import shlex
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from results_file import Row

#: How long the suite may take on an idle machine [s].
ALLOWED_SECONDS: Final = 360


@dataclass(frozen=True)
class FailedTest:
    """A test that failed, or could not be set up; ``test`` is what pytest takes as argument."""

    test: str
    message: str

    @property
    def again(self) -> str:
        """The command that runs the test again: ten times, five of them on a busy machine."""
        arguments = shlex.quote(self.test) if self.test else ""
        return f"tools/in_workspace python benchmarks/suite.py --only {arguments}".rstrip()


@dataclass(frozen=True)
class SuiteRun:
    """One run of the suite.

    Attributes:
        number: the position in the campaign, from 0.
        loaded: whether busy loops ran beside it.
        commit: of the code.
        seconds: wall time.
        tests: how many ran.
        failures: those that did not pass; a run that broke off is one without a test.
    """

    number: int
    loaded: bool
    commit: str
    seconds: float
    tests: int
    failures: tuple[FailedTest, ...]

    def write(self, path: Path) -> None:
        """Keeps the run in a file that appears only when it is whole."""
        part = path.with_suffix(".part")
        part.write_text(json.dumps(asdict(self), indent=1))
        part.rename(path)


def read_run(path: Path) -> SuiteRun:
    """The inverse of :meth:`SuiteRun.write`."""
    content = json.loads(path.read_text())
    failures = tuple(FailedTest(**failure) for failure in content.pop("failures"))
    return SuiteRun(**content, failures=failures)


def read_junit(path: Path) -> tuple[int, tuple[FailedTest, ...]]:
    """The number of tests in a JUnit file of pytest's family xunit1, and those that failed."""
    tests = 0
    failures = []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        tests += 1
        problems = [item for item in case if item.tag in ("failure", "error")]
        if problems:
            failures.append(FailedTest(_node_id(case), problems[0].get("message", "")))
    return tests, tuple(failures)


def make_rows(runs: Sequence[SuiteRun]) -> list[Row]:
    """The published rows of a campaign."""
    rows = []
    for loaded, name in ((False, "quiet machine"), (True, "every core kept busy")):
        chosen = [run for run in runs if run.loaded is loaded]
        if not chosen:
            continue
        counts = [len(run.failures) for run in chosen]
        seconds = [run.seconds for run in chosen]
        rows += [
            Row(name, "tests that failed, all runs together", sum(counts), "", len(chosen),
                (min(counts), max(counts)), required="== 0", note="n: runs of the whole suite"),
            Row(name, "wall time of the suite, slowest run", max(seconds), "s", len(chosen),
                (min(seconds), max(seconds)),
                required=None if loaded else f"<= {ALLOWED_SECONDS}"),
        ]  # fmt: skip
    counts = [run.tests for run in runs]
    return [
        *rows,
        Row(
            "all runs", "tests in the suite", min(counts), "", len(runs), (min(counts), max(counts))
        ),
    ]


def _node_id(case: ElementTree.Element) -> str:
    """``file::Class::name[parameters]``; the class name repeats the file's path with dots."""
    file = case.get("file", "")
    module = file.removesuffix(".py").replace("/", ".")
    classes = case.get("classname", "").removeprefix(module).strip(".").split(".")
    return "::".join([file, *filter(None, classes), case.get("name", "")])
