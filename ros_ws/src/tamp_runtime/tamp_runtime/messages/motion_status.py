# SPDX-License-Identifier: Apache-2.0
"""MotionStatus to :class:`MotionReport` and back."""

from __future__ import annotations

from typing import Final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from std_msgs.msg import Header
from tamp_interfaces.msg import MotionStatus

from tamp_runtime.motion_report import (
    ArmPlace,
    MotionReason,
    MotionReport,
    MotionState,
    ObstaclesHeard,
)

from .stamps import nanoseconds

#: The fields that message and report have in common as they are.
_SAME: Final = (
    *("plan_id", "message", "bound", "object_name", "constraint", "phase", "held"),
    *("move", "moves_done", "moves_total", "optimisation_seconds", "duration"),
    *("violation", "excludes", "suggestion"),
    *("obstacles", "obstacles_problem"),
)


def report_to_message(report: MotionReport, stamp: Time) -> MotionStatus:
    """The message of a report; ``stamp`` is the time of its publication."""
    return MotionStatus(
        header=Header(stamp=stamp),
        state=int(report.state),
        reason=int(report.reason),
        arm=int(report.arm),
        obstacles_heard=int(report.obstacles_heard),
        hand=Point(**dict(zip("xyz", report.hand))),
        progress=min(max(report.progress, 0.0), 1.0),
        **{name: getattr(report, name) for name in _SAME},
    )


def report_from_message(message: MotionStatus) -> MotionReport:
    """The report of a message; raises ValueError for a number that has no name."""
    return MotionReport(
        state=MotionState(message.state),
        reason=MotionReason(message.reason),
        arm=ArmPlace(message.arm),
        obstacles_heard=ObstaclesHeard(message.obstacles_heard),
        hand=(message.hand.x, message.hand.y, message.hand.z),
        progress=message.progress,
        stamp=nanoseconds(message.header.stamp),
        **{name: getattr(message, name) for name in _SAME},
    )
