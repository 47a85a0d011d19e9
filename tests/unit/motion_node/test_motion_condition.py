# SPDX-License-Identifier: Apache-2.0
"""How the arm is said to be, from joint states and what the hand was told."""

from __future__ import annotations

import numpy as np
import pytest
from tamp_runtime.motion_report import SOMETHING, ArmPlace, MotionReport

from motion_node.execution.arm_state import ArmStateBox
from motion_node.execution.condition import FRESH_SECONDS, Condition, Grip
from motion_node.robots.joints import JointValues

TRAVEL, HALF_BLOCK, SQUEEZED = 0.04, 0.0225, 0.0125


class Bench:
    """An arm of two joints with a clock that is set by hand."""

    def __init__(self) -> None:
        self.time, self.grip = 0.0, Grip()
        self.box = ArmStateBox(lambda: self.time)
        self.known = True
        self.condition = Condition(
            self.box,
            lambda: self.grip,
            np.zeros(2),
            TRAVEL,
            lambda q: np.array([q[0], 2.0, 3.0]) if self.known else None,
        )

    def rest(self, arm: float = 0.0, fingers: float = TRAVEL, seconds: float = 1.0) -> None:
        for _ in range(2):
            self.box.put(self.time, JointValues(np.array([arm, 0.0]), np.full(2, fingers)))
            self.time += seconds


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_without_joint_states_nothing_is_known(bench: Bench) -> None:
    told = bench.condition.told_in(MotionReport("a"))
    assert (told.plan_id, told.arm, told.held, told.hand) == (
        "a", ArmPlace.UNKNOWN, "", (0.0, 0.0, 0.0),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("arm", "place"), [(0.0, ArmPlace.HOME), (0.04, ArmPlace.HOME), (0.3, ArmPlace.RESTING)]
)
def test_an_arm_at_rest_is_home_or_elsewhere(bench: Bench, arm: float, place: ArmPlace) -> None:
    bench.rest(arm)
    assert bench.condition.place is place
    assert bench.condition.is_tidy == (place is ArmPlace.HOME)


def test_an_arm_that_passes_home_moves(bench: Bench) -> None:
    for arm in (0.2, 0.1, 0.0):
        bench.box.put(bench.time, JointValues(np.array([arm, 0.0]), np.full(2, TRAVEL)))
        bench.time += 0.1
    assert bench.condition.place is ArmPlace.MOVING
    assert not bench.condition.is_tidy


def test_old_joint_states_tell_only_where_the_arm_was(bench: Bench) -> None:
    bench.rest(0.3)
    bench.grip = Grip("red_box", 0, SQUEEZED)
    bench.rest(0.3, HALF_BLOCK)
    bench.time += FRESH_SECONDS + 0.1
    assert bench.condition.place is ArmPlace.UNKNOWN
    assert bench.condition.held() == "red_box"
    assert bench.condition.hand == (0.3, 2.0, 3.0)


def test_before_the_robot_description_the_hand_is_nowhere(bench: Bench) -> None:
    bench.known = False
    bench.rest()
    assert bench.condition.hand == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("grip", "fingers", "held"),
    [
        (Grip(), TRAVEL, ""),
        (Grip(), TRAVEL - 0.001, ""),
        (Grip(), 0.0, ""),
        (Grip(), HALF_BLOCK, SOMETHING),
        (Grip(sent=TRAVEL), HALF_BLOCK, SOMETHING),
        (Grip(known=True, sent=SQUEEZED), HALF_BLOCK, ""),
        (Grip("red_box", 0, SQUEEZED), HALF_BLOCK, "red_box"),
        (Grip("red_box", 0, TRAVEL), HALF_BLOCK, "red_box"),
        (Grip("red_box", 0, SQUEEZED), SQUEEZED, ""),
        (Grip("red_box", 0, SQUEEZED), TRAVEL, ""),
        (Grip("red_box", 0, SQUEEZED), 0.0, ""),
        (Grip(sent=SQUEEZED), SQUEEZED, ""),
    ],
)
def test_fingers_tell_what_is_held(bench: Bench, grip: Grip, fingers: float, held: str) -> None:
    bench.grip = grip
    bench.rest(fingers=fingers)
    assert bench.condition.held() == held
    assert bench.condition.is_tidy == (held == "")
