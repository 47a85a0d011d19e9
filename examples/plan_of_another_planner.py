# SPDX-License-Identifier: Apache-2.0
"""A problem out as PDDL, and another planner's plan in: checked, and used or refused by its step.

    python examples/plan_of_another_planner.py FOLDER

writes domain.pddl and problem.pddl. On a robot these are written by
`ros2 run planner_node write_pddl GOAL`, and `ros2 run planner_node achieve_goal --plan FILE` has a
plan carried out.
"""

from __future__ import annotations

import sys
from pathlib import Path

from planner_node import PlannerError, checked_plan, parse_goal, pddl_of, resolve_goal
from scene_graph import format_stacks

STATE = (("red_box", "green_box"), ("blue_box", "yellow_box"), ())
#: As a planner writes it. The other one forgets that the yellow box is in the way.
PLANS = (
    "(move green_box red_box stack2)\n(move yellow_box blue_box green_box)\n"
    "(move red_box stack0 blue_box)\n; cost = 3",
    "(move green_box red_box stack2)\n(move red_box stack0 blue_box)",
)


def main(folder: str = ".") -> None:
    names = [name for stack in STATE for name in stack]
    goal = resolve_goal(parse_goal("red on blue"), names, len(STATE))
    told = pddl_of(STATE, goal)
    for name, text in (("domain", told.domain), ("problem", told.problem)):
        Path(folder, f"{name}.pddl").write_text(text)
    for text in PLANS:
        try:
            plan = checked_plan(text, STATE, goal)
        except PlannerError as error:
            print(f"{error.status}: {error}")
        else:
            print(f"{len(plan.moves)} moves to {format_stacks(plan.states[-1])}")


if __name__ == "__main__":
    main(*sys.argv[1:])
