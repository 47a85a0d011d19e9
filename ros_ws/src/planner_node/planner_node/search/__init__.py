# SPDX-License-Identifier: Apache-2.0
"""Search for a shortest plan: one interface, several algorithms."""

from .algorithms import ALGORITHMS, AUTO, SearchAlgorithm, algorithm_named
from .limits import DEFAULT_MAX_EXPANSIONS, Limits
from .plan import SearchResult, make_plan, search
from .state import Parents, Problem, State, path_to, successors

__all__ = [
    "ALGORITHMS",
    "AUTO",
    "DEFAULT_MAX_EXPANSIONS",
    "Limits",
    "Parents",
    "Problem",
    "SearchAlgorithm",
    "SearchResult",
    "State",
    "algorithm_named",
    "make_plan",
    "path_to",
    "search",
    "successors",
]
