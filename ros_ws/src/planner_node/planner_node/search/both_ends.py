# SPDX-License-Identifier: Apache-2.0
"""Breadth-first search from both ends; every move can be undone, so that it works backwards."""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from .breadth_first import breadth_first
from .limits import Limits
from .state import Parents, Problem, State, path_to

#: Expansions that are counted at once.
CHUNK: Final = 16
#: Of a state at an end of the search: no stack has been given a block.
_NOWHERE: Final = -1


def both_ends(
    problem: Problem, limits: Limits, forbidden: Collection[str] = frozenset()
) -> list[State]:
    """Whole layers in turns from both ends; the first state that both know is on a shortest path.

    Once the layers up to depths d and e are complete and disjoint, no path is shorter than
    d + e + 1, and a state that the next layer shares with the other side gives exactly that.
    A goal that is not complete has no other end: it is searched for from the start alone.

    The block that was moved last is not moved on: where it would go it could have gone at once.

    Args:
        forbidden: pairs of symbols of which the first is never put on the second; what stands so
            at the start may stay. Backwards, nothing is taken from where it cannot have been put.
    """
    if problem.target is None:
        return breadth_first(problem, limits)
    if problem.start == problem.target:
        return [problem.start]
    near: Parents = {problem.start: None}
    far: Parents = {problem.target: None}
    near_layer, far_layer = [(problem.start, _NOWHERE)], [(problem.target, _NOWHERE)]
    places = range(len(problem.start))
    while near_layer and far_layer:
        forward = len(near_layer) <= len(far_layer)
        ours, theirs, layer = (near, far, near_layer) if forward else (far, near, far_layer)
        not_on, not_from = (forbidden, ()) if forward else ((), forbidden)
        found: list[tuple[State, int]] = []
        offset = 0
        while offset < len(layer):
            allowed = limits.count_expansions(min(CHUNK, len(layer) - offset))
            for state, last in layer[offset : offset + allowed]:
                # As `successors` does, but in place: this loop is what a search's time goes into.
                for source in places:
                    stack = state[source]
                    if source == last or not stack:
                        continue
                    stacks, top = list(state), stack[-1]
                    if not_from and top + stack[-2:-1] in not_from:
                        continue
                    stacks[source] = stack[:-1]
                    for target in places:
                        if target == source:
                            continue
                        if not_on and top + state[target][-1:] in not_on:
                            continue
                        stacks[target] += top
                        successor = tuple(stacks)
                        stacks[target] = state[target]
                        if successor in ours:
                            continue
                        ours[successor] = state
                        found.append((successor, target))
                        if successor in theirs:
                            return path_to(successor, near) + path_to(successor, far)[-2::-1]
            offset += allowed
        if forward:
            near_layer = found
        else:
            far_layer = found
    raise limits.unreachable()
