# SPDX-License-Identifier: Apache-2.0
"""Fast Downward as a peer: the length of its shortest plan, and how long it takes."""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path

from planner_node import Goal, pddl_of
from scene_graph import Stacks


class FastDownward:
    """The planner of the wheel ``up-fast-downward`` in a virtual environment of its own."""

    def __init__(self, environment: Path) -> None:
        self._python = environment / "bin" / "python"
        found = sorted(environment.glob("lib/python3*/site-packages/up_fast_downward/downward"))
        if not self._python.exists() or not found:
            raise FileNotFoundError(
                f"{environment} has no Fast Downward; make one: python3 -m venv {environment} "
                f"&& {environment}/bin/pip install up-fast-downward, or leave FD out"
            )
        self._script = found[0] / "fast-downward.py"

    def shortest(
        self, initial: Stacks, goal: Goal, limit: float | None = None
    ) -> tuple[int, float] | None:
        """Moves of a shortest plan (A* with LM-cut), and the wall time of its process [s].

        None: it has not found one within ``limit`` [s].
        """
        with tempfile.TemporaryDirectory() as folder:
            domain, problem, plan = (Path(folder) / name for name in ("d.pddl", "p.pddl", "plan"))
            told = pddl_of(initial, goal)
            domain.write_text(told.domain)
            problem.write_text(told.problem)
            start = time.perf_counter()
            within = [] if limit is None else ["--overall-time-limit", f"{limit:.0f}s"]
            done = subprocess.run(
                [str(self._python), str(self._script), *within, "--plan-file", str(plan),
                 str(domain), str(problem), "--search", "astar(lmcut())"],
                cwd=folder, capture_output=True, text=True, check=False,
            )  # fmt: skip
            seconds = time.perf_counter() - start
            if not plan.exists() and limit is not None and seconds >= limit - 1.0:
                return None
            if not plan.exists():
                raise RuntimeError(
                    f"Fast Downward found no plan: {done.stdout[-500:]}{done.stderr}"
                )
            lines = plan.read_text().splitlines()
            return sum(line.startswith("(move ") for line in lines), seconds
