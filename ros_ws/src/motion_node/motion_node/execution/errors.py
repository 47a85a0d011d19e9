# SPDX-License-Identifier: Apache-2.0
"""How an execution can end but for the good."""

from __future__ import annotations

from typing import Any

from tamp_runtime.motion_report import MotionReason

from ..errors import InfeasibleError, InvalidPlanError, MotionError


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


def findings(error: MotionError, moves: int) -> dict[str, Any]:
    """What a report says of an error besides its sentence, by the report's fields.

    Args:
        moves: how many the plan has.
    """
    if isinstance(error, InvalidPlanError):
        return {
            "reason": MotionReason.INVALID_PLAN,
            "object_name": error.object_name,
            "move": max(error.move, 0),
        }
    if isinstance(error, InfeasibleError):
        return {
            "reason": MotionReason.INFEASIBLE,
            "bound": error.bound,
            "object_name": error.object_name,
            "constraint": error.constraint,
            "violation": error.violation,
            "excludes": error.excludes,
            "suggestion": error.suggestion,
            "move": min(error.move, max(moves - 1, 0)),
            "phase": error.phase,
        }
    reason = error.reason if isinstance(error, ExecutionError) else MotionReason.INTERNAL_ERROR
    return {"reason": reason}
