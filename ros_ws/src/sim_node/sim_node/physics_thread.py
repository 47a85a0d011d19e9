# SPDX-License-Identifier: Apache-2.0
"""The one thread that owns the physics, and what others learn when it dies or stands still."""

from __future__ import annotations

import queue
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future
from typing import Final, TypeVar

#: How often whoever waits for the physics looks whether it still goes on [s].
POLL_SECONDS: Final = 0.1
#: It hangs when it gets nothing done during so many looks in a row. They are counted, not timed: a
#: process that was suspended for a minute, and continued, has not hung.
HUNG_AFTER_POLLS: Final = 100

Result = TypeVar("Result")


class PhysicsError(RuntimeError):
    """The physics does not answer; the sentence says why and what can be done."""


class PhysicsThread:
    """Takes turns in a thread of its own, and in between calls what others hand to it.

    Args:
        turn: advances the world.
        pause: until the next turn [s]; asked again after each call. Not above 0: go on.
        on_error: told the traceback of what was posted and failed; the world goes on.
        on_death: told the traceback of a turn that failed, after which there is no other.
    """

    def __init__(
        self,
        turn: Callable[[], None],
        pause: Callable[[], float],
        on_error: Callable[[str], None],
        on_death: Callable[[str], None],
    ) -> None:
        self._turn, self._pause = turn, pause
        self._on_error, self._on_death = on_error, on_death
        self._calls: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._idle_polls = 0
        self._failure = ""
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="physics", daemon=True)

    @property
    def failure(self) -> str:
        """Why there will be no further turn; empty as long as it lives."""
        return self._failure

    def start(self) -> None:
        """Begins with the turns."""
        self._thread.start()

    def stop(self, timeout: float = 5.0) -> None:
        """Ends the thread after the turn that it is in, or leaves it alone after a time [s]."""
        self._stopping.set()
        self.post(lambda: None)  # wakes it from a pause
        self._thread.join(timeout)

    def post(self, function: Callable[[], None]) -> None:
        """Has a function called between two turns; any thread may ask."""
        self._calls.put(function)

    def call(self, function: Callable[[], Result]) -> Result:
        """Has a function called between two turns, and returns or raises what it does.

        Raises:
            PhysicsError: the thread has died, stops or hangs; the function is not called later.
        """
        answer: Future[Result] = Future()

        def answered() -> None:
            if not answer.set_running_or_notify_cancel():
                return
            try:
                answer.set_result(function())
            except Exception as error:
                answer.set_exception(error)

        self.post(answered)
        while True:
            try:
                return answer.result(POLL_SECONDS)
            except TimeoutError:
                if answer.done():
                    return answer.result()  # or its own TimeoutError
            if not (reason := self._reason_not_to_wait()):
                continue
            if answer.cancel():
                raise PhysicsError(reason)
            if not answer.done():  # it is in there, and perhaps for ever
                raise PhysicsError(f"{reason}; it may still take effect")

    def _reason_not_to_wait(self) -> str:
        if self._failure:
            return f"the physics has stopped ({self._failure}); start sim_node anew"
        if self._stopping.is_set():
            return "the simulator is being stopped"
        self._idle_polls += 1
        if self._idle_polls >= HUNG_AFTER_POLLS:
            return (
                f"the physics has not moved for {HUNG_AFTER_POLLS * POLL_SECONDS:g} s; if the "
                "machine is not merely busy, start sim_node anew"
            )
        return ""

    def _run(self) -> None:
        try:
            while not self._stopping.is_set():
                self._turn()
                self._idle_polls = 0
                self._answer()
        except Exception as error:
            if not self._stopping.is_set():
                self._failure = f"{type(error).__name__}: {error}"
                self._on_death(traceback.format_exc())

    def _answer(self) -> None:
        """Calls what was posted, until it is time for the next turn."""
        while not self._stopping.is_set():
            pause = self._pause()
            try:
                function = self._calls.get(pause > 0.0, max(pause, 0.0))
            except queue.Empty:
                return
            try:
                function()
            except Exception:
                self._on_error(traceback.format_exc())
            self._idle_polls = 0
