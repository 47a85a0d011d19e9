# SPDX-License-Identifier: Apache-2.0
"""How blocks are taken, one file a kind; a new kind is a file and an entry in :data:`GRASPS`."""

from __future__ import annotations

from typing import Final

from scene_graph import BOX, CYLINDER, PRISM, SPHERE

from ..blocks import Block
from ..errors import InvalidPlanError
from .box import box_grasps
from .grasp import Circumstances, Grasp, GraspFunction, grasp_height
from .prism import prism_grasps
from .round import round_grasps

#: Shape -> ways to take it.
GRASPS: Final[dict[str, GraspFunction]] = {
    BOX: box_grasps,
    CYLINDER: round_grasps,
    SPHERE: round_grasps,
    PRISM: prism_grasps,
}


def choose_grasp(block: Block, circumstances: Circumstances, max_width: float) -> Grasp:
    """The preferred way to take a block that the open fingers go around, if there is one.

    Args:
        max_width: widest block that the open fingers go around [m].

    Raises:
        InvalidPlanError: if no way to take blocks of this shape is known.
    """
    if block.shape not in GRASPS:
        raise InvalidPlanError(
            f"{block.name} is a {block.shape}; there are grasps for {', '.join(GRASPS)}",
            object_name=block.name,
        )
    options = GRASPS[block.shape](block, circumstances)
    fitting = [option for option in options if option.width <= max_width]
    return (fitting or options)[0]


__all__ = [
    "GRASPS",
    "Circumstances",
    "Grasp",
    "GraspFunction",
    "box_grasps",
    "choose_grasp",
    "grasp_height",
    "prism_grasps",
    "round_grasps",
]
