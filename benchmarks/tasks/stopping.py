# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C: the first lets the task that runs come to its end, a second one interrupts it."""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Iterator
from types import FrameType
from typing import Final

_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


class Stop:
    """What SIGINT and SIGTERM do to a campaign.

    Between tasks, and while a graph starts, they stop at once with KeyboardInterrupt: nothing is
    under way. While a task runs, the first one waits for its end, so that stopping costs no task;
    another SIGINT raises KeyboardInterrupt, and the task counts as interrupted. Another SIGTERM
    says nothing new: the kernel may send several to the shares of a process that was killed, one
    for each of its threads.

    Attributes:
        asked: whether somebody wants the campaign to stop.
    """

    def __init__(self) -> None:
        self.asked = False
        self._running = False

    def listen(self) -> None:
        """Takes the signals over, also where a script put this into the background."""
        for number in _SIGNALS:
            signal.signal(number, self._on_signal)

    @contextlib.contextmanager
    def task(self) -> Iterator[None]:
        """A task runs while the block does; raises KeyboardInterrupt if it shall not begin."""
        self._running = True
        try:
            self.check()
            yield
        finally:
            self._running = False

    def check(self) -> None:
        """Raises KeyboardInterrupt if somebody wants the campaign to stop."""
        if self.asked:
            raise KeyboardInterrupt

    def _on_signal(self, number: int, _frame: FrameType | None) -> None:
        first, self.asked = not self.asked, True
        if not first and number == signal.SIGTERM:
            return
        if not (first and self._running):
            raise KeyboardInterrupt
        print(
            "\nstops when this task has ended; Ctrl-C again interrupts it, and it counts as failed",
            file=sys.stderr,
        )
