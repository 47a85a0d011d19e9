# SPDX-License-Identifier: Apache-2.0
"""One planner for all tests of the package: building it takes a moment."""

from __future__ import annotations

from pathlib import Path

import pybullet_data
import pytest

from motion_node.planner import MotionPlanner


@pytest.fixture(scope="session")
def urdf() -> str:
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def planner(urdf: str) -> MotionPlanner:
    return MotionPlanner(urdf)
