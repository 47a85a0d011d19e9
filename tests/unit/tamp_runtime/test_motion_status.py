# SPDX-License-Identifier: Apache-2.0
"""Plain values that stand for constants of messages have the messages' numbers."""

from enum import IntEnum
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from tamp_interfaces.msg import MotionStatus, SceneGraph
from tamp_runtime.messages.motion_status import report_from_message, report_to_message
from tamp_runtime.motion_report import (
    ArmPlace,
    MotionReason,
    MotionReport,
    MotionState,
)

from scene_graph import GraphStatus


@pytest.mark.parametrize(
    ("kind", "message", "first", "last"),
    [
        (MotionState, MotionStatus, "IDLE", "FAILED"),
        (MotionReason, MotionStatus, "NONE", "CONFLICT"),
        (ArmPlace, MotionStatus, "UNKNOWN", "MOVING"),
        (GraphStatus, SceneGraph, "CONFIDENT", "BAD_IMAGE"),
    ],
)
def test_numbers_are_those_of_the_message(
    kind: type[IntEnum], message: Any, first: str, last: str
) -> None:
    prefix = "ARM_" if kind is ArmPlace else ""
    members = {prefix + item.name: item.value for item in kind}
    assert members == {name: getattr(message, name) for name in members}
    assert {prefix + first, prefix + last} <= members.keys()


def test_a_report_survives_the_way_into_a_message_and_back() -> None:
    report = MotionReport(
        "a", MotionState.FAILED, MotionReason.INFEASIBLE, "why", "path", "red_box", "clearance",
        1, 2, 3, "pick", 0.5, 0.25, 2.0, stamp=5_000_000_007,
        arm=ArmPlace.RESTING, held="blue_box", hand=(0.5, 0.1, 0.25),
    )  # fmt: skip
    assert report_from_message(report_to_message(report, Time(sec=5, nanosec=7))) == report
