# SPDX-License-Identifier: Apache-2.0
"""Breadth-first search: Algorithm A.1."""

from __future__ import annotations

from .conditions import Condition
from .limits import Limits
from .state import Parents, Problem, State, path_to, successors


def breadth_first(problem: Problem, limits: Limits) -> list[State]:
    """Layer by layer from the start; the goal is tested when a state is found, not expanded.

    With each state goes a relation that it does not fulfil: until a block of that relation is
    moved, no state after it can be a goal, and none has to be tested.
    """
    parents: Parents = {problem.start: None}
    unmet = problem.unmet(problem.start)
    if unmet is None:
        return [problem.start]
    layer, reasons = [problem.start], [unmet]
    while layer:
        found: list[State] = []
        found_reasons: list[Condition] = []
        for state, unmet in zip(layer, reasons):
            limits.count_expansion()
            symbols = unmet.symbols
            for successor, moved in successors(state):
                if successor in parents:
                    continue
                parents[successor] = state
                left = problem.unmet(successor) if moved in symbols else unmet
                if left is None:
                    return path_to(successor, parents)
                found.append(successor)
                found_reasons.append(left)
        layer, reasons = found, found_reasons
    raise limits.unreachable()
