# SPDX-License-Identifier: Apache-2.0
"""What becomes of a plan that is carried out: MotionStatus as a plain value."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import Final


class MotionState(IntEnum):
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
        return self in (MotionState.SUCCEEDED, MotionState.CANCELLED, MotionState.FAILED)


class MotionReason(IntEnum):
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
    CONFLICT = 9
    OBSTRUCTED = 10
    UNSEEN = 11


class ObstaclesHeard(IntEnum):
    """What became of the newest message on obstacles, with the numbers of MotionStatus."""

    TAKEN = 0
    INVALID = 1
    UNKNOWN_FRAME = 2
    TOO_MANY = 3


class ArmPlace(IntEnum):
    """How the arm is, with the numbers of MotionStatus."""

    UNKNOWN = 0
    HOME = 1
    RESTING = 2
    MOVING = 3


class Excludes(str, Enum):
    """What of a move cannot be, with the words of MotionStatus."""

    TAKING = "taking"
    PUTTING = "putting"
    MOVING = "moving"
    SCENE = "scene"


#: What is held where the fingers hold something that the motion node did not pick.
SOMETHING: Final = "?"


@dataclass(frozen=True)
class MotionReport:
    """The state of a plan at one moment.

    The fields are those of MotionStatus; ``stamp`` is its header's [ns], 0 before it is sent, and
    ``hand`` is in world [m].
    """

    plan_id: str = ""
    state: MotionState = MotionState.IDLE
    reason: MotionReason = MotionReason.NONE
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
    stamp: int = 0
    arm: ArmPlace = ArmPlace.UNKNOWN
    held: str = ""
    hand: tuple[float, float, float] = (0.0, 0.0, 0.0)
    violation: float = 0.0
    excludes: str = ""
    suggestion: str = ""
    obstacles: int = 0
    obstacles_heard: ObstaclesHeard = ObstaclesHeard.TAKEN
    obstacles_problem: str = ""
