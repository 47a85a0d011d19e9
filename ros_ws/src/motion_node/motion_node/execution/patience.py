# SPDX-License-Identifier: Apache-2.0
"""Waiting for joint states: what passes is waited out, and said; what does not pass is an error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from tamp_runtime.motion_report import MotionReason

from .arm_state import ArmState, ArmStates
from .errors import ClosedError, ExecutionError

#: What has been awaited for this long is said [s].
NOTICE_SECONDS: Final = 3.0
#: Between two looks whether to go on waiting [s].
_SLICE: Final = 0.1


class Patience:
    """One wait, or a row of waits, for news of the arm.

    Args:
        timeout: silence of the joint states, or a standstill of their stamps, that is too long, in
            time that this process lives through [s].
        on_waiting: told a sentence once something has been awaited for a while, and an empty one
            when it is there.
    """

    def __init__(self, arm: ArmStates, timeout: float, on_waiting: Callable[[str], None]) -> None:
        self._arm, self._timeout, self._on_waiting = arm, timeout, on_waiting
        self._heard = self._moved = arm.now()
        self._stamp: float | None = None
        self._said = False

    def wait(self, after: ArmState | None) -> ArmState:
        """The first state that differs from ``after``.

        Raises:
            ExecutionError: if joint states stay out, or their stamps stand still.
            ClosedError: if the node ends.
        """
        while (state := self.next_state(after)) is None:
            pass
        return state

    def next_state(self, after: ArmState | None) -> ArmState | None:
        """The same, but None if it does not come soon."""
        news = self._arm.wait(after, _SLICE)
        if self._arm.closed:
            raise ClosedError("the node ends")
        now = self._arm.now()
        if news is not None:
            self._heard = now
            if news.stamp != self._stamp:
                self._stamp, self._moved = news.stamp, now
                self.over()
                return news
        if now - self._heard > self._timeout:
            raise silence(self._arm, self._timeout)
        if news is not None and now - self._moved > self._timeout:
            raise ExecutionError(
                MotionReason.TIMEOUT,
                f"the joint states' time has stood still for {self._timeout:g} s; is the clock "
                "running?",
            )
        if now - min(self._heard, self._moved) > NOTICE_SECONDS and not self._said:
            self._said = True
            silent = now - self._heard > NOTICE_SECONDS
            missing = "joint_states" if silent else "joint_states whose time goes on"
            self._on_waiting(f"waiting for {self._arm.problem or missing}")
        return news

    def over(self) -> None:
        """What was awaited is there."""
        if self._said:
            self._said = False
            self._on_waiting("")


def silence(arm: ArmStates, seconds: float) -> ExecutionError:
    """No joint states that can be used for so long [s]; says what is wrong with those that come."""
    if arm.problem:
        sentence = f"{arm.problem}, for {seconds:g} s; repair the arm's driver"
    else:
        sentence = f"no joint_states for {seconds:g} s; is the arm's driver (or sim_node) running?"
    return ExecutionError(MotionReason.NO_JOINT_STATES, sentence)
