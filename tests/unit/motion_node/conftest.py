# SPDX-License-Identifier: Apache-2.0
"""One optimiser for all tests of the package: building it takes a moment."""

from __future__ import annotations

from pathlib import Path

import pybullet_data
import pytest

from motion_node.features import Features
from motion_node.optimiser import MotionOptimiser


@pytest.fixture(scope="session")
def urdf() -> str:
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def optimiser(urdf: str) -> MotionOptimiser:
    return MotionOptimiser(urdf)


@pytest.fixture(scope="session")
def features(optimiser: MotionOptimiser) -> Features:
    """For three stacks."""
    return optimiser.prepare(3)[0].features
