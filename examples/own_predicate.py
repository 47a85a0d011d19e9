# SPDX-License-Identifier: Apache-2.0
"""A predicate of your own: ``level``, for blocks at the same height in different stacks.

One entry of ``scene_graph.PREDICATES`` is all: goals are parsed with its phrases, the search tests
states by its meaning, and people are told its first phrase. In the project itself the entry stands
in scene_graph/predicates.py.

    python examples/own_predicate.py
"""

from __future__ import annotations

from planner_node import make_plan, parse_goal, resolve_goal
from scene_graph import PREDICATES, Predicate, Spot, format_stacks

STATE = (("red_box", "green_box"), (), ("blue_box", "yellow_box"))


def level(subject: Spot, object_: Spot) -> bool:
    """At the same height in different stacks."""
    return subject.stack != object_.stack and subject.level == object_.level


def main() -> None:
    phrases = ("level with", "as high as")
    PREDICATES.add(Predicate("level", level, phrases=phrases, takes_place=False))
    names = [name for stack in STATE for name in stack]
    goal = resolve_goal(parse_goal("red level with yellow, green above blue"), names)
    plan = make_plan(STATE, goal)
    print(f"{len(plan.moves)} moves to '{goal}'")
    for state in plan.states:
        print(" ", format_stacks(state))


if __name__ == "__main__":
    main()
