# SPDX-License-Identifier: Apache-2.0
"""The executable ``sim_node``."""

from __future__ import annotations

from tamp_runtime.executable import run_module


def main() -> int:
    """Entry point of ``ros2 run sim_node sim_node``."""
    return run_module("sim_node.node")
