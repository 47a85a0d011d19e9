# SPDX-License-Identifier: Apache-2.0
"""What may be a block over a tower: told where the network is in two minds, and only there."""

from __future__ import annotations

import numpy as np
import pytest

from perception_node.segment.missed import may_be_missed


def square(top: int, left: int) -> np.ndarray:
    mask = np.zeros((80, 60), bool)
    mask[top : top + 20, left : left + 20] = True
    return mask


@pytest.mark.parametrize(("likely", "told"), [(0.05, False), (0.5, True)])
def test_what_is_likely_over_the_uppermost_block_is_told(likely: float, told: bool) -> None:
    low, high = square(50, 10), square(30, 12)
    sure = np.full(low.shape, 0.01, np.float32)
    sure[low | high] = 1.0
    sure[22:30, 12:32] = likely
    places = may_be_missed([low, high], [], [], sure)
    assert list(places) == ([1] if told else [])
    for column, row in places.values():
        assert 12 <= column < 32 and 22 <= row < 30
    # The same is nothing where it is known to be something behind.
    assert not may_be_missed([low, high], [], [square(10, 12)], sure)


def test_what_was_left_out_as_vague_is_told_over_a_block_and_not_beside_it() -> None:
    block = square(50, 10)
    sure = np.where(block, 1.0, 0.02).astype(np.float32)
    assert may_be_missed([block], [square(31, 12)], [], sure)
    assert not may_be_missed([block], [square(31, 38)], [], sure)
