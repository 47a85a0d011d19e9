# SPDX-License-Identifier: Apache-2.0
"""The robot's URDF, with mesh paths that every node on this machine can open."""

from __future__ import annotations

import re

from .simulated_arms import PANDA, SimulatedArm


def robot_description(arm: SimulatedArm = PANDA) -> str:
    """URDF text; ``package://`` of pybullet's data becomes absolute ``file://``.

    Raises:
        OSError: if the arm's URDF cannot be read.
    """
    text = arm.urdf.read_text(encoding="utf-8")
    return re.sub(r'filename="(?:package://)?', f'filename="file://{arm.urdf.parent}/', text)
