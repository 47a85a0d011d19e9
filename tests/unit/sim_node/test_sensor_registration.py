# SPDX-License-Identifier: Apache-2.0
"""Depth lies beside the colours by as much as was asked for, and is never mixed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sensor_frames import BLOCKS, table

from sim_node import DepthConfig, SensorConfig, sense
from sim_node.sensor.depth import shifted, with_depth_errors

SHIFTS = st.floats(-12.0, 12.0)


def pattern(height: int = 9, width: int = 11) -> np.ndarray:
    """No two depths are the same."""
    return (1.0 + np.arange(height * width, dtype=np.float32) / 100.0).reshape(height, width)


def measured(shift: tuple[float, float], **errors: Any) -> np.ndarray:
    config = DepthConfig(shift=shift, **errors)
    return with_depth_errors(table(), config, np.random.default_rng(5)).depth


def test_depth_is_shifted_right_and_down_and_nothing_comes_in() -> None:
    exact, seen = pattern(), shifted(pattern(), (2.0, 1.0))
    assert (seen[1:, 2:] == exact[:-1, :-2]).all()
    assert (seen[:1] == 0.0).all() and (seen[:, :2] == 0.0).all()
    assert seen.dtype == np.float32
    back = shifted(pattern(), (-2.0, -1.0))
    assert (back[:-1, :-2] == exact[1:, 2:]).all()
    assert (back[-1:] == 0.0).all() and (back[:, -2:] == 0.0).all()


@given(SHIFTS, SHIFTS)
def test_every_pixel_has_the_depth_nearest_to_where_it_comes_from(
    right: float, down: float
) -> None:
    exact, seen = pattern(), shifted(pattern(), (right, down))
    rows, columns = np.indices(exact.shape)
    for row, column in zip(*np.nonzero(seen), strict=True):
        ((from_row, from_column),) = np.argwhere(exact == seen[row, column])
        assert abs(row - down - from_row) <= 0.5 and abs(column - right - from_column) <= 0.5
    # Nothing that is in the picture is left out.
    inside = (np.abs(rows - down - 4.0) < 4.5) & (np.abs(columns - right - 5.0) < 5.5)
    assert (seen[inside] > 0.0).all() and not seen[~inside].any()


@given(SHIFTS, SHIFTS)
def test_the_other_way_is_the_same_in_a_mirror(right: float, down: float) -> None:
    mirrored = shifted(np.ascontiguousarray(pattern()[::-1, ::-1]), (-right, -down))
    assert (mirrored[::-1, ::-1] == shifted(pattern(), (right, down))).all()


@pytest.mark.parametrize("shift", [(0.4, -0.4), (0.5, -0.5), (1.5, 2.5), (0.0, 0.0)])
def test_fractions_are_those_of_the_nearest_pixel(shift: tuple[float, float]) -> None:
    whole = {(0.4, -0.4): (0, 0), (0.5, -0.5): (1, -1), (1.5, 2.5): (2, 3), (0.0, 0.0): (0, 0)}
    assert (shifted(pattern(), shift) == shifted(pattern(), whole[shift])).all()


def test_of_a_picture_that_is_shifted_away_nothing_is_left() -> None:
    assert not shifted(pattern(), (11.0, 0.0)).any()
    assert not shifted(pattern(), (0.0, -100.0)).any()


def test_depth_alone_is_shifted() -> None:
    frame = table()
    seen = sense(frame, SensorConfig(depth=DepthConfig(shift=(3.0, 0.0))))
    assert seen.rgb is frame.rgb and seen.labels is frame.labels
    rows, columns = BLOCKS[5]
    block, beside = frame.depth[rows, columns], slice(columns.start + 3, columns.stop + 3)
    assert (seen.depth[rows, beside] == block).all()
    assert (frame.depth == table().depth).all(), "the exact picture was written to"


@pytest.mark.parametrize("nothing", ["zero", "nan"])
def test_errors_are_shifted_with_the_depth_that_has_them(nothing: str) -> None:
    errors: dict[str, Any] = {
        "noise": 0.002, "edge_dropout": 0.5, "dropout": 0.02, "no_depth": nothing,
    }  # fmt: skip
    still, seen = measured((0.0, 0.0), **errors), measured((-1.0, 2.0), **errors)
    assert np.array_equal(seen[2:, :-1], still[:-2, 1:], equal_nan=True)
    outside = np.concatenate([seen[:2].ravel(), seen[:, -1]])
    assert (np.isnan(outside) if nothing == "nan" else outside == 0.0).all()
