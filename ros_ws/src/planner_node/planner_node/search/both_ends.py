# SPDX-License-Identifier: Apache-2.0
"""Breadth-first search from both ends; every move can be undone, so that it works backwards."""

from __future__ import annotations

from typing import Final

from .breadth_first import breadth_first
from .limits import Limits
from .state import Parents, Problem, State, path_to, successors

#: Expansions that are counted at once.
CHUNK: Final = 16


def both_ends(problem: Problem, limits: Limits) -> list[State]:
    """Whole layers in turns from both ends; the first state that both know is on a shortest path.

    Once the layers up to depths d and e are complete and disjoint, no path is shorter than
    d + e + 1, and a state that the next layer shares with the other side gives exactly that.
    A goal that is not complete has no other end: it is searched for from the start alone.
    """
    if problem.target is None:
        return breadth_first(problem, limits)
    if problem.start == problem.target:
        return [problem.start]
    near: Parents = {problem.start: None}
    far: Parents = {problem.target: None}
    near_layer, far_layer = [problem.start], [problem.target]
    while near_layer and far_layer:
        forward = len(near_layer) <= len(far_layer)
        ours, theirs, layer = (near, far, near_layer) if forward else (far, near, far_layer)
        found: list[State] = []
        offset = 0
        while offset < len(layer):
            allowed = limits.count_expansions(min(CHUNK, len(layer) - offset))
            for state in layer[offset : offset + allowed]:
                for successor, _ in successors(state):
                    if successor in ours:
                        continue
                    ours[successor] = state
                    found.append(successor)
                    if successor in theirs:
                        return path_to(successor, near) + path_to(successor, far)[-2::-1]
            offset += allowed
        if forward:
            near_layer = found
        else:
            far_layer = found
    raise limits.unreachable()
