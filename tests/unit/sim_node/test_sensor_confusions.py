# SPDX-License-Identifier: Apache-2.0
"""Which pixels belong together is mistaken for as many blocks as was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import label as connected
from sensor_frames import BLOCKS, even, table

from sim_node import Frame
from sim_node.sensor.confusions import merged, missing, phantom, split, touching_pairs

SEEDS = range(40)


def random(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def labels_in(labels: np.ndarray) -> set[int]:
    return {int(value) for value in np.unique(labels)} - {0}


def test_the_block_on_another_touches_it_and_the_one_beside_does_not() -> None:
    assert touching_pairs(table().labels) == [(3, 7)]


@pytest.mark.parametrize("pairs", [1, 3])
def test_blocks_that_touch_are_merged_and_others_never(pairs: int) -> None:
    frame = table()
    for seed in SEEDS:
        labels = merged(frame, pairs, random(seed))
        assert labels_in(labels) == {3, 5}
        assert ((labels == 5) == (frame.labels == 5)).all()
        assert ((labels > 0) == (frame.labels > 0)).all()


@pytest.mark.parametrize("blocks", [1, 2, 3, 9])
def test_split_blocks_have_two_labels_of_about_half_each(blocks: int) -> None:
    frame = table()
    for seed in SEEDS:
        labels = split(frame, blocks, random(seed))
        assert len(labels_in(labels)) == 3 + min(blocks, 3)
        assert ((labels > 0) == (frame.labels > 0)).all()
        halved = 0
        for region in BLOCKS.values():
            parts, counts = np.unique(labels[region], return_counts=True)
            halved += len(parts) == 2
            assert counts.min() > 0.4 * counts.sum() / len(parts)
            assert all(connected(labels == part)[1] == 1 for part in parts)
        assert halved == min(blocks, 3)


@pytest.mark.parametrize("blocks", [1, 2, 3, 9])
def test_missing_blocks_are_wholly_missing_and_the_rest_is_as_it_was(blocks: int) -> None:
    frame = table()
    taken = set()
    for seed in SEEDS:
        labels = missing(frame, blocks, random(seed))
        left = labels_in(labels)
        assert len(left) == max(0, 3 - blocks)
        assert all((labels[BLOCKS[label]] == label).all() for label in left)
        taken |= {3, 5, 7} - left
    assert taken == {3, 5, 7}


@pytest.mark.parametrize("blocks", [1, 2])
def test_phantoms_lie_on_the_table_where_no_block_is(blocks: int) -> None:
    frame = table()
    for seed in SEEDS:
        labels = phantom(frame, blocks, random(seed))
        new = (labels > 0) & (frame.labels == 0)
        assert (labels[~new] == frame.labels[~new]).all()
        assert labels_in(labels) - {3, 5, 7} == set(range(8, 8 + blocks))
        assert new.sum() == 400 * blocks  # the blocks are of 20 x 20 pixels
        assert (frame.depth[new] > 0.0).all()


def test_there_are_no_more_phantoms_than_find_room() -> None:
    frame = table()
    labels = phantom(frame, 100, random())
    assert 2 < len(labels_in(labels)) < 30


def test_nothing_to_confuse_in_a_picture_without_blocks() -> None:
    empty = even(1.0)
    for error in (merged, split, missing):
        assert not error(empty, 2, random()).any()
    assert labels_in(phantom(empty, 2, random())) == {1, 2}
    nothing = Frame(empty.rgb, np.zeros_like(empty.depth), empty.labels)
    assert not phantom(nothing, 2, random()).any()
