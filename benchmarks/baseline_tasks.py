# SPDX-License-Identifier: Apache-2.0
"""The same tasks by the code of another checkout, in turns with this one's, and the ratios.

The other checkout is a clone at an older commit in which ``make setup`` has run. Its own benchmark
runs there as it stands; this module only reads what it leaves in ``runs/``.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, Final

from results_file import Row

#: A median may be this much longer than the other checkout's.
REQUIRED_RATIO: Final = "<= 1.1"
#: What is compared, and where a task's result has it.
TIMES: Final = ("plan", "motion")


class BaselineError(RuntimeError):
    """The other checkout cannot be used; the sentence says what to do."""


class Baseline:
    """Another checkout's ``make eval-tasks``.

    Args:
        checkout: its root folder.
        blocks: blocks in each task.
        real_time_factor: of its simulator.

    Raises:
        BaselineError: it is no checkout that is set up.
    """

    def __init__(self, checkout: Path, blocks: int, real_time_factor: float) -> None:
        self._checkout = checkout.resolve()
        self._blocks, self._factor = blocks, real_time_factor
        if not (self._checkout / ".venv").is_dir():
            raise BaselineError(f"{checkout} is not set up; run `make setup` there")
        self._runs = self._checkout / "runs" / f"eval_tasks_{blocks}"
        self.commit = subprocess.run(
            ["git", "-C", str(self._checkout), "rev-parse", "--short", "HEAD"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()

    def forget(self) -> None:
        """Removes what earlier runs left, so that all tasks are run anew."""
        for path in self._runs.glob("*.json"):
            path.unlink()

    def run(self, tasks: int) -> None:
        """Runs the first ``tasks`` tasks that have not been run yet.

        Raises:
            BaselineError: its benchmark ends with an error.
        """
        command = [
            *("tools/in_workspace", "python", "benchmarks/eval_tasks.py", "--resume"),
            *("--n", str(tasks), "--blocks", str(self._blocks)),
            *("--real-time-factor", str(self._factor)),
        ]
        ended = subprocess.run(
            command, cwd=self._checkout, env=_bare_environment(), stdout=subprocess.DEVNULL
        )
        if ended.returncode:
            raise BaselineError(f"{' '.join(command)} in {self._checkout} failed; run it by hand")

    def results(self) -> list[dict[str, Any]]:
        """The results of all tasks that came to their end so far, by seed."""
        records = [json.loads(path.read_text()) for path in sorted(self._runs.glob("*.json"))]
        return [record for record in records if "timing_s" in record]


def ratio_rows(
    ours: Sequence[Mapping[str, Any]], theirs: Sequence[Mapping[str, Any]], commit: str
) -> list[Row]:
    """Medians of this code over those of the other, on the tasks that both have run."""
    ours = [result for result in ours if "timing_s" in result]
    seeds = {result["seed"] for result in ours} & {result["seed"] for result in theirs}
    pairs = [[r for r in results if r["seed"] in seeds] for results in (ours, theirs)]
    name = f"old code ({commit}) and new in turns"
    frames = [[s for result in side for s in result["graph_seconds"]] for side in pairs]
    rows = [_row(name, "image to confident graph", frames, "ms", 1e3)]
    for time in TIMES:
        rows.append(_row(name, time, [[r["timing_s"][time] for r in side] for side in pairs]))
    return rows


def _row(
    name: str, what: str, sides: Sequence[Sequence[float]], unit: str = "s", scale: float = 1.0
) -> Row:
    new, old = (median(side) for side in sides)
    return Row(
        name,
        f"{what}, median, new over old",
        new / old,
        "",
        len(sides[0]),
        required=REQUIRED_RATIO,
        note=f"new {scale * new:.4g} {unit}, old {scale * old:.4g} {unit}",
    )


def _bare_environment() -> dict[str, str]:
    """Without this workspace, so that the other checkout's own is found."""
    ours = (
        "VIRTUAL_ENV",
        "PYTHONPATH",
        "AMENT_",
        "COLCON_",
        "CMAKE_",
        "LD_LIBRARY_PATH",
        "ROS_",
        "_ROS_",
    )
    kept = {key: value for key, value in os.environ.items() if not key.startswith(ours)}
    venv = os.environ.get("VIRTUAL_ENV", "")
    folders = kept.get("PATH", "").split(os.pathsep)
    kept["PATH"] = os.pathsep.join(item for item in folders if not venv or venv not in item)
    return kept
