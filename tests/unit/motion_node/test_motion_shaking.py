# SPDX-License-Identifier: Apache-2.0
"""Joints that shake are told from joints that rest, and from joints that get somewhere."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from motion_node.execution.arm_state import ArmStateBox
from motion_node.robots.joints import JointValues

Array = NDArray[np.float64]
RATE = 60.0


def joints(arm: Array) -> JointValues:
    return JointValues(np.append(arm, 1.0), np.full(2, 0.04))


def hear(box: ArmStateBox, path: Callable[[float], Array], begin: float, seconds: float) -> None:
    for index in range(round(seconds * RATE)):
        stamp = begin + index / RATE
        box.put(stamp, joints(path(stamp)))


def noise(radians: float, seed: int) -> Callable[[float], Array]:
    rng = np.random.default_rng(seed)
    return lambda _stamp: rng.normal(0.0, radians, 7)


def test_fault_13_states_of_joints_that_only_shake_are_refused() -> None:
    box = ArmStateBox()
    hear(box, noise(0.009, seed=5), 0.0, 30.0)
    assert "the joints shake" in box.problem
    newest = box.newest()
    assert newest is not None
    assert newest.stamp < 10.0


def test_joints_that_shook_are_heard_again_once_they_rest() -> None:
    box = ArmStateBox()
    hear(box, noise(0.009, seed=5), 0.0, 30.0)
    hear(box, lambda _stamp: np.zeros(7), 30.0, 5.0)
    newest = box.newest()
    assert newest is not None
    assert (newest.stamp, box.problem) == (pytest.approx(35.0 - 1 / RATE), "")


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**31 - 1),
    radians=st.floats(0.0, 3e-4),
    stand=st.floats(0.1, 3.0),
    travel=st.floats(0.3, 4.0),
    count=st.sampled_from([2, 3, 4, 40]),
)
@example(seed=0, radians=0.0, stand=0.15, travel=0.85, count=2)
def test_an_arm_that_picks_and_places_is_never_taken_for_one_that_shakes(
    seed: int, radians: float, stand: float, travel: float, count: int
) -> None:
    """From pose to pose, some of them again and again, with the noise of real encoders."""
    rng = np.random.default_rng(seed)
    poses = np.tile(rng.uniform(-1.0, 1.0, (count, 7)), (40, 1))
    box = ArmStateBox()

    def path(stamp: float) -> Array:
        index, within = divmod(stamp, stand + travel)
        share = min(within / travel, 1.0)
        smooth = share * share * (3.0 - 2.0 * share)
        where = poses[int(index)] + smooth * (poses[int(index) + 1] - poses[int(index)])
        return np.asarray(where + rng.normal(0.0, radians, 7))

    hear(box, path, 0.0, 25.0)
    assert box.problem == ""
    newest = box.newest()
    assert newest is not None
    assert newest.stamp > 24.9
