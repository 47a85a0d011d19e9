# SPDX-License-Identifier: Apache-2.0
"""The arms by name, and values that do not fit together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_node.robots import ARMS, PANDA, arm_named


def test_arms_are_known_by_name() -> None:
    assert arm_named("panda") is PANDA
    assert all(arm_named(name).name == name for name in ARMS)
    with pytest.raises(ValueError, match=r"no robot 'nobody'; there is .*panda"):
        arm_named("nobody")


@pytest.mark.parametrize("field", ["home", "acceleration"])
def test_an_arm_has_one_number_a_joint(field: str) -> None:
    with pytest.raises(ValueError, match=f"{field} of panda has 2 numbers; it has 7 joints"):
        replace(PANDA, **{field: (1.0, 2.0)})  # type: ignore[arg-type]


def test_messages_name_the_arm_s_joints_first() -> None:
    assert PANDA.joint_names[:7] == PANDA.arm_joints
    assert PANDA.joint_names[7:] == PANDA.gripper.finger_joints


@given(st.lists(st.tuples(st.floats(-1.2, 1.2), st.floats(-np.pi, np.pi)), min_size=1, max_size=4))
def test_seeds_are_home_turned_to_the_place_and_to_the_grasp(
    targets: list[tuple[float, float]],
) -> None:
    """Panda's first and last joint have opposite axes while the hand points down."""
    azimuths, yaws = np.array(targets).T
    home, home_yaw = np.array(PANDA.home), 0.3
    near, reached = PANDA.seeding.turned(
        home, home_yaw, azimuths, yaws, np.full(7, -2.9), np.full(7, 2.9)
    )
    np.testing.assert_array_equal(near[:, 1:6], np.tile(home[1:6], (len(yaws), 1)))
    np.testing.assert_allclose(near[:, 0], azimuths)
    np.testing.assert_allclose(reached, home_yaw + near[:, 0] - (near[:, 6] - home[6]))
    np.testing.assert_allclose(np.sin(reached - yaws), 0.0, atol=1e-9)
    assert np.abs(near[:, 6]).max() <= np.pi / 2 + 1e-9
