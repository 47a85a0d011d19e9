# SPDX-License-Identifier: Apache-2.0
"""Goals: what people type, what it means in a scene, and what excludes itself.

A text becomes a goal step by step, each of which asks back what it does not understand:

1. words: ``tokens`` (signs, short spelling, slips), ``merged`` (several words that stand for
   others, listed in ``wordings``; ``places``, ``orders``), ``courtesy`` (what says nothing);
2. clauses: ``sentences``, with ``corrections``, ``exceptions``, ``relative``, ``sides``,
   ``towers`` and ``run_on``, each of which rewrites words into plainer ones;
3. relations: ``clauses`` reads one clause (``plainer``, ``described``, ``holdings``, ``phrases``,
   ``quantities``, ``unrelated``) as ``said.Said``; ``parse`` puts them together with what was
   ``told`` before, as ``parsed.ParsedRelation``;
4. the scene: ``resolve`` finds what ``names`` and ``resolve_places`` mean, as ``goal.Goal``;
   ``contradictions`` finds what excludes itself.

All vocabulary is in ``language`` and ``wordings``.
"""

from .contradictions import check_contradictions, find_contradiction
from .goal import Count, Goal, ResolveGoal, complete_goal, goal_of_picture
from .names import resolve_name
from .grammar.reader import parse_goal
from .parsed import Parsed, ParsedRelation
from .resolve import resolve_goal
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
