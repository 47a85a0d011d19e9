# SPDX-License-Identifier: Apache-2.0
"""Depth has the errors that were asked for, of the size that was asked for.

Seeds are fixed, so bounds on statistics hold every time or never.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import binary_dilation, uniform_filter
from sensor_frames import even, table

from sim_node import DepthConfig, Frame
from sim_node.sensor.depth import depth_edges, millimetres, quantised, with_depth_errors


def measured(frame: Frame, **errors: object) -> np.ndarray:
    return with_depth_errors(frame, DepthConfig(**errors), np.random.default_rng(5)).depth  # type: ignore[arg-type]


@pytest.mark.parametrize("distance", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("correlation", [0.0, 1.5, 4.0])
def test_noise_grows_with_the_square_of_the_distance(distance: float, correlation: float) -> None:
    depth = measured(even(distance), noise=0.002, noise_correlation=correlation)
    errors = (depth - distance) / (0.002 * distance**2)
    # 90,000 pixels are so many independent ones.
    independent = errors.size / max(1.0, 4.0 * np.pi * correlation**2)
    assert errors.std() == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * independent))
    assert abs(errors.mean()) < 4.0 / np.sqrt(independent)
    assert np.abs(errors).max() < 6.0


def test_correlated_noise_is_as_strong_at_the_borders() -> None:
    border = [
        (with_depth_errors(even(1.0, side=40), config, np.random.default_rng(seed)).depth - 1.0)[0]
        for config in [DepthConfig(noise=0.002, noise_correlation=2.0)]
        for seed in range(300)
    ]
    assert np.std(border) == pytest.approx(0.002, rel=0.05)


def test_noise_of_neighbours_is_correlated_as_declared() -> None:
    sigma = 3.0
    errors = measured(even(1.0), noise=0.002, noise_correlation=sigma) - 1.0
    for lag in (1, 3, 6):
        together = np.mean(errors[:, lag:] * errors[:, :-lag]) / np.mean(errors**2)
        # The product of two Gaussians that far apart, integrated.
        assert together == pytest.approx(np.exp(-(lag**2) / (4.0 * sigma**2)), abs=0.1)
    alone = measured(even(1.0), noise=0.002) - 1.0
    assert abs(np.mean(alone[:, 1:] * alone[:, :-1])) < 0.02 * np.mean(alone**2)


def test_what_has_no_depth_gets_none() -> None:
    frame = table()
    depth = measured(frame, noise=0.05, noise_correlation=1.0, step=0.01)
    assert (depth[frame.depth == 0.0] == 0.0).all()
    assert depth.dtype == np.float32
    assert (measured(frame, noise=0.1) >= 0.0).all()


def test_edges_are_where_blocks_end_and_not_on_the_table() -> None:
    frame = table()
    edges = depth_edges(frame.depth, 0.015)
    cross = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], bool)
    outlines = np.zeros_like(edges)
    block = frame.labels > 0
    for region in (block, frame.depth > 0.0):
        outlines |= (binary_dilation(region, cross) & ~region) | (
            region & binary_dilation(~region, cross)
        )
    assert edges.sum() > 300
    assert (edges == outlines).all()


@pytest.mark.parametrize("width", [1, 2, 5])
def test_depth_drops_out_near_edges_only(width: int) -> None:
    frame = table()
    near = depth_edges(frame.depth, 0.015)
    if width > 1:
        near = binary_dilation(near, np.ones((3, 3)), iterations=width - 1)
    near &= frame.depth > 0.0
    lost = measured(frame, edge_dropout=1.0, edge_width=width) != frame.depth
    assert (lost == near).all()
    half = measured(frame, edge_dropout=0.5, edge_width=width) != frame.depth
    assert not (half & ~near).any()
    assert half.sum() / near.sum() == pytest.approx(0.5, abs=2.5 / np.sqrt(near.sum()))


def test_depth_drops_out_anywhere_with_its_probability() -> None:
    lost = measured(even(1.0), dropout=0.1) == 0.0
    assert lost.mean() == pytest.approx(0.1, abs=0.004)
    # As often in every part of the picture.
    assert uniform_filter(lost.astype(float), 100)[50:-50, 50:-50].std() < 0.01


@pytest.mark.parametrize("nothing", ["zero", "nan"])
def test_no_depth_is_what_the_driver_says_it_is(nothing: str) -> None:
    frame = table()
    depth = measured(frame, no_depth=nothing, edge_dropout=1.0)
    none = np.isnan(depth) if nothing == "nan" else depth == 0.0
    assert none[frame.depth == 0.0].all()
    assert none.sum() > (frame.depth == 0.0).sum()
    assert (depth[~none] == frame.depth[~none]).all()


@given(st.floats(0.2, 5.0), st.floats(1e-4, 0.02))
def test_steps_grow_as_those_of_disparities(distance: float, step: float) -> None:
    depth = float(quantised(np.full((1, 1), distance, np.float32), step, grows=True)[0, 0])
    disparity = 1.0 / depth / step
    assert disparity == pytest.approx(round(disparity), abs=1e-6 * disparity + 1e-6)
    assert abs(1.0 / depth - 1.0 / np.float32(distance)) <= 0.5 * step * (1.0 + 1e-5) + 1e-6


def test_steps_are_as_wide_as_declared() -> None:
    for distance in (0.5, 1.0, 2.0):
        ramp = np.linspace(0.97 * distance, 1.03 * distance, 200_000, dtype=np.float32)[None]
        steps = np.diff(np.unique(quantised(ramp, 0.002, grows=True)))
        assert steps == pytest.approx(0.002 * distance**2, rel=0.07)
        steps = np.diff(np.unique(quantised(ramp, 0.002, grows=False)))
        assert steps == pytest.approx(0.002, rel=1e-3)


def test_millimetres_are_whole_and_none_is_0() -> None:
    depth = np.array([[0.0, np.nan, 0.0004, 0.4564, 0.4566, 65.535, 65.54, np.inf]], np.float32)
    assert millimetres(depth).tolist() == [[0, 0, 0, 456, 457, 65535, 0, 0]]
    assert millimetres(depth).dtype == np.uint16
    frame = table()
    back = millimetres(frame.depth) / 1000.0
    assert np.abs(back - frame.depth).max() <= 0.0005 + 1e-6
