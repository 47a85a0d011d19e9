# SPDX-License-Identifier: Apache-2.0
"""Goals: sets of relations that a state has to fulfil (z_goal of 5.2.2).

A goal image gives a complete goal, one relation a block; text may give any part of it. What a
relation means stands in :data:`scene_graph.PREDICATES` only.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from scene_graph import UP, Relation, Stacks, base_index, base_name, spots_of, up_relations


@dataclass(frozen=True)
class Goal:
    """All of ``relations`` at once."""

    relations: tuple[Relation, ...]

    def __str__(self) -> str:
        return ", ".join(relation.words for relation in self.relations)

    @property
    def names(self) -> frozenset[str]:
        """The blocks that the goal speaks of, without bases."""
        mentioned = {name for item in self.relations for name in (item.subject, item.object)}
        return frozenset(name for name in mentioned if base_index(name) is None)

    def holds(self, stacks: Stacks) -> bool:
        """Whether a state fulfils all relations."""
        spots = spots_of(stacks)
        return all(relation.holds(spots) for relation in self.relations)

    def state(self, names: Iterable[str], stack_count: int) -> Stacks | None:
        """The one state that a complete goal allows, or None for a partial or impossible goal.

        A goal is complete if it says of each of ``names`` what it stands on.
        """
        above = {item.object: item.subject for item in self.relations if item.predicate == UP}
        stacks = []
        for index in range(stack_count):
            stack: list[str] = []
            below = base_name(index)
            while below in above and above[below] not in stack:
                below = above[below]
                stack.append(below)
            stacks.append(tuple(stack))
        placed = sorted(name for stack in stacks for name in stack)
        if placed != sorted(names) or not self.holds(tuple(stacks)):
            return None
        return tuple(stacks)


def complete_goal(stacks: Stacks) -> Goal:
    """The goal that only ``stacks`` fulfils; what a goal image asks for (A.2.6)."""
    return Goal(tuple(sorted(up_relations(stacks))))
