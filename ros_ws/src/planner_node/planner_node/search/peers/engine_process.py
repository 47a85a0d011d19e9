# SPDX-License-Identifier: Apache-2.0
"""The process of one engine: a problem in PDDL in, a plan out. It knows Unified Planning only.

usage: engine_process.py REQUEST ANSWER, two files of JSON.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any


def main(asked: Path, answered: Path) -> None:
    """Solves, and writes the answer: status, message, and the plan as text or None."""
    request = json.loads(asked.read_text())
    part = answered.with_suffix(".part")
    part.write_text(json.dumps(solve(request)))
    part.rename(answered)


def solve(request: dict[str, Any]) -> dict[str, Any]:
    """What an engine says to a request."""
    from unified_planning.exceptions import UPException
    from unified_planning.io import PDDLReader
    from unified_planning.model.metrics import MinimizeSequentialPlanLength
    from unified_planning.shortcuts import OneshotPlanner, get_environment

    get_environment().credits_stream = None
    known = sorted(get_environment().factory.engines)
    name = request["engine"]
    problem = PDDLReader().parse_problem_string(request["domain"], request["problem"])
    try:
        with OneshotPlanner(name=name) as planner:
            if not problem.quality_metrics:
                problem.add_quality_metric(MinimizeSequentialPlanLength())
                if not planner.supports(problem.kind):
                    problem.clear_quality_metrics()
            found = planner.solve(problem, timeout=request["seconds"])
    except UPException as error:
        there = [one for one in known if "[" not in one and not one.startswith("up_")]
        return _answer("INTERNAL_ERROR", f"{error}; engines: {', '.join(there)}", None)
    message = " ".join(str(log.message) for log in found.log_messages or ())[-300:]
    plan = None
    if found.plan is not None:
        plan = "\n".join(
            f"({' '.join([step.action.name, *map(str, step.actual_parameters)])})"
            for step in found.plan.actions
        )
    return _answer(found.status.name, message, plan)


def _answer(status: str, message: str, plan: str | None) -> dict[str, Any]:
    return {"status": status, "message": message, "plan": plan}


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
