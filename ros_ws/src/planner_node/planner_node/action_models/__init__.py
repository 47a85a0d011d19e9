# SPDX-License-Identifier: Apache-2.0
"""Action models M: what a move does to a scene graph (A.2.3)."""

from collections.abc import Callable

from scene_graph import Move, Relation

from .oracular import apply_to_graph

#: The relations after a move, from those before it; raises ImpossibleMoveError.
ActionModel = Callable[[frozenset[Relation], Move], frozenset[Relation]]

__all__ = ["ActionModel", "apply_to_graph"]
