# SPDX-License-Identifier: Apache-2.0
"""The robot's URDF, with mesh paths that every node on this machine can open."""

from __future__ import annotations

import re

from .world import URDF_PATH


def robot_description() -> str:
    """URDF text; ``package://`` of pybullet's data becomes absolute ``file://``."""
    text = URDF_PATH.read_text(encoding="utf-8")
    return re.sub(r'filename="(?:package://)?', f'filename="file://{URDF_PATH.parent}/', text)
