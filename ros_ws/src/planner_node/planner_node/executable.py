# SPDX-License-Identifier: Apache-2.0
"""The executables: ``planner_node``, and the clients that people type."""

from __future__ import annotations

from tamp_runtime.executable import run_module


def planner_node() -> int:
    """Entry point of ``ros2 run planner_node planner_node``."""
    return run_module("planner_node.node")


def plan_to_goal() -> int:
    """Entry point of ``ros2 run planner_node plan_to_goal``."""
    return run_module("planner_node.cli.commands", "plan_to_goal", stopped=130)


def achieve_goal() -> int:
    """Entry point of ``ros2 run planner_node achieve_goal``."""
    return run_module("planner_node.cli.commands", "achieve_goal", stopped=130)


def stop() -> int:
    """Entry point of ``ros2 run planner_node stop``."""
    return run_module("planner_node.cli.stop", "stop", stopped=130)


def write_pddl() -> int:
    """Entry point of ``ros2 run planner_node write_pddl``."""
    return run_module("planner_node.cli.write_pddl", "write_pddl", stopped=130)
