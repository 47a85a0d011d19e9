# SPDX-License-Identifier: Apache-2.0
"""A stack made lower by whole blocks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scene_graph import SceneObject, base_name

from .levers import ROUNDING, Table


@dataclass(frozen=True)
class TowerLever:
    """Blocks taken off a stack; part of one is as if it were so much lower.

    Attributes:
        names: of the stack's blocks, from the highest to the lowest.
        heights: theirs [m].
    """

    index: int
    names: tuple[str, ...]
    heights: tuple[float, ...]

    @property
    def reach(self) -> tuple[float, float]:
        """See :class:`Lever`."""
        return 0.0, sum(self.heights)

    @property
    def thing(self) -> str:
        """See :class:`Lever`."""
        return "take"

    def by(self, amount: float, _table: Table) -> str:
        """See :class:`Lever`."""
        taken = self.names[: self._whole(amount)]
        return f"{', '.join(taken)} off the stack at {base_name(self.index)}"

    def pulled(self, table: Table, amount: float) -> Table:
        """See :class:`Lever`."""
        count = self._whole(amount)
        gone = set(self.names[:count])
        left = amount - sum(self.heights[:count])
        objects = [item for item in table.graph.objects if item.name not in gone]
        if left > ROUNDING and count < len(self.names):
            objects = [
                _lower(item, left) if item.name == self.names[count] else item for item in objects
            ]
        relations = {
            relation
            for relation in table.graph.relations
            if not gone & {relation.subject, relation.object}
        }
        graph = replace(table.graph, objects=tuple(objects), relations=frozenset(relations))
        return replace(table, graph=graph)

    def rounded(self, amount: float) -> float:
        """Whole blocks."""
        heights = np.cumsum(self.heights)
        return float(heights[min(int(np.searchsorted(heights, amount)), len(heights) - 1)])

    def _whole(self, amount: float) -> int:
        """How many blocks are gone."""
        return int(np.searchsorted(np.cumsum(self.heights), amount + ROUNDING, side="right"))


def _lower(item: SceneObject, by: float) -> SceneObject:
    (x, y, z), (width, depth, height) = item.position_world, item.size
    return replace(item, position_world=(x, y, z - by / 2), size=(width, depth, height - by))
