# SPDX-License-Identifier: Apache-2.0
"""Wall time: time-outs are measured in it, since a simulation that stops also stops its clock."""

from __future__ import annotations

import threading
import time


class Clock:
    """Reads the wall time and waits; tests put one in its place that need not wait."""

    def now(self) -> float:
        """Wall time since some moment [s]; never goes back."""
        return time.monotonic()

    def wait(self, changed: threading.Condition, seconds: float) -> None:
        """Returns when the condition, which is held, is notified or after ``seconds``."""
        changed.wait(seconds)
