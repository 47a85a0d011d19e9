# SPDX-License-Identifier: Apache-2.0
"""Engines of Unified Planning in place of the search: the algorithm ``up:ENGINE``.

The problem goes out as PDDL, to a process of its own that can be stopped at any time, and what
comes back is read and checked like any plan of others. Without the package ``unified-planning``, an
extra (``make peers``), there are none.
"""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from ...errors import EngineError, GivenPlanError, SearchLimitError
from ...validator import InvalidPlanError, validate_plan
from ..a_star import moves_left
from ..limits import Limits
from ..patterns_both_ends import states_along
from ..state import Problem, State
from .pddl import pddl_of
from .read_plan import read_moves

#: In front of an engine's name.
PREFIX: Final = "up:"
#: What an engine gets for one plan [s].
MOST_SECONDS: Final = 60.0
_POLL_SECONDS: Final = 0.02
_HOW: Final = "make peers installs Unified Planning, Fast Downward and pyperplan"


def is_installed() -> bool:
    """Whether there is Unified Planning beside this program."""
    return importlib.util.find_spec("unified_planning") is not None


class Engine:
    """A search algorithm that asks another planner."""

    def __init__(self, name: str, seconds: float = MOST_SECONDS) -> None:
        """Raises ValueError without Unified Planning, or a name.

        Args:
            name: as Unified Planning calls it, such as "fast-downward-opt".
            seconds: what it gets for one plan [s].
        """
        if not name:
            raise ValueError(f"{PREFIX} is followed by an engine, such as {PREFIX}fast-downward")
        if not is_installed():
            raise ValueError(
                f"{PREFIX}{name} needs the package unified-planning, which is not installed; {_HOW}"
            )
        self._name, self._seconds = name, seconds

    def __call__(self, problem: Problem, limits: Limits) -> list[State]:
        """A path to the goal; how much longer than a shortest one it is at most is told.

        Raises:
            EngineError: the engine is not there, fails, or gives a plan that is none.
            UnreachableError: it says that there is no plan.
            SearchLimitError, SearchCancelledError: it has found none in time, or is not to.
        """
        told = pddl_of(problem.initial, problem.goal)
        answer = self._ask({"engine": self._name, "domain": told.domain, "problem": told.problem,
                            "seconds": self._seconds}, limits)  # fmt: skip
        status = answer["status"]
        if status in ("UNSOLVABLE_PROVEN", "UNSOLVABLE_INCOMPLETELY"):
            raise limits.unreachable()
        if status == "TIMEOUT":
            raise self._too_slow(limits)
        if answer["plan"] is None:
            raise self._failed(limits, answer["message"] or status)
        try:
            moves = read_moves(answer["plan"], problem.initial)
            validate_plan(problem.initial, problem.goal, moves)
        except (GivenPlanError, InvalidPlanError) as error:
            raise self._failed(limits, f"its plan is none: {error}") from error
        if status != "SOLVED_OPTIMALLY":
            limits.prove_at_least(max(1, moves_left(problem)(problem.start)))
        return states_along(problem.start, moves)

    def _ask(self, request: dict[str, Any], limits: Limits) -> dict[str, Any]:
        """The answer of a process that does nothing else."""
        program = str(Path(__file__).with_name("engine_process.py"))
        with tempfile.TemporaryDirectory(prefix="engine.") as folder:
            asked, answered, said = (Path(folder) / name for name in ("in", "out", "said"))
            asked.write_text(json.dumps(request))
            with said.open("wb") as out:
                process = subprocess.Popen(
                    [sys.executable, program, str(asked), str(answered)],
                    stdin=subprocess.DEVNULL,
                    stdout=out,
                    stderr=out,
                    cwd=folder,
                    start_new_session=True,
                )
            try:
                while True:
                    try:
                        process.wait(_POLL_SECONDS)
                        break
                    except subprocess.TimeoutExpired:
                        limits.poll()
                        if limits.seconds() > self._seconds:
                            raise self._too_slow(limits) from None
            finally:
                _end(process)
            if not answered.exists():
                tail = " ".join(said.read_text(errors="replace").split())[-300:]
                raise self._failed(limits, tail or f"exit code {process.returncode}")
            answer: dict[str, Any] = json.loads(answered.read_text())
            return answer

    def _too_slow(self, limits: Limits) -> SearchLimitError:
        return SearchLimitError(
            f"{PREFIX}{self._name} has found no plan within {self._seconds:.0f} s; ask for less, "
            "or set search_algorithm to auto",
            limits.expanded,
            limits.seconds(),
        )

    def _failed(self, limits: Limits, why: str) -> EngineError:
        return EngineError(f"{PREFIX}{self._name}: {why}", limits.expanded, limits.seconds())


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends a process and what it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
