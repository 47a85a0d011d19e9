# SPDX-License-Identifier: Apache-2.0
"""The vocabulary of the project as plain Python: objects, relations, stacks, moves."""

from .errors import ImpossibleMoveError, InconsistentRelationsError, SceneGraphError
from .graph import Base, SceneGraph, format_relations
from .moves import Move, all_moves
from .objects import (
    BOX,
    COLORS,
    CYLINDER,
    SHAPES,
    SPHERE,
    SceneObject,
    object_name,
    split_object_name,
)
from .relations import FRONT, LEFT, PREDICATES, UP, Relation
from .stacks import (
    Stacks,
    apply_move,
    base_index,
    base_name,
    format_stacks,
    left_relations,
    stacks_from_relations,
    up_relations,
)

__all__ = [
    "BOX",
    "COLORS",
    "CYLINDER",
    "FRONT",
    "LEFT",
    "PREDICATES",
    "SHAPES",
    "SPHERE",
    "UP",
    "Base",
    "ImpossibleMoveError",
    "InconsistentRelationsError",
    "Move",
    "Relation",
    "SceneGraph",
    "SceneGraphError",
    "SceneObject",
    "Stacks",
    "all_moves",
    "apply_move",
    "base_index",
    "base_name",
    "format_relations",
    "format_stacks",
    "left_relations",
    "object_name",
    "split_object_name",
    "stacks_from_relations",
    "up_relations",
]
