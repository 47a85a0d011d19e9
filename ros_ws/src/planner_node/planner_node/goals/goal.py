# SPDX-License-Identifier: Apache-2.0
"""Goals: sets of relations that a state has to fulfil (z_goal of 5.2.2), and numbers of them.

A goal image gives a complete goal, one relation a block; text may give any part of it. What a
relation means stands in :data:`scene_graph.PREDICATES` only.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from scene_graph import (
    ONE_ROW,
    UP,
    Relation,
    Rows,
    Spot,
    Stacks,
    base_index,
    base_name,
    spots_of,
    up_relations,
)

from ..errors import GoalImageError


@dataclass(frozen=True)
class Count:
    """How many of some relations have to hold: "three blocks in stack1", "a red block on blue".

    Attributes:
        words: as people are told it.
        least, most: both included.
    """

    words: str
    relations: tuple[Relation, ...]
    least: int
    most: int

    def __str__(self) -> str:
        return self.words

    def holds(self, spots: Mapping[str, Spot]) -> bool:
        """Whether a state fulfils it; see :meth:`scene_graph.Relation.holds`."""
        return self.least <= sum(item.holds(spots) for item in self.relations) <= self.most


@dataclass(frozen=True)
class Goal:
    """All of ``relations`` and all of ``counts`` at once.

    Attributes:
        rows: how the places lie that the relations are read on.
    """

    relations: tuple[Relation, ...]
    counts: tuple[Count, ...] = ()
    rows: Rows = ONE_ROW

    def __str__(self) -> str:
        return ", ".join([*(item.words for item in self.relations), *map(str, self.counts)])

    @property
    def names(self) -> frozenset[str]:
        """The blocks that the goal speaks of, without bases."""
        relations = [*self.relations, *(one for item in self.counts for one in item.relations)]
        mentioned = {name for item in relations for name in (item.subject, item.object)}
        return frozenset(name for name in mentioned if base_index(name) is None)

    def on(self, rows: Rows) -> Goal:
        """The same goal for places that lie so."""
        return replace(self, rows=rows)

    def holds(self, stacks: Stacks) -> bool:
        """Whether a state fulfils all relations."""
        return self.holds_at(spots_of(stacks, self.rows.spot))

    def holds_at(self, spots: Mapping[str, Spot]) -> bool:
        """Whether a state fulfils all relations; see :meth:`scene_graph.Relation.holds`."""
        relations = all(item.holds(spots) for item in self.relations)
        return relations and all(item.holds(spots) for item in self.counts)

    def fulfilled_by(self, stacks: Stacks) -> tuple[Relation, ...]:
        """The relations that a state fulfils: all of the goal, and those that are counted."""
        spots = spots_of(stacks, self.rows.spot)
        counted = (one for item in self.counts for one in item.relations)
        found = [item for item in (*self.relations, *counted) if item.holds(spots)]
        return tuple(dict.fromkeys(found))

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


class ResolveGoal(Protocol):
    """Finds the objects of a goal, in whatever form it was asked for, in a scene."""

    def __call__(self, seen: Stacks, rows: Rows = ONE_ROW, /) -> Goal:
        """The goal for these blocks, on places that lie so; raises PlannerError."""
        ...


def complete_goal(stacks: Stacks) -> Goal:
    """The goal that only ``stacks`` fulfils; what a goal image asks for (A.2.6)."""
    return Goal(tuple(sorted(up_relations(stacks))))


def goal_of_picture(shown: Stacks, seen: Stacks) -> Goal:
    """The complete goal that a goal image shows (A.2.6), for the scene that is seen.

    Raises:
        GoalImageError: the image shows other objects, or another number of stacks.
    """
    in_picture = {name for stack in shown for name in stack}
    in_scene = {name for stack in seen for name in stack}
    missing, extra = sorted(in_scene - in_picture), sorted(in_picture - in_scene)
    if missing or extra:
        differences = [
            f"{', '.join(names)} {verb}"
            for names, verb in ((missing, "missing in the image"), (extra, "not in the scene"))
            if names
        ]
        raise GoalImageError(
            f"the goal image shows other objects than the scene: {'; '.join(differences)}",
            missing,
            extra,
        )
    if len(shown) != len(seen):
        raise GoalImageError(f"the goal image shows {len(shown)} stacks, the scene has {len(seen)}")
    return complete_goal(shown)
