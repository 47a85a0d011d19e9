# SPDX-License-Identifier: Apache-2.0
"""Goals: sets of relations that a state has to fulfil (z_goal of 5.2.2).

A goal image gives a complete goal, one relation a block; text may give any part of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from scene_graph import LEFT, Relation, Stacks, base_index, base_name, up_relations

ON: Final = "on"
ABOVE: Final = "above"
LEFT_OF: Final = "left of"


@dataclass(frozen=True, order=True)
class GoalRelation:
    """One condition on a state.

    ``on``: the subject stands directly on the object; ``above``: somewhere above it in the same
    stack; the object of both may be a base. ``left of``: the subject's stack has the smaller index.
    """

    subject: str
    predicate: str
    object: str

    def __str__(self) -> str:
        return f"{self.subject} {self.predicate} {self.object}"

    def holds(self, stacks: Stacks) -> bool:
        """Whether a state fulfils the condition; an object that is not there fulfils none."""
        places = {
            name: (index, height)
            for index, stack in enumerate(stacks)
            for height, name in enumerate(stack)
        }
        subject = places.get(self.subject)
        base = base_index(self.object)
        # A base is the place below the lowest block (A.2.2).
        object_ = places.get(self.object) if base is None else (base, -1)
        if subject is None or object_ is None:
            return False
        if self.predicate == LEFT_OF:
            return subject[0] < object_[0]
        if self.predicate == ON:
            return subject[0] == object_[0] and subject[1] == object_[1] + 1
        return subject[0] == object_[0] and subject[1] > object_[1]


@dataclass(frozen=True)
class Goal:
    """All of ``relations`` at once."""

    relations: tuple[GoalRelation, ...]

    def __str__(self) -> str:
        return ", ".join(str(relation) for relation in self.relations)

    @property
    def names(self) -> frozenset[str]:
        """The blocks that the goal speaks of, without bases."""
        mentioned = {name for item in self.relations for name in (item.subject, item.object)}
        return frozenset(name for name in mentioned if base_index(name) is None)

    def holds(self, stacks: Stacks) -> bool:
        return all(relation.holds(stacks) for relation in self.relations)

    def state(self, names: Iterable[str], stack_count: int) -> Stacks | None:
        """The one state that a complete goal allows, or None for a partial or impossible goal.

        A goal is complete if it says of each of ``names`` what it stands on.
        """
        above = {item.object: item.subject for item in self.relations if item.predicate == ON}
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

    def witnesses(self, stacks: Stacks) -> frozenset[Relation]:
        """The goal in the vocabulary of scene graphs, given a state that fulfils it.

        Scene graphs have no ``above``: there the chain of up-relations between the two stands.
        """
        relations: set[Relation] = set()
        up = {item.subject: item for item in up_relations(stacks)}
        for item in self.relations:
            if item.predicate == LEFT_OF:
                relations.add(Relation(item.subject, LEFT, item.object))
                continue
            name = item.subject
            while name != item.object:
                relations.add(up[name])
                name = up[name].object
        return frozenset(relations)


def complete_goal(stacks: Stacks) -> Goal:
    """The goal that only ``stacks`` fulfils; what a goal image asks for (A.2.6)."""
    return Goal(
        tuple(GoalRelation(item.subject, ON, item.object) for item in sorted(up_relations(stacks)))
    )
