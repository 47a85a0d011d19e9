# SPDX-License-Identifier: Apache-2.0
"""Triangular prisms: the fingers close on the two triangles; the other sides are slopes."""

from __future__ import annotations

import numpy as np

from scene_graph import wrap_line

from ..blocks import Block
from .grasp import Circumstances, Grasp, grasp_height


def prism_grasps(block: Block, circumstances: Circumstances) -> list[Grasp]:
    """The one way to take a prism: along its ridge, which is the second of its axes."""
    height = grasp_height(block, circumstances.gripper)
    first, second, _ = block.size
    return [Grasp(wrap_line(block.yaw + np.pi / 2), second, first, height, np.pi / 2)]
