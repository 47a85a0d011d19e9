# SPDX-License-Identifier: Apache-2.0
"""A state and a goal in words in, a shortest plan out; or a sentence why there is none.

Run it as

    python examples/plan_from_a_scene.py "red on blue, green left of red"
"""

from __future__ import annotations

import sys

from planner_node import PlannerError, make_plan, parse_goal, resolve_goal
from scene_graph import format_stacks

#: From the left, each stack from the bottom.
STATE = (("red_box", "green_box"), ("blue_box", "yellow_box"), ())


def main(text: str = "red on blue, green left of red") -> None:
    names = [name for stack in STATE for name in stack]
    try:
        goal = resolve_goal(parse_goal(text), names)
        plan = make_plan(STATE, goal)
    except PlannerError as error:
        print(f"{error.status}: {error}")
        return
    print(f"{len(plan.moves)} moves to '{goal}', {plan.expanded} states expanded")
    print(f"{'':8}{format_stacks(plan.states[0])}")
    for move, state in zip(plan.moves, plan.states[1:]):
        print(f"{move!s:8}{format_stacks(state)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
