# SPDX-License-Identifier: Apache-2.0
"""MotionStatus to :class:`MotionReport` and back."""

from __future__ import annotations

from builtin_interfaces.msg import Time
from std_msgs.msg import Header
from tamp_interfaces.msg import MotionStatus

from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from .stamps import nanoseconds


def report_to_message(report: MotionReport, stamp: Time) -> MotionStatus:
    """The message of a report; ``stamp`` is the time of its publication."""
    return MotionStatus(
        header=Header(stamp=stamp),
        plan_id=report.plan_id,
        state=int(report.state),
        reason=int(report.reason),
        message=report.message,
        bound=report.bound,
        object_name=report.object_name,
        constraint=report.constraint,
        move=report.move,
        moves_done=report.moves_done,
        moves_total=report.moves_total,
        phase=report.phase,
        progress=float(min(max(report.progress, 0.0), 1.0)),
        optimisation_seconds=float(report.optimisation_seconds),
        duration=float(report.duration),
    )


def report_from_message(message: MotionStatus) -> MotionReport:
    """The report of a message; raises ValueError for a state or reason without a name."""
    return MotionReport(
        plan_id=message.plan_id,
        state=MotionState(message.state),
        reason=MotionReason(message.reason),
        message=message.message,
        bound=message.bound,
        object_name=message.object_name,
        constraint=message.constraint,
        move=message.move,
        moves_done=message.moves_done,
        moves_total=message.moves_total,
        phase=message.phase,
        progress=message.progress,
        optimisation_seconds=message.optimisation_seconds,
        duration=message.duration,
        stamp=nanoseconds(message.header.stamp),
    )
