# SPDX-License-Identifier: Apache-2.0
"""The newest state of the arm, and for how long it has rested."""

from __future__ import annotations

import threading
from itertools import chain, repeat

import numpy as np
import pytest

from motion_node.execution.arm_state import REST_TOLERANCE, ArmStateBox
from motion_node.execution.lived_time import LONGEST_GAP, LivedTime
from motion_node.robots.joints import JointValues


def joints(arm: float = 0.0, finger: float = 0.04) -> JointValues:
    return JointValues(np.array([arm, 1.0]), np.full(2, finger))


def resting(box: ArmStateBox) -> float:
    state = box.newest()
    assert state is not None
    return state.resting


def test_there_is_no_state_before_the_first() -> None:
    assert ArmStateBox().newest() is None


def test_a_state_carries_both_clocks() -> None:
    box = ArmStateBox(clock=lambda: 7.0)
    box.put(100.0, joints())
    state = box.newest()
    assert state is not None
    assert (state.stamp, state.received, box.now()) == (100.0, 7.0, 7.0)


def test_rest_is_counted_by_stamps_until_a_joint_moves() -> None:
    box = ArmStateBox()
    for stamp in (0.0, 0.5, 1.25):
        box.put(stamp, joints())
    assert resting(box) == 1.25
    box.put(2.0, joints(arm=2 * REST_TOLERANCE))
    assert resting(box) == 0.0


def test_a_finger_that_moves_is_no_rest() -> None:
    box = ArmStateBox()
    box.put(0.0, joints())
    box.put(1.0, joints(finger=0.03))
    assert resting(box) == 0.0


def test_noise_is_rest_but_creeping_is_not() -> None:
    noisy, creeping = ArmStateBox(), ArmStateBox()
    for index in range(11):
        noisy.put(float(index), joints(arm=0.4 * REST_TOLERANCE * (-1) ** index))
        creeping.put(float(index), joints(arm=0.3 * REST_TOLERANCE * index))
    assert resting(noisy) == 10.0
    assert resting(creeping) < 4.0


def test_a_clock_that_goes_back_starts_the_rest_anew() -> None:
    box = ArmStateBox()
    for stamp in (50.0, 60.0, 1.0, 1.5):
        box.put(stamp, joints())
    assert resting(box) == 0.5


def test_waiting_ends_with_news_or_in_time() -> None:
    box = ArmStateBox()
    assert box.wait(None, 0.0) is None
    box.put(0.0, joints())
    first = box.wait(None, 0.0)
    assert first is box.newest()
    assert box.wait(first, 0.0) is None


@pytest.mark.timeout(60)
def test_who_waits_is_woken_by_another_thread() -> None:
    box = ArmStateBox()
    thread = threading.Thread(target=box.put, args=[3.0, joints()])
    thread.start()
    state = box.wait(None, 30.0)
    thread.join()
    assert state is not None
    assert state.stamp == 3.0


@pytest.mark.timeout(60)
def test_who_waits_is_woken_when_the_node_ends() -> None:
    box = ArmStateBox()
    box.put(3.0, joints())
    thread = threading.Thread(target=box.close)
    thread.start()
    assert box.wait(box.newest(), 3600.0) is None
    thread.join()
    assert box.closed
    assert box.wait(None, 3600.0) is None


def test_what_cannot_be_used_is_remembered_until_something_can() -> None:
    box = ArmStateBox()
    box.refuse("no names")
    assert box.problem == "no names"
    assert box.newest() is None
    box.put(0.0, joints())
    assert box.problem == ""


def test_fault_3_time_in_which_the_process_was_stopped_does_not_count() -> None:
    ticks = iter([10.0, 10.5, 11.0, 16.0, 16.5])
    lived = LivedTime(lambda: next(ticks))
    assert [lived() for _ in range(4)] == [10.5, 11.0, 11.0 + LONGEST_GAP, 11.5 + LONGEST_GAP]


def test_fault_3_a_wait_does_not_end_because_the_process_was_stopped_meanwhile() -> None:
    """The clock jumps by a minute at the first look after the wait began."""
    ticks = chain([0.0, 0.0, 0.0], repeat(60.0))
    box = ArmStateBox(LivedTime(lambda: next(ticks)))
    threading.Timer(0.3, box.put, [1.0, joints()]).start()
    state = box.wait(None, 10.0)
    assert state is not None
