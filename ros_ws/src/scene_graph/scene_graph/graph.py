# SPDX-License-Identifier: Apache-2.0
"""Scene graphs: objects and relations (3.2), with bases a complete symbolic state (A.2.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import IntEnum

from .errors import InconsistentRelationsError
from .objects import SceneObject
from .places import Place
from .predicates import FRONT
from .relations import Relation
from .rows import front_relations, rows_of
from .stacks import Stacks, stacks_from_relations


class GraphStatus(IntEnum):
    """Whether a scene graph can be planned on, and if not, why; numbers as in its message."""

    CONFIDENT = 0
    LOW_CONFIDENCE = 1
    OCCLUDED = 2
    UNSTABLE = 3
    NO_OBJECTS = 4
    BAD_IMAGE = 5
    HIDDEN = 6
    DOUBTFUL = 7
    NO_PLACES = 8

    @property
    def sees_all(self) -> bool:
        """Whether all blocks are seen, and stand as the graph says."""
        return self in (GraphStatus.CONFIDENT, GraphStatus.DOUBTFUL)


@dataclass(frozen=True)
class SceneGraph:
    """Objects, relations and places; ``confidence`` is the minimum over objects (A.2.5)."""

    objects: tuple[SceneObject, ...]
    relations: frozenset[Relation]
    places: tuple[Place, ...] = ()
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

    def renamed(self, names: Mapping[str, str]) -> SceneGraph:
        """The same with other names for some objects."""
        if not names:
            return self
        objects = [replace(item, name=names.get(item.name, item.name)) for item in self.objects]
        relations = (item.renamed(names) for item in self.relations)
        ordered = tuple(sorted(objects, key=lambda item: item.name))
        return replace(self, objects=ordered, relations=frozenset(relations))

    def stacks(self) -> Stacks:
        """The state that the relations describe; see :func:`stacks_from_relations`.

        Raises:
            InconsistentRelationsError: also where there are two rows and the front-relations are
                not those of the stacks (5.4.3).
        """
        stacks = stacks_from_relations(self.relations, len(self.places))
        told = {item for item in self.relations if item.predicate == FRONT}
        odd = told ^ front_relations(stacks, rows_of(self.places))
        if odd and told:
            example = min(odd)
            raise InconsistentRelationsError(
                f"'{example.words}' does not fit what stands on the places",
                (example.subject, example.object),
            )
        return stacks
