# SPDX-License-Identifier: Apache-2.0
"""What the closed loop tells: how far it is, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from tamp_runtime.motion_report import MotionReport

from .plan import Plan
from .scene import Scene

#: Where the motion node has said nothing on the plan yet.
NO_REPORT: Final = MotionReport()


class Stage(IntEnum):
    """What the loop is doing; the numbers are those of the feedback of AchieveGoal."""

    PERCEIVING = 0
    PLANNING = 1
    OPTIMISING = 2
    EXECUTING = 3
    CONFIRMING = 4
    CANCELLING = 5


class Status(IntEnum):
    """How a request ended; the numbers are those of PlanToGoal and AchieveGoal."""

    SUCCESS = 0
    ALREADY_TRUE = 1
    INVALID_GOAL = 2
    UNKNOWN_OBJECT = 3
    AMBIGUOUS_OBJECT = 4
    CONTRADICTORY_GOAL = 5
    UNREACHABLE = 6
    SEARCH_LIMIT = 7
    NO_SCENE_GRAPH = 8
    NOT_CONFIDENT = 9
    GOAL_IMAGE_REJECTED = 10
    BUSY = 11
    CANCELLED = 12
    INTERNAL_ERROR = 13
    CONFLICT = 14
    INVALID_PLAN = 15
    ENGINE_FAILED = 16
    NEEDS_ANSWER = 17
    MOTION_FAILED = 20
    MOTION_SILENT = 21
    TOO_MANY_REPLANS = 22
    ARM_STUCK = 23


@dataclass(frozen=True)
class Progress:
    """How far a run is.

    Attributes:
        message: a sentence for people.
        plan: the current plan; None before the first.
        motion: what the motion node last reported on it.
        replans: plans made anew so far.
    """

    stage: Stage = Stage.PERCEIVING
    message: str = ""
    plan: Plan | None = None
    motion: MotionReport = NO_REPORT
    replans: int = 0


@dataclass(frozen=True)
class Outcome:
    """How a run ended, or where it is.

    Attributes:
        message: a sentence for people.
        module: the part of the system that could not go on: perception, planner, motion or "".
        moves_planned: of the first plan; ``moves_executed``: over all plans.
        causes: why plans were given up, failed or were made anew, and what differed from what was
            predicted, in order: the first cause first.
        initial, final: the first and the last scene that was seen.
        motion: the last report on a plan, with where the arm is now and what it holds.
        perceive_seconds, plan_seconds, motion_seconds, execute_seconds: wall times, summed [s];
            motion is the optimisation.
        answers: what can be answered to the question that the message asks, if it does.
    """

    status: Status = Status.SUCCESS
    message: str = ""
    module: str = ""
    moves_planned: int = 0
    moves_executed: int = 0
    replans: int = 0
    causes: tuple[str, ...] = ()
    initial: Scene | None = None
    final: Scene | None = None
    motion: MotionReport = NO_REPORT
    perceive_seconds: float = 0.0
    plan_seconds: float = 0.0
    motion_seconds: float = 0.0
    execute_seconds: float = 0.0
    answers: tuple[str, ...] = ()
