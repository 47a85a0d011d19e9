# SPDX-License-Identifier: Apache-2.0
"""The oracular action model M1 on stacks of names, by the rules of A.2.3."""

from __future__ import annotations

from collections.abc import Sequence

from scene_graph import Stacks, all_moves, apply_move
from scene_graph.moves import Move


class StacksModel:
    """An :class:`.interface.ActionModel` whose states are :data:`scene_graph.Stacks`."""

    def successors(self, states: Sequence[Stacks]) -> list[list[tuple[Move, Stacks]]]:
        """See :class:`.interface.ActionModel`."""
        return [
            [
                (move, apply_move(stacks, move))
                for move in all_moves(len(stacks))
                if stacks[move.source]
            ]
            for stacks in states
        ]
