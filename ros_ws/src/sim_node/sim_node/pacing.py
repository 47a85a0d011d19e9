# SPDX-License-Identifier: Apache-2.0
"""Simulated time at a chosen share of the host's."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

#: Who is further behind, or ahead, does not catch up: the machine is too slow or stood still, or
#: the factor was changed [s].
_OUT_OF_STEP: Final = 0.25


class Pacer:
    """How long to wait until simulated time has come; ``clock`` gives the host's [s]."""

    def __init__(
        self, simulated: float, factor: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """``factor``: simulated seconds per second, 0 for as fast as it goes."""
        self._clock = clock
        self._factor = factor
        self._wall, self._simulated = clock(), simulated

    def change(self, simulated: float, factor: float) -> None:
        """Goes on with another factor from a simulated time [s]."""
        self._factor = factor
        self._wall, self._simulated = self._clock(), simulated

    def pause(self, simulated: float) -> float:
        """How long to wait from now before time goes on from ``simulated`` [s]; 0 if it is late."""
        if self._factor == 0.0:
            return 0.0
        ahead = (simulated - self._simulated) / self._factor - (self._clock() - self._wall)
        if ahead < -_OUT_OF_STEP:
            self._wall, self._simulated = self._clock(), simulated
        return max(ahead, 0.0)
