# SPDX-License-Identifier: Apache-2.0
"""Conditions that count only once they have been true for a while."""

from __future__ import annotations


class Lasting:
    """Whether a condition has been true for some time [s]; silence counts as a moment."""

    #: The most that passes from one joint state to the next [s].
    LONGEST_STEP = 0.1

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._last: float | None = None
        self._for = 0.0

    def lasts(self, condition: bool, stamp: float) -> bool:
        """Whether the condition has been true at all stamps for so long."""
        if not condition:
            self._last, self._for = None, 0.0
            return False
        if self._last is not None:
            self._for += min(max(0.0, stamp - self._last), self.LONGEST_STEP)
        self._last = stamp
        return self._for >= self._seconds - 1e-9
