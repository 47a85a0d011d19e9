# SPDX-License-Identifier: Apache-2.0
"""How a client that people type is ended: Ctrl-C, SIGTERM, a closed terminal, a closed pipe."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, Final, TextIO

#: Ctrl-C, what ``kill`` and ``timeout`` send, and what a terminal sends when it is closed.
SIGNALS: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class InterruptedBySignalError(KeyboardInterrupt):
    """One of ``SIGNALS`` has come; ``exit_code`` is what a shell expects then."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.exit_code = 128 + number


def listen_to_signals() -> None:
    """Has each of ``SIGNALS`` raise InterruptedBySignalError in the main thread.

    SIGHUP stays ignored where the parent had it so: ``nohup`` means it.
    """

    def interrupt(number: int, _frame: FrameType | None) -> None:
        # What is being made at this moment stays half-made; its end is nothing to complain of.
        sys.unraisablehook = _nothing
        raise InterruptedBySignalError(number)

    for number in SIGNALS:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, interrupt)


def _nothing(_unraisable: Any) -> None:
    """Says nothing."""


@contextmanager
def terminal_may_close() -> Iterator[None]:
    """Meanwhile SIGHUP does nothing: kernel and shell send one each when a terminal is closed."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGHUP, before)


def exit_code(interrupt: KeyboardInterrupt) -> int:
    """The exit code of a program that was interrupted."""
    return getattr(interrupt, "exit_code", 128 + signal.SIGINT)


def say(text: str, stream: TextIO | None = None) -> None:
    """Prints a line on stderr; into a terminal that is not there any more, nothing is said."""
    stream = stream or sys.stderr
    try:
        print(text, file=stream, flush=True)
    except OSError:
        mute(stream)


def mute(stream: TextIO) -> None:
    """Has a stream whose reader has gone swallow what is written from now on."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, stream.fileno())
    os.close(nothing)
