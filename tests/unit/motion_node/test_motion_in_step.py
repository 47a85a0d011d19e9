# SPDX-License-Identifier: Apache-2.0
"""What is in step is left alone; what stands still while it should be on its way is found out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from simulated_arm import HALF_BLOCK, two_moves

from motion_node.execution.arm_state import ArmState
from motion_node.execution.clock_rate import ClockRate
from motion_node.execution.in_step import InStep
from motion_node.execution.monitor import Verdict
from motion_node.execution.settings import StepSettings
from motion_node.robots.joints import JointValues

BEGINS, PERIOD = 70.0, 0.02
SETTINGS = StepSettings()
WHOLE = two_moves()
STAMPS = np.arange(BEGINS - 0.5, BEGINS + WHOLE.duration + 1.0, PERIOD)
offsets = some.floats(-SETTINGS.apart + 0.01, SETTINGS.apart - 0.01)


def state(stamp: float, arm_time: float, finger_time: float) -> ArmState:
    """The arm where its trajectory is at one time, the fingers where theirs is at another [s]."""
    arm = WHOLE.sample(arm_time)[0].arm
    fingers = np.maximum(WHOLE.sample(finger_time)[0].fingers, HALF_BLOCK)
    return ArmState(stamp, 0.0, JointValues(arm, fingers), 0.0)


@given(offsets, offsets)
def test_either_may_be_ahead_or_behind_by_a_little(arm: float, fingers: float) -> None:
    watch = InStep(WHOLE, BEGINS, SETTINGS)
    for stamp in STAMPS:
        time = stamp - BEGINS
        assert watch.update(state(stamp, time + arm, time + fingers)) is Verdict.GOING


@given(some.floats(0.0, WHOLE.duration))
def test_an_arm_that_stands_still_is_found_out_where_it_should_be_elsewhere(since: float) -> None:
    watch, where = InStep(WHOLE, BEGINS, SETTINGS), WHOLE.sample(since)[0].arm
    late = 0.0
    for stamp in STAMPS:
        time = stamp - BEGINS
        about = np.linspace(time - SETTINGS.apart, time + SETTINGS.apart, 500)
        path = WHOLE.sample(about)[0].arm
        away = np.abs(path - where).max(axis=1).min() > SETTINGS.arm_tolerance + 0.01
        late = late + PERIOD if away and time > since else 0.0
        verdict = watch.update(state(stamp, min(time, since), time))
        if verdict is not Verdict.GOING:
            assert verdict is Verdict.ARM_OUT_OF_STEP
            assert time > since + SETTINGS.apart - PERIOD
            return
        assert late <= SETTINGS.seconds + 2 * PERIOD


@pytest.mark.parametrize(
    ("since", "verdict", "block"),
    [
        (0.0, Verdict.FINGERS_TOO_WIDE, None),
        (2.0, Verdict.FINGERS_TOO_NARROW, "green_box"),
        (4.5, Verdict.FINGERS_TOO_NARROW, "blue_box"),
    ],
)
def test_fingers_that_stand_still_are_found_out(
    since: float, verdict: Verdict, block: str | None
) -> None:
    watch = InStep(WHOLE, BEGINS, SETTINGS)
    found = (
        watch.update(state(stamp, stamp - BEGINS, min(stamp - BEGINS, since))) for stamp in STAMPS
    )
    assert next(item for item in found if item is not Verdict.GOING) is verdict
    held = watch.block()
    assert (held.object_name if held else None) == block


@given(some.floats(0.1, 50.0), some.lists(some.floats(0.001, 0.1), min_size=40))
def test_the_rate_of_a_clock_is_known_after_a_while(rate: float, steps: list[float]) -> None:
    clock, now = ClockRate(), 5.0
    for step in [*steps, 0.2]:
        clock.hear(1000.0 + rate * now, now)
        now += step
    clock.hear(1000.0 + rate * now, now)
    assert clock.value == pytest.approx(rate, rel=1e-6)


def test_a_clock_that_begins_anew_is_measured_anew() -> None:
    clock = ClockRate()
    for stamp, received in ((10.0, 1.0), (20.0, 2.0), (3.0, 3.0), (3.5, 3.5)):
        clock.hear(stamp, received)
    assert clock.value == pytest.approx(1.0)
