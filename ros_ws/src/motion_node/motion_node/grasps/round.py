# SPDX-License-Identifier: Apache-2.0
"""Cylinders and spheres: any direction of the fingers is as good as any other for the block."""

from __future__ import annotations

import numpy as np

from ..blocks import Block
from .grasp import Circumstances, Grasp, grasp_height


def round_grasps(block: Block, circumstances: Circumstances) -> list[Grasp]:
    """The direction that is best for the neighbouring stacks, then along world x and y."""
    height = grasp_height(block, circumstances.gripper)
    diameter = max(block.size[:2])
    yaws = (circumstances.free_yaw, 0.0, np.pi / 2)
    return [Grasp(yaw, diameter, diameter, height, 0.0) for yaw in yaws]
