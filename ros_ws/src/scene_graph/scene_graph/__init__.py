# SPDX-License-Identifier: Apache-2.0
"""The vocabulary of the project as plain Python: objects, places, relations, stacks, moves."""

from .errors import ImpossibleMoveError, InconsistentRelationsError, SceneGraphError
from .graph import GraphStatus, SceneGraph
from .hidden import HIDDEN, hidden_name, hidden_places, is_hidden
from .moves import Move, all_moves
from .objects import (
    BASIC_COLORS,
    BOX,
    COLORS,
    CYLINDER,
    FLAT_TOPPED,
    PRISM,
    SHAPES,
    SPHERE,
    SceneObject,
    object_name,
    split_object_name,
)
from .places import ROW_OF_THREE, Place, base_index, base_name
from .poses import BlockPose, quaternion_from_yaw, rotation_from_quaternion, wrap_line
from .predicates import (
    ABOVE,
    BESIDE,
    FRONT,
    LEFT,
    NOT,
    PREDICATES,
    UP,
    Phrase,
    Predicate,
    Predicates,
    Spot,
)
from .relations import Relation, format_relations
from .rows import ONE_ROW, Rows, front_relations, in_rows, rows_of
from .stacks import (
    Stacks,
    apply_move,
    format_stacks,
    left_relations,
    spots_of,
    stacks_from_relations,
    up_relations,
)

__all__ = [
    "ABOVE",
    "BASIC_COLORS",
    "BESIDE",
    "BOX",
    "COLORS",
    "CYLINDER",
    "FLAT_TOPPED",
    "FRONT",
    "HIDDEN",
    "LEFT",
    "NOT",
    "ONE_ROW",
    "PREDICATES",
    "PRISM",
    "ROW_OF_THREE",
    "SHAPES",
    "SPHERE",
    "UP",
    "BlockPose",
    "GraphStatus",
    "ImpossibleMoveError",
    "InconsistentRelationsError",
    "Move",
    "Phrase",
    "Place",
    "Predicate",
    "Predicates",
    "Relation",
    "Rows",
    "SceneGraph",
    "SceneGraphError",
    "SceneObject",
    "Spot",
    "Stacks",
    "all_moves",
    "apply_move",
    "base_index",
    "base_name",
    "format_relations",
    "format_stacks",
    "front_relations",
    "hidden_name",
    "hidden_places",
    "in_rows",
    "is_hidden",
    "left_relations",
    "object_name",
    "quaternion_from_yaw",
    "rotation_from_quaternion",
    "rows_of",
    "split_object_name",
    "spots_of",
    "stacks_from_relations",
    "up_relations",
    "wrap_line",
]
