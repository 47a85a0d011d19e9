# SPDX-License-Identifier: Apache-2.0
"""Relations: the edges of a scene graph (3.2), and the conditions of a goal (5.2.2)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from .predicates import PREDICATES, Spot


@dataclass(frozen=True, order=True)
class Relation:
    """A triple (subject, predicate, object); ``red_box up blue_box`` reads "red on blue".

    Raises:
        ValueError: the predicate is not one of :data:`PREDICATES`.
    """

    subject: str
    predicate: str
    object: str

    def __post_init__(self) -> None:
        if self.predicate not in PREDICATES:
            raise ValueError(
                f"unknown predicate {self.predicate!r}; known: {', '.join(PREDICATES)}"
            )

    def __str__(self) -> str:
        return f"{self.subject} {self.predicate} {self.object}"

    @property
    def words(self) -> str:
        """The relation as people say it: ``red_box on blue_box``."""
        return f"{self.subject} {PREDICATES[self.predicate].words} {self.object}"

    def renamed(self, names: Mapping[str, str]) -> Relation:
        """The same of blocks that are called otherwise."""
        subject, object_ = names.get(self.subject), names.get(self.object)
        if subject is None and object_ is None:
            return self
        return Relation(subject or self.subject, self.predicate, object_ or self.object)

    def holds(self, spots: Mapping[str, Spot]) -> bool:
        """Whether a state fulfils it; what is not there fulfils nothing.

        Args:
            spots: where everything is, see :func:`scene_graph.spots_of`.
        """
        subject, object_ = spots.get(self.subject), spots.get(self.object)
        if subject is None or object_ is None:
            return False
        return PREDICATES[self.predicate].holds(subject, object_)


def format_relations(relations: Iterable[Relation]) -> str:
    """Sorted and comma separated, for logs and pictures."""
    return ", ".join(str(relation) for relation in sorted(relations))
