# SPDX-License-Identifier: Apache-2.0
"""What becomes of a plan, as values; :mod:`conversions` makes MotionStatus of them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class State(IntEnum):
    """The states of MotionStatus, with its numbers."""

    IDLE = 0
    OPTIMISING = 1
    EXECUTING = 2
    SUCCEEDED = 3
    CANCELLED = 4
    FAILED = 5

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen with the plan."""
        return self in (State.SUCCEEDED, State.CANCELLED, State.FAILED)


class Reason(IntEnum):
    """The reasons of MotionStatus, with its numbers."""

    NONE = 0
    INVALID_PLAN = 1
    NO_JOINT_STATES = 2
    INFEASIBLE = 3
    BUSY = 4
    TRACKING_LOST = 5
    GRASP_LOST = 6
    TIMEOUT = 7
    INTERNAL_ERROR = 8


@dataclass(frozen=True)
class Report:
    """The state of a plan at one moment; the fields are those of MotionStatus."""

    plan_id: str = ""
    state: State = State.IDLE
    reason: Reason = Reason.NONE
    message: str = ""
    bound: str = ""
    object_name: str = ""
    constraint: str = ""
    move: int = 0
    moves_done: int = 0
    moves_total: int = 0
    phase: str = ""
    progress: float = 0.0
    optimisation_seconds: float = 0.0
    duration: float = 0.0
