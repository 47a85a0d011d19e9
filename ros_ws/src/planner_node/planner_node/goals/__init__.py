# SPDX-License-Identifier: Apache-2.0
"""Goals: what people type, what it means in a scene, and what excludes itself."""

from .contradictions import check_contradictions, find_contradiction
from .goal import Count, Goal, ResolveGoal, complete_goal, goal_of_picture
from .parse import parse_goal
from .parsed import ParsedRelation
from .resolve import resolve_goal, resolve_name
from .terms import Kind, Words

__all__ = [
    "Count",
    "Goal",
    "Kind",
    "ParsedRelation",
    "ResolveGoal",
    "Words",
    "check_contradictions",
    "complete_goal",
    "find_contradiction",
    "goal_of_picture",
    "parse_goal",
    "resolve_goal",
    "resolve_name",
]
