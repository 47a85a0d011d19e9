# SPDX-License-Identifier: Apache-2.0
"""Fast Downward as a peer: a problem of stacks in PDDL, and the length of its shortest plan."""

from __future__ import annotations

import subprocess
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from planner_node import Goal
from scene_graph import UP, Stacks, base_name

DOMAIN = """(define (domain stacks)
 (:requirements :strips :typing :negative-preconditions :equality)
 (:types block base - thing)
 (:predicates (on ?b - block ?t - thing) (clear ?t - thing))
 (:action move
  :parameters (?b - block ?from ?to - thing)
  :precondition (and (on ?b ?from) (clear ?b) (clear ?to) (not (= ?b ?to)) (not (= ?from ?to)))
  :effect (and (on ?b ?to) (clear ?from) (not (on ?b ?from)) (not (clear ?to)))))
"""


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
            domain.write_text(DOMAIN)
            problem.write_text(_problem(initial, goal))
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
            return sum(line.startswith("(") for line in lines), seconds


def _problem(initial: Stacks, goal: Goal) -> str:
    blocks = [name for stack in initial for name in stack]
    bases = [base_name(place) for place in range(len(initial))]
    facts = []
    for base, stack in zip(bases, initial):
        column = [base, *stack]
        facts += [f"(on {upper} {lower})" for lower, upper in pairwise(column)]
        facts.append(f"(clear {column[-1]})")
    assert all(item.predicate == UP for item in goal.relations)
    wanted = " ".join(f"(on {item.subject} {item.object})" for item in goal.relations)
    return (
        f"(define (problem p) (:domain stacks) (:objects {' '.join(blocks)} - block "
        f"{' '.join(bases)} - base) (:init {' '.join(facts)}) (:goal (and {wanted})))"
    )
