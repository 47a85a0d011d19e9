# SPDX-License-Identifier: Apache-2.0
"""Turns and poses agree with scipy, which is not the code under test."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from scene_graph import BlockPose, quaternion_from_yaw, rotation_from_quaternion, wrap_line

ANGLES = st.floats(-10.0, 10.0)
PARTS = st.floats(-1.0, 1.0)


@given(ANGLES)
def test_a_yaw_is_a_turn_about_z(yaw: float) -> None:
    expected = Rotation.from_euler("z", yaw).as_matrix()
    assert rotation_from_quaternion(quaternion_from_yaw(yaw)) == pytest.approx(expected)


@given(st.tuples(PARTS, PARTS, PARTS, PARTS).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_any_norm_gives_the_same_rotation(quaternion: tuple[float, float, float, float]) -> None:
    expected = Rotation.from_quat(quaternion).as_matrix()
    assert rotation_from_quaternion(quaternion) == pytest.approx(expected, abs=1e-12)


@given(ANGLES)
def test_a_line_has_no_direction(angle: float) -> None:
    wrapped = wrap_line(angle)
    assert -np.pi / 2 < wrapped <= np.pi / 2 + 1e-12
    assert np.sin(angle - wrapped) == pytest.approx(0.0, abs=1e-9)


@given(ANGLES)
def test_the_enclosing_box_touches_the_corners(yaw: float) -> None:
    block = BlockPose((1.0, 2.0, 0.5), yaw, (0.2, 0.1, 0.4))
    corners = np.array([[i, j, 0.0] for i in (-0.1, 0.1) for j in (-0.05, 0.05)])
    turned = Rotation.from_euler("z", yaw).apply(corners)
    assert block.half_world == pytest.approx(tuple(np.abs(turned).max(axis=0)[:2]))
    assert (block.bottom, block.top) == (pytest.approx(0.3), pytest.approx(0.7))
