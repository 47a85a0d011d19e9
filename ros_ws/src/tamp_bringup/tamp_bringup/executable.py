# SPDX-License-Identifier: Apache-2.0
"""The executable ``demo``."""

from __future__ import annotations

from tamp_runtime.executable import run_module


def demo() -> int:
    """Entry point of ``ros2 run tamp_bringup demo``."""
    return run_module("tamp_bringup.demo", "main", stopped=130)
