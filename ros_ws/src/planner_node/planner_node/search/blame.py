# SPDX-License-Identifier: Apache-2.0
"""Which parts of a goal no arrangement of the blocks fulfils together.

The rules of :mod:`planner_node.goals.contradictions` give a reason and know the common cases; this
tries all arrangements, and knows every case.
"""

from __future__ import annotations

from scene_graph import Relation, Rows, Stacks

from ..goals.goal import Count, Goal
from .goal_states import goal_states
from .limits import Limits
from .state import ANY, Problem
from .wanted import Wanted


def excluding_parts(initial: Stacks, goal: Goal, limits: Limits) -> list[Relation | Count] | None:
    """A smallest choice of the goal's parts that no arrangement fulfils; None: there is none.

    None, too, where there are too many arrangements to be tried, or blocks that are not there.
    """
    if not goal.names <= {name for stack in initial for name in stack}:
        return None
    parts: list[Relation | Count] = [*goal.relations, *goal.counts]
    if not _excluded(initial, parts, goal.rows, limits):
        return None
    for part in tuple(parts):
        fewer = [item for item in parts if item is not part]
        if fewer and _excluded(initial, fewer, goal.rows, limits):
            parts = fewer
    return parts


def _excluded(initial: Stacks, parts: list[Relation | Count], rows: Rows, limits: Limits) -> bool:
    goal = Goal(
        tuple(part for part in parts if isinstance(part, Relation)),
        tuple(part for part in parts if isinstance(part, Count)),
        rows,
    )
    problem = Problem(initial, goal)
    wanted = Wanted(problem)
    if not wanted.possible:
        return True
    like = sum(stack.count(ANY) for stack in problem.start)
    found = goal_states(wanted, len(initial), like, limits.poll)
    return found is not None and not len(found)
