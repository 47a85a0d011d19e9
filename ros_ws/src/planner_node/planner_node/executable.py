# SPDX-License-Identifier: Apache-2.0
"""The executable ``planner_node``."""

from __future__ import annotations

from tamp_runtime.executable import run_module


def main() -> int:
    """Entry point of ``ros2 run planner_node planner_node``."""
    return run_module("planner_node.node")
