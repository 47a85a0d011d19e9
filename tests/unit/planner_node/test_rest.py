# SPDX-License-Identifier: Apache-2.0
"""The arm is said to rest when the motion node goes on saying so, and not before."""

from __future__ import annotations

from tamp_interfaces.msg import MotionStatus

from planner_node.cli.rest import RestWatch


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def status(state: int, arm: int = MotionStatus.ARM_HOME, plan_id: str = "p") -> MotionStatus:
    return MotionStatus(state=state, arm=arm, plan_id=plan_id)


IDLE = status(MotionStatus.IDLE, plan_id="")
EXECUTING = status(MotionStatus.EXECUTING, MotionStatus.ARM_MOVING)
CANCELLED = status(MotionStatus.CANCELLED)


def watch_of(*reports: MotionStatus, period: float = 1.0) -> RestWatch:
    """Reports that are heard after the request, one a period."""
    clock = Clock()
    watch = RestWatch(clock)
    watch.start()
    for report in reports:
        clock.now += period
        watch.hear(report)
    return watch


def test_reports_that_agree_for_a_while_are_believed() -> None:
    assert watch_of(IDLE, IDLE).at_rest
    assert watch_of(EXECUTING, CANCELLED, IDLE).at_rest


def test_one_report_may_be_older_than_the_request() -> None:
    assert not watch_of(IDLE).at_rest
    assert not watch_of(*[IDLE] * 5, period=0.1).at_rest


def test_what_was_heard_before_the_request_does_not_count() -> None:
    clock = Clock()
    watch = RestWatch(clock)
    for _ in range(3):
        clock.now += 1.0
        watch.hear(IDLE)
    watch.start()
    clock.now += 1.0
    watch.hear(IDLE)
    assert not watch.at_rest


def test_an_arm_that_moves_does_not_rest_whatever_the_state_is() -> None:
    going_home = status(MotionStatus.FAILED, MotionStatus.ARM_MOVING)
    assert not watch_of(going_home, going_home, going_home).at_rest
    assert not watch_of(EXECUTING, EXECUTING).at_rest
    assert not watch_of(IDLE, EXECUTING, IDLE).at_rest


def test_the_end_of_what_ran_is_kept_for_the_answer() -> None:
    watch = watch_of(EXECUTING, CANCELLED, IDLE)
    assert watch.ended == CANCELLED
    assert watch.last == IDLE
    assert watch_of(IDLE, CANCELLED).ended is None, "an older plan's"


def test_silence_is_counted_from_the_request() -> None:
    clock = Clock()
    watch = RestWatch(clock)
    clock.now += 50.0
    watch.start()
    clock.now += 4.0
    assert watch.silence() == 4.0
    watch.hear(IDLE)
    assert watch.silence() == 0.0
