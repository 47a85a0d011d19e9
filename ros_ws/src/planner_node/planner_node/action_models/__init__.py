# SPDX-License-Identifier: Apache-2.0
"""Action models M: what a move does to a state (4.2.2, A.2.3). The learnt ones need PyTorch."""

from .interface import ActionModel
from .observed import AmbiguousTransitionError, ObservedModel
from .on_stacks import StacksModel
from .oracular import GraphModel, apply_to_graph

__all__ = [
    "ActionModel",
    "AmbiguousTransitionError",
    "GraphModel",
    "ObservedModel",
    "StacksModel",
    "apply_to_graph",
]
