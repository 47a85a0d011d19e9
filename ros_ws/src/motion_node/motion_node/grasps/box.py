# SPDX-License-Identifier: Apache-2.0
"""Boxes: the fingers close on opposite faces."""

from __future__ import annotations

import numpy as np

from scene_graph import wrap_line

from ..blocks import Block
from .grasp import Circumstances, Grasp, grasp_height


def box_grasps(block: Block, circumstances: Circumstances) -> list[Grasp]:
    """The two ways to close the fingers on opposite faces, the one nearest to world x first.

    The hand is long in the direction of its fingers, and the stacks stand along y: with the
    fingers along x it does not sweep the neighbouring stacks.
    """
    height = grasp_height(block, circumstances.gripper)
    first, second, _ = block.size
    along_x = Grasp(wrap_line(block.yaw), first, second, height, 0.0)
    along_y = Grasp(wrap_line(block.yaw + np.pi / 2), second, first, height, np.pi / 2)
    # Among equals the first axis wins: a tie must not be decided by rounding.
    return sorted((along_x, along_y), key=lambda grasp: round(abs(grasp.yaw), 3))
