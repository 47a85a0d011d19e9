# SPDX-License-Identifier: Apache-2.0
"""The search algorithms by name; a new one is a file beside this and an entry here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from .a_star import a_star
from .both_ends import both_ends
from .bounded import bounded
from .breadth_first import breadth_first
from .limits import Limits
from .patterns_both_ends import patterns_both_ends
from .patterns_first import patterns_first
from .peers.engine import PREFIX, Engine
from .state import Problem, State

#: Gives a path from the problem's start to a goal, both included: a shortest one, unless it tells
#: ``limits.prove_at_least`` what is proven. It tells the limits of every expansion, and raises
#: ``limits.unreachable()`` when there is no path.
SearchAlgorithm = Callable[[Problem, Limits], list[State]]

AUTO: Final = "auto"


ALGORITHMS: Final[dict[str, SearchAlgorithm]] = {
    AUTO: patterns_first,
    "breadth_first": breadth_first,
    "both_ends": both_ends,
    "a_star": a_star,
    "patterns": patterns_both_ends,
    "bounded": bounded,
}


def algorithm_named(name: str) -> SearchAlgorithm:
    """One of :data:`ALGORITHMS`, or an engine of Unified Planning by ``up:ENGINE``.

    Raises:
        ValueError: an unknown name, with the known ones; or Unified Planning is not installed.
    """
    if name.startswith(PREFIX):
        return Engine(name.removeprefix(PREFIX))
    if name not in ALGORITHMS:
        known = f"{', '.join(ALGORITHMS)}, {PREFIX}ENGINE"
        raise ValueError(f"no search algorithm {name!r}; known: {known}")
    return ALGORITHMS[name]
