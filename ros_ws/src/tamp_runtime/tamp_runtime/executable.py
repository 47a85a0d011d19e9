# SPDX-License-Identifier: Apache-2.0
"""What every executable does first: it listens to Ctrl-C and imports its program, which is slow.

Imports nothing heavy itself, so that Ctrl-C while the imports run ends the process in order, too.
"""

from __future__ import annotations

import importlib
import signal


def run_module(name: str, function: str = "run", stopped: int = 0) -> int:
    """Calls a function of a module that is imported now, and returns its exit code.

    Args:
        stopped: the exit code if SIGINT arrives before the function handles it.
    """
    listen_to_interrupts()
    try:
        code: int = getattr(importlib.import_module(name), function)()
    except KeyboardInterrupt:  # stopped before there was anything to stop
        return stopped
    return code


def listen_to_interrupts() -> None:
    """Has SIGINT raise KeyboardInterrupt, even where the parent had it ignored.

    A script starts what it puts into the background so, and Python leaves it at that; but a robot
    has to stop whoever started it.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
