# SPDX-License-Identifier: Apache-2.0
"""The executable ``motion_node``."""

from __future__ import annotations

from tamp_runtime.executable import run_module


def motion_node() -> int:
    """Entry point of ``ros2 run motion_node motion_node``."""
    return run_module("motion_node.node")
