# SPDX-License-Identifier: Apache-2.0
"""Scene graphs: objects and relations (3.2), with bases a complete symbolic state (A.2.2)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from .objects import SceneObject
from .relations import Relation
from .stacks import Stacks, stacks_from_relations


@dataclass(frozen=True)
class Base:
    """A place: index from the left from 0, and its centre on the table's surface [m]."""

    index: int
    position_world: tuple[float, float, float]


@dataclass(frozen=True)
class SceneGraph:
    """Objects, relations and bases; ``confidence`` is the minimum over objects (A.2.5)."""

    objects: tuple[SceneObject, ...]
    relations: frozenset[Relation]
    bases: tuple[Base, ...] = ()
    confidence: float = 1.0

    def __post_init__(self) -> None:
        names = [item.name for item in self.objects]
        if len(set(names)) != len(names):
            raise ValueError(f"object names are not unique: {', '.join(sorted(names))}")

    @property
    def names(self) -> tuple[str, ...]:
        """The objects' names, in the order of ``objects``."""
        return tuple(item.name for item in self.objects)

    def object(self, name: str) -> SceneObject:
        """The object of that name; raises KeyError."""
        for item in self.objects:
            if item.name == name:
                return item
        raise KeyError(name)

    def stacks(self) -> Stacks:
        """The state that the relations describe; see :func:`stacks_from_relations`."""
        return stacks_from_relations(self.relations, len(self.bases))


def format_relations(relations: Iterable[Relation]) -> str:
    """Sorted and comma separated, for logs and pictures."""
    return ", ".join(str(relation) for relation in sorted(relations))
