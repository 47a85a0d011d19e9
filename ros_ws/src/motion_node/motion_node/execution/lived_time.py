# SPDX-License-Identifier: Apache-2.0
"""Time as this process lives through it: what it was stopped for does not count."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

#: Between two looks at the clock more than this has not been lived through [s]. The node looks at
#: least once a second, so a longer gap means that the process stood still: it was stopped, or its
#: machine was.
LONGEST_GAP: Final = 1.5


class LivedTime:
    """A clock that never goes back, and goes on by no more than ``LONGEST_GAP`` at once.

    A process that is continued after a stop finds that its deadlines have passed, though what it
    waited for had no time to come. By this clock they have not.

    Args:
        clock: the time [s]; never goes back.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._seen = self._lived = clock()

    def __call__(self) -> float:
        """The time [s]; any thread may ask."""
        with self._lock:
            now = self._clock()
            self._lived += min(now - self._seen, LONGEST_GAP)
            self._seen = now
            return self._lived
