# SPDX-License-Identifier: Apache-2.0
"""The executables ``sim_node``, ``render_dataset``, ``disturb``."""

from __future__ import annotations

from tamp_runtime.executable import end_process, run_module


def sim_node() -> None:
    """Entry point of ``ros2 run sim_node sim_node``."""
    end_process(run_module("sim_node.node"))


def render_dataset() -> int:
    """Entry point of ``ros2 run sim_node render_dataset``."""
    return run_module("sim_node.data_sets", "main", stopped=130)


def disturb() -> int:
    """Entry point of ``ros2 run sim_node disturb``."""
    return run_module("sim_node.cli.disturb", "disturb", stopped=130)
