# SPDX-License-Identifier: Apache-2.0
"""Relations: the edges of a scene graph (3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

UP: Final = "up"
LEFT: Final = "left"
FRONT: Final = "front"
PREDICATES: Final = (UP, LEFT, FRONT)


@dataclass(frozen=True, order=True)
class Relation:
    """A triple (subject, predicate, object); ``red_box up blue_box`` reads "red on blue"."""

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
