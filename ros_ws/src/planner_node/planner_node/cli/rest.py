# SPDX-License-Identifier: Apache-2.0
"""When an arm that was asked to stop rests, judged by what the motion node reports."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

from tamp_interfaces.msg import MotionStatus

#: Reports that agree on rest over this time are believed: one alone may have been on its way
#: before the request. The motion node beats once a second [s].
CALM_SECONDS: Final = 0.8

_RUNNING: Final = (MotionStatus.OPTIMISING, MotionStatus.EXECUTING)
_ENDED: Final = (MotionStatus.SUCCEEDED, MotionStatus.CANCELLED, MotionStatus.FAILED)


class RestWatch:
    """Follows the reports from the request on; ``clock`` gives the time [s]. For any thread."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._heard = clock()
        self._running = ""
        self._asked = False
        self._calm: tuple[float, float] | None = None
        self.last: MotionStatus | None = None
        self.ended: MotionStatus | None = None

    def start(self) -> None:
        """The request has been sent: what is heard from now on counts."""
        with self._lock:
            self._asked, self._calm, self._heard = True, None, self._clock()

    def hear(self, status: MotionStatus) -> None:
        """A report, in order."""
        with self._lock:
            self.last, self._heard = status, self._clock()
            if status.state in _RUNNING:
                self._running, self.ended = status.plan_id, None
            elif status.state in _ENDED and self._running == status.plan_id:
                self.ended = status
            if not self._asked or status.state in _RUNNING or self._moves(status):
                self._calm = None
            else:
                since = self._calm[0] if self._calm else self._heard
                self._calm = (since, self._heard)

    @property
    def at_rest(self) -> bool:
        """Whether the motion node has gone on saying that nothing moves."""
        with self._lock:
            return self._calm is not None and self._calm[1] - self._calm[0] >= CALM_SECONDS

    def silence(self) -> float:
        """How long nothing was heard, from the request on [s]."""
        with self._lock:
            return self._clock() - self._heard

    @staticmethod
    def _moves(status: MotionStatus) -> bool:
        return bool(status.arm == MotionStatus.ARM_MOVING)
