# SPDX-License-Identifier: Apache-2.0
"""The executable ``perception_node``."""

from __future__ import annotations

from tamp_runtime.executable import run_module


def main() -> int:
    """Entry point of ``ros2 run perception_node perception_node``."""
    return run_module("perception_node.node")
