# SPDX-License-Identifier: Apache-2.0
"""What every executable does first: it listens to Ctrl-C and imports its program, which is slow.

Imports nothing heavy itself, so that Ctrl-C while the imports run ends the process in order, too.
"""

from __future__ import annotations

import importlib
import os
import signal
from types import FrameType


def run_module(name: str, function: str = "run", stopped: int = 0) -> int:
    """Calls a function of a module that is imported now, and returns its exit code.

    Args:
        stopped: the exit code if SIGINT arrives before the function handles it.
    """

    def end(_number: int, _frame: FrameType | None) -> None:
        os._exit(stopped)

    # At once, since there is nothing to tidy up yet: a KeyboardInterrupt in the middle of an import
    # is swallowed by some library, one in fifty, or leaves a module behind that is half there.
    signal.signal(signal.SIGINT, end)
    module = importlib.import_module(name)
    listen_to_interrupts()
    try:
        code: int = getattr(module, function)()
    except KeyboardInterrupt:  # stopped before there was anything to stop
        return stopped
    return code


def listen_to_interrupts() -> None:
    """Has SIGINT raise KeyboardInterrupt, even where the parent had it ignored.

    A script starts what it puts into the background so, and Python leaves it at that; but a robot
    has to stop whoever started it.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
