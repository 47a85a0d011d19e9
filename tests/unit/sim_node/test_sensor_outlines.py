# SPDX-License-Identifier: Apache-2.0
"""Masks end where the errors of outlines say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import (
    binary_dilation,
    binary_erosion,
    distance_transform_cdt,
    maximum_filter,
    minimum_filter,
)
from sensor_frames import table

from sim_node import Frame
from sim_node.sensor.outlines import boundary, dilated, eroded, moved, shifted, speckled

SQUARE = np.ones((3, 3))
LABELS = arrays(np.uint16, (12, 15), elements=st.sampled_from([0, 0, 0, 2, 5]))
SEEDS = st.integers(0, 2**31)


def frame_of(labels: np.ndarray) -> Frame:
    return Frame(np.zeros((*labels.shape, 3), np.uint8), np.ones(labels.shape, np.float32), labels)


def random(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@given(LABELS, st.integers(0, 4))
def test_eroded_is_scipys_erosion_of_every_mask(labels: np.ndarray, pixels: int) -> None:
    result = eroded(frame_of(labels), pixels, random())
    assert result.dtype == np.uint16
    for label in (2, 5):
        mask = labels == label
        if pixels:
            mask = binary_erosion(mask, SQUARE, iterations=pixels, border_value=1)
        assert ((result == label) == mask).all()


@given(LABELS, st.integers(0, 4))
def test_dilated_is_scipys_dilation_of_all_masks_and_the_nearest_gets_it(
    labels: np.ndarray, pixels: int
) -> None:
    result = dilated(frame_of(labels), pixels, random())
    assert result.dtype == np.uint16
    grown = labels > 0
    if pixels:
        grown = binary_dilation(grown, SQUARE, iterations=pixels)
    assert ((result > 0) == grown).all()
    assert (result[labels > 0] == labels[labels > 0]).all()
    near = {
        label: distance_transform_cdt(labels != label, "chessboard")
        for label in (2, 5)
        if (labels == label).any()
    }
    for label, distance in near.items():
        mine = (result == label) & (labels == 0)
        assert all((distance[mine] <= other[mine]).all() for other in near.values())


@given(LABELS, st.integers(-20, 20), st.integers(-20, 20))
def test_moved_labels_are_where_they_were_moved_to(
    labels: np.ndarray, down: int, right: int
) -> None:
    result = moved(labels, down, right)
    height, width = labels.shape
    for (row, column), value in np.ndenumerate(result):
        source = (row - down, column - right)
        inside = 0 <= source[0] < height and 0 <= source[1] < width
        assert value == (labels[source] if inside else 0)


def test_shifted_moves_everything_equally_far_in_all_directions() -> None:
    frame = table()
    directions = set()
    for seed in range(200):
        result = shifted(frame, 2, random(seed))
        fits = [
            (down, right)
            for down in range(-3, 4)
            for right in range(-3, 4)
            if (result == moved(frame.labels, down, right)).all()
        ]
        assert len(fits) == 1
        directions.add(fits[0])
    ring = {(a, b) for a in range(-2, 3) for b in range(-2, 3) if max(abs(a), abs(b)) == 2}
    assert directions == ring


@given(LABELS, st.integers(0, 4), SEEDS)
def test_a_wobbling_outline_stays_within_its_pixels(
    labels: np.ndarray, pixels: int, seed: int
) -> None:
    result = boundary(frame_of(labels), pixels, random(seed))
    side = 2 * pixels + 1
    for label in (0, 2, 5):
        mask = (labels == label).astype(np.uint8)
        there = (result == label).astype(np.uint8)
        assert (there <= maximum_filter(mask, side, mode="nearest")).all()
        assert (there >= minimum_filter(mask, side, mode="nearest")).all()


@pytest.mark.parametrize("pixels", [1, 2, 4])
def test_outlines_wobble_in_and_out_alike_and_as_far_as_declared(pixels: int) -> None:
    """How far the left side of a block is from where it was, in many pictures."""
    frame = table()
    wobble = np.concatenate(
        [
            np.argmax(boundary(frame, pixels, random(seed))[34:66] > 0, axis=1) - 20
            for seed in range(60)
        ]
    )
    assert wobble.min() == -pixels and wobble.max() == pixels
    assert abs(wobble.mean()) < 0.5 * pixels
    assert (wobble < 0).mean() > 0.2 and (wobble > 0).mean() > 0.1


@pytest.mark.parametrize("percent", [1, 20])
def test_so_many_pixels_get_another_label_of_the_picture(percent: int) -> None:
    frame = table()
    results = [speckled(frame, percent, random(seed)) for seed in range(10)]
    wrong = np.array([result != frame.labels for result in results])
    assert wrong.mean() == pytest.approx(percent / 100.0, rel=0.1)
    assert wrong[:, frame.labels > 0].mean() == pytest.approx(percent / 100.0, rel=0.2)
    assert np.unique(results).tolist() == [0, 3, 5, 7]
    # From none to each of the three blocks equally often.
    gained = [(np.array(results) == label)[:, frame.labels == 0].mean() for label in (3, 5, 7)]
    assert gained == pytest.approx([percent / 300.0] * 3, rel=0.2)


def test_a_picture_without_blocks_has_no_specks() -> None:
    nothing = frame_of(np.zeros((20, 20), np.uint16))
    assert not speckled(nothing, 50, random()).any()
