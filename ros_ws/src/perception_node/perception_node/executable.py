# SPDX-License-Identifier: Apache-2.0
"""The executables ``perception_node``, ``train_visual`` and ``train_masks``."""

from __future__ import annotations

from tamp_runtime.executable import end_process, run_module


def perception_node() -> None:
    """Entry point of ``ros2 run perception_node perception_node``."""
    end_process(run_module("perception_node.node"))


def train_visual() -> int:
    """Entry point of ``ros2 run perception_node train_visual``."""
    return run_module("perception_node.training.train_visual", "main", stopped=130)


def train_masks() -> int:
    """Entry point of ``ros2 run perception_node train_masks``."""
    return run_module("perception_node.training.train_masks", "main", stopped=130)
