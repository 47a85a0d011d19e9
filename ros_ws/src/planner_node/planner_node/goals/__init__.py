# SPDX-License-Identifier: Apache-2.0
"""Goals: what people type, what it means in a scene, and what excludes itself.

A text becomes a goal in four steps, each of which asks back what it does not understand:

1. ``grammar.tokens`` and ``grammar.lattice`` find what kinds of word there are
   (``lexicon_of_*.txt``), with slips mended (``slips``);
2. ``grammar.chart`` reads them in all ways that ``rules_of_*.txt`` allow, the cheapest first; the
   modules that these name build what they mean; where a text is not read whole, it is read again
   without the stretches of it that say nothing (``grammar.skipping``);
3. ``grammar.discourse`` finds who "it" and "the rest" are: relations, as ``parsed.Parsed``;
4. ``resolve`` finds what they mean in a scene, by ``names`` and by how the blocks stand ``now``, as
   ``goal.Goal``; ``contradictions`` finds what excludes itself.
"""

from .contradictions import check_contradictions, find_contradiction
from .goal import Count, Goal, ResolveGoal, complete_goal, goal_of_picture
from .grammar.reader import parse_goal
from .names import resolve_name
from .parsed import Parsed, ParsedRelation
from .resolve import resolve_goal
from .terms import Kind, Words

__all__ = [
    "Count",
    "Goal",
    "Kind",
    "Parsed",
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
