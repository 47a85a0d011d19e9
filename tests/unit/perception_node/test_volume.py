# SPDX-License-Identifier: Apache-2.0
"""Blocks are looked for around the row of places, and only there."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from perception_node.segment import Volume
from perception_node.segment.volume import MARGIN, NEAR

FEET = np.array([[0.5, -0.15, 0.02], [0.5, 0.0, 0.02], [0.45, 0.15, 0.02]])


def test_a_volume_holds_all_places_and_what_stands_on_them() -> None:
    volume = Volume.over(FEET, 0.36)
    assert volume.floor == 0.02
    np.testing.assert_allclose(volume.low[:2], FEET[:, :2].min(axis=0) - MARGIN)
    np.testing.assert_allclose(volume.high, [0.5 + MARGIN, 0.15 + MARGIN, 0.38])
    assert volume.corners().shape == (8, 3)


@given(st.floats(0.0, 1.0), st.integers(0, 1), st.floats(-0.2, 0.2))
def test_near_is_what_is_near_to_the_line_from_place_to_place(
    share: float, first: int, beside: float
) -> None:
    volume = Volume.over(FEET, 0.36)
    begin, end = FEET[first, :2], FEET[first + 1, :2]
    along = (end - begin) / np.linalg.norm(end - begin)
    point = begin + share * (end - begin) + beside * np.array([-along[1], along[0]])
    # Brute force: the distance to many points of both lines.
    steps = np.linspace(0.0, 1.0, 2001)[:, None]
    lines = [FEET[i, :2] + steps * (FEET[i + 1, :2] - FEET[i, :2]) for i in (0, 1)]
    distance = np.linalg.norm(np.concatenate(lines) - point, axis=1).min()
    if abs(distance - NEAR) > 1e-3:
        assert volume.is_near(point[None])[0] == (distance < NEAR)


def test_a_single_place_is_a_row_too() -> None:
    volume = Volume.over(FEET[:1], 0.36)
    near = volume.is_near(np.array([[0.5, -0.15 + 0.9 * NEAR], [0.5, -0.15 + 1.1 * NEAR]]))
    assert near.tolist() == [True, False]
