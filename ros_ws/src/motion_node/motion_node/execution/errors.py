# SPDX-License-Identifier: Apache-2.0
"""How an execution can end but for the good."""

from __future__ import annotations

from tamp_runtime.motion_report import MotionReason

from ..errors import MotionError


class ClosedError(MotionError):
    """The node ends; the trajectory that was sent goes on."""


class ExecutionError(MotionError):
    """The execution ends here; ``reason`` is what is reported.

    ``recoverable``: the arm is seen, and obeys or may obey again, so it can be sent home.
    """

    def __init__(self, reason: MotionReason, message: str, recoverable: bool = False) -> None:
        super().__init__(message)
        self.reason = reason
        self.recoverable = recoverable
