# SPDX-License-Identifier: Apache-2.0
"""What an executable does first: it imports the node, which takes seconds, and runs it.

Imports nothing heavy itself, so that Ctrl-C while the imports run ends the process in order, too.
"""

from __future__ import annotations

import importlib


def run_module(name: str) -> int:
    """Calls ``run`` of a module and returns its exit code; 0 if it is stopped before it runs."""
    try:
        code: int = importlib.import_module(name).run()
    except KeyboardInterrupt:  # stopped before there was anything to stop
        return 0
    return code
