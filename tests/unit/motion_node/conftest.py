# SPDX-License-Identifier: Apache-2.0
"""One planner for all tests of the package: building it takes a moment."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pybullet_data
import pytest

from motion_node.nlp import compiled
from motion_node.planner import MotionPlanner


@pytest.fixture(scope="session", autouse=True)
def _nothing_compiles_in_the_background() -> Iterator[None]:
    """Solutions do not change in the middle of a test, be it by their last digit."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled.MachineCode, "compile_later", compiled.MachineCode.come)
        yield


@pytest.fixture(scope="session")
def urdf() -> str:
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def planner(urdf: str) -> MotionPlanner:
    return MotionPlanner(urdf)
