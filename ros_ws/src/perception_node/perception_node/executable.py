# SPDX-License-Identifier: Apache-2.0
"""The executable ``perception_node``: loads the node, which takes seconds, and runs it."""

from __future__ import annotations


def main() -> int:
    """Entry point of ``ros2 run perception_node perception_node``."""
    try:
        from .node import run
    except KeyboardInterrupt:  # stopped before there was anything to stop
        return 0
    return run()
