# SPDX-License-Identifier: Apache-2.0
"""How fast the clock of the arm's driver runs against this machine's."""

from __future__ import annotations

from collections import deque
from typing import Final

#: Over how much of this machine's time it is measured, and the least that tells anything [s].
_LONGEST: Final = 2.0
_SHORTEST: Final = 0.2


class ClockRate:
    """Seconds of the driver's clock a second of this machine's; 1 until it is known."""

    def __init__(self) -> None:
        self._heard: deque[tuple[float, float]] = deque()
        self.value = 1.0

    def hear(self, stamp: float, received: float) -> None:
        """Takes in a stamp and when it arrived [s]; one that goes back begins anew."""
        heard = self._heard
        if heard and stamp < heard[-1][0]:
            heard.clear()
        heard.append((stamp, received))
        while received - heard[0][1] > _LONGEST and len(heard) > 2:
            heard.popleft()
        lived = received - heard[0][1]
        if lived >= _SHORTEST:
            self.value = (stamp - heard[0][0]) / lived
