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


def grasps_for(block: Block, circumstances: Circumstances, max_width: float) -> list[Grasp]:
    """The ways to take a block that the open fingers go around, the preferred one first.

    If they go around it in no way, all ways, so that the first can be told about.

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
    return fitting or options


def choose_grasp(block: Block, circumstances: Circumstances, max_width: float) -> Grasp:
    """The preferred one of :func:`grasps_for`."""
    return grasps_for(block, circumstances, max_width)[0]


__all__ = [
    "GRASPS",
    "Circumstances",
    "Grasp",
    "GraspFunction",
    "box_grasps",
    "choose_grasp",
    "grasp_height",
    "grasps_for",
    "prism_grasps",
    "round_grasps",
]
