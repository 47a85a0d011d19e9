# SPDX-License-Identifier: Apache-2.0
"""The number of stacks is read off the mask (A.2.4)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from perception_node.stack_count import count_stacks


def mask_of(heights: list[int], width: int = 22, gap: int = 50) -> NDArray[np.bool_]:
    """Towers of blocks of 22 px side by side; height 0 leaves the place empty."""
    mask = np.zeros((256, 256), bool)
    for index, height in enumerate(heights):
        left = 10 + index * (width + gap)
        mask[200 - 22 * height : 200, left : left + width] = True
    return mask


@given(st.lists(st.integers(0, 7), min_size=1, max_size=3))
def test_it_is_the_number_of_towers(heights: list[int]) -> None:
    assert count_stacks(mask_of(heights)) == sum(height > 0 for height in heights)


def test_towers_may_stand_close_together() -> None:
    assert count_stacks(mask_of([1, 3, 2, 1], gap=8)) == 4


@pytest.mark.parametrize("seed", range(5))
def test_lost_pixels_and_specks_do_not_count(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mask = mask_of([2, 0, 5])
    mask &= rng.random(mask.shape) > 0.25
    mask |= rng.random(mask.shape) < 0.002
    assert count_stacks(mask) == 2


def test_one_broken_row_does_not_count() -> None:
    mask = mask_of([3])
    mask[150, 18:24] = False
    assert count_stacks(mask) == 1


def test_a_tower_that_leans_is_one() -> None:
    mask = np.zeros((256, 256), bool)
    for level in range(5):
        mask[200 - 22 * (level + 1) : 200 - 22 * level, 100 + 7 * level : 122 + 7 * level] = True
    assert count_stacks(mask) == 1


def test_an_empty_mask_has_none() -> None:
    assert count_stacks(np.zeros((64, 64), bool)) == 0
