# SPDX-License-Identifier: Apache-2.0
"""One planner for all tests of the package: building it takes a moment."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pybullet_data
import pytest

from motion_node.nlp import compiled
from motion_node.planner import MotionPlanner


@contextmanager
def nothing_compiles_in_the_background() -> Iterator[None]:
    """Solutions do not change in the middle of a test, be it by their last digit.

    Only here: nodes that other tests run in this process go on while something compiles.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled.MachineCode, "compile_later", compiled.MachineCode.come)
        yield


@pytest.fixture(scope="module", autouse=True)
def _nothing_compiles_in_the_background() -> Iterator[None]:
    with nothing_compiles_in_the_background():
        yield


@pytest.fixture(scope="session")
def urdf() -> str:
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def planner(urdf: str) -> MotionPlanner:
    with nothing_compiles_in_the_background():
        return MotionPlanner(urdf)
