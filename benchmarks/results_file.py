# SPDX-License-Identifier: Apache-2.0
"""Result files: every published number, with what regenerates it and whether it holds."""

from __future__ import annotations

import json
import math
import os
import platform
import re
import subprocess
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path
from statistics import NormalDist
from typing import Any, Final

#: Quantile of the normal distribution at 0.975.
_Z95: Final = NormalDist().inv_cdf(0.975)

RESULTS_FOLDER: Final = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Row:
    """One number.

    Attributes:
        set, metric, value, unit: what was measured on what.
        n: number of cases behind the value.
        spread: interval or extremes, low and high.
        required: the bound that was asked for, such as "<= 0.5" or ">= 0.98"; None: no bound.
        thesis: the thesis' number for the same thing, or None.
        note: anything a reader must know to read the row.
    """

    set: str
    metric: str
    value: float
    unit: str
    n: int
    spread: tuple[float, float] | None = None
    required: str | None = None
    thesis: float | None = None
    note: str | None = None

    @property
    def holds(self) -> bool | None:
        """Whether the value meets the bound; None where there is none."""
        if self.required is None:
            return None
        match = re.fullmatch(r"(<=|>=|<|>|==) *([-+.\deE]+)", self.required)
        if match is None:
            raise ValueError(f"cannot read the bound {self.required!r}")
        bound = float(match.group(2))
        return {
            "<=": self.value <= bound,
            ">=": self.value >= bound,
            "<": self.value < bound,
            ">": self.value > bound,
            "==": self.value == bound,
        }[match.group(1)]


def quick() -> bool:
    """Whether QUICK=1 asks for a run of under two minutes on small samples."""
    return os.environ.get("QUICK", "") not in ("", "0")


def write_result(
    name: str,
    command: str,
    rows: Sequence[Row],
    seconds: float,
    details: dict[str, Any] | None = None,
) -> Path:
    """Writes ``benchmarks/results/NAME.json``; a quick run goes to ``NAME.quick.json``.

    Args:
        details: whatever else belongs to the measurement, such as each failure with its reason.
    """
    content = {
        "name": name,
        "command": command,
        "commit": source_commit(),
        "date": date.today().isoformat(),
        "machine": _machine(),
        "seconds": round(seconds, 1),
        "quick": quick(),
        "rows": [{**asdict(row), "holds": row.holds} for row in rows],
        **({"details": details} if details else {}),
    }
    RESULTS_FOLDER.mkdir(exist_ok=True)
    path = RESULTS_FOLDER / (f"{name}.quick.json" if quick() else f"{name}.json")
    path.write_text(json.dumps(content, indent=1) + "\n")
    return path


def print_rows(rows: Sequence[Row]) -> None:
    """The rows for the terminal."""
    for row in rows:
        spread = f" [{row.spread[0]:.4g}, {row.spread[1]:.4g}]" if row.spread else ""
        verdict = {None: "", True: "holds", False: "FALLS SHORT"}[row.holds]
        print(
            f"{row.set:32} {row.metric:44} {row.value:10.4g} {row.unit:4}{spread:22} "
            f"n={row.n:<5} {row.required or '':10} {verdict}"
        )


def wilson_interval(successes: int, n: int) -> tuple[float, float]:
    """95% confidence interval of a rate: the rates that a test at 5% would not reject (Wilson)."""
    rate, per = successes / n, _Z95 * _Z95 / n
    centre = (rate + 0.5 * per) / (1.0 + per)
    half = math.sqrt(per * (rate * (1.0 - rate) + 0.25 * per)) / (1.0 + per)
    low = 0.0 if successes == 0 else centre - half
    high = 1.0 if successes == n else centre + half
    return low, high


def source_commit() -> str:
    """The commit of what can be measured, marked where files were changed since."""

    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", *arguments], capture_output=True, text=True, check=False
        ).stdout.strip()

    sources = ("ros_ws", "benchmarks/*.py", "tests")
    changed = git("status", "--porcelain", "--untracked-files=no", "--", *sources)
    return git("rev-parse", "--short", "HEAD") + ("+changes" if changed else "")


def _machine() -> dict[str, Any]:
    cpu = re.search(r"model name\s*:\s*(.+)", Path("/proc/cpuinfo").read_text())
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "cpu": cpu.group(1) if cpu else platform.processor(),
        "cores": os.cpu_count(),
        "memory_gib": round(memory / 2**30),
    }
