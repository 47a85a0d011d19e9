# SPDX-License-Identifier: Apache-2.0
"""Where the blocks of a tower meet, and to which of them strips of faces go."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from perception_node.segment.levels import levels, parted
from perception_node.segment.region import Region
from perception_node.segment.strips import NEARLY, take_strips

EDGE = 0.045
#: Pixels of a block's front along each axis.
PIXELS = 30
Array = NDArray[np.float64]

heights = st.lists(st.integers(0, 200), min_size=1, max_size=30).map(
    lambda values: 1e-3 * np.sort(np.array(values, np.float64))
)


def wrong_at(value: float, below: Array, above: Array) -> int:
    return int(np.count_nonzero(below > value) + np.count_nonzero(above < value))


@given(heights, heights)
def test_no_other_height_parts_two_blocks_better(below: Array, above: Array) -> None:
    at = parted(below, above)
    candidates = np.concatenate([below, above])
    best = min(wrong_at(value, below, above) for value in candidates)
    if at is not None:
        assert wrong_at(at, below, above) <= best


def tower(count: int) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
    """Labels, the lowest 1, and points of a wall of fronts, (rows, columns[, 3])."""
    rows, columns = np.mgrid[: count * PIXELS, :PIXELS]
    up = (count * PIXELS - 1 - rows + 0.5) * (EDGE / PIXELS)
    across = (columns + 0.5) * (EDGE / PIXELS)
    points = np.stack([np.full(up.shape, 0.5), across, up], axis=-1).astype(np.float32)
    return (count - rows // PIXELS).astype(np.uint16), points


def test_a_few_wrong_pixels_do_not_move_where_blocks_meet() -> None:
    labels, points = tower(3)
    labels[PIXELS - 10 : PIXELS, :2] = 2  # a side of the top block, taken for that below it
    low, high = levels(labels, points)
    assert np.isinf([low[1], high[3]]).all()
    found = high[1], low[2], high[2], low[3]
    np.testing.assert_allclose(found, [EDGE, EDGE, 2 * EDGE, 2 * EDGE], atol=1e-3)


def test_blocks_beside_one_another_do_not_meet() -> None:
    labels, points = tower(2)
    points[labels == 2, 1] += 0.1
    low, high = levels(labels, points)
    assert np.isinf(low).all() and np.isinf(high).all()


def test_blocks_that_share_their_heights_do_not_meet_anywhere() -> None:
    labels, points = tower(2)
    points[labels == 2, 2] -= 0.6 * EDGE  # one leans on the other
    low, high = levels(labels, points)
    assert np.isinf(low).all() and np.isinf(high).all()


def test_a_strip_goes_to_the_block_that_is_as_high() -> None:
    true, points = tower(2)
    labels = true.copy()
    labels[PIXELS - 10 : PIXELS, :2] = 1  # looks like the lower block, and is of the upper one
    labels[: PIXELS // 2, -2:] = 0
    region = Region(
        (slice(0, len(true)), slice(0, PIXELS)),
        np.zeros((*true.shape, 3), np.uint8),
        np.ones(true.shape, np.float32),
        np.ones(true.shape, bool),
        points,
        np.ones(true.shape, bool),
    )
    take_strips(labels, np.ones(true.shape, np.int32), region, 5)
    sure = np.abs(points[..., 2] - EDGE) > NEARLY + EDGE / PIXELS
    assert np.array_equal(labels[sure], true[sure])
