# SPDX-License-Identifier: Apache-2.0
"""Colours are smeared and compressed as a lens and a driver do it."""

from __future__ import annotations

import io

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy.ndimage import gaussian_filter
from scipy.stats import norm
from sensor_frames import even, table

from sim_node import ColorConfig, Frame
from sim_node.sensor.color import blurred, compressed, with_color_errors


def colored(rgb: np.ndarray, **errors: object) -> np.ndarray:
    height, width = rgb.shape[:2]
    frame = Frame(rgb, np.ones((height, width), np.float32), np.zeros((height, width), np.uint16))
    config = ColorConfig(**errors)  # type: ignore[arg-type]
    return with_color_errors(frame, config, np.random.default_rng(5)).rgb


def step(low: int, high: int, side: int = 64) -> np.ndarray:
    """Low values in the left half, high ones in the right half."""
    rgb = np.full((side, side, 3), low, np.uint8)
    rgb[:, side // 2 :] = high
    return rgb


def waves(side: int = 128) -> np.ndarray:
    """Smooth colours, without any edge."""
    rows, columns = np.mgrid[:side, :side] * (2.0 * np.pi / side)
    channels = [np.sin(rows), np.cos(columns), np.sin(rows + columns)]
    return np.rint(128.0 + 80.0 * np.stack(channels, axis=-1)).astype(np.uint8)


@pytest.mark.parametrize("sigma", [0.3, 0.7, 1.0, 2.5])
@pytest.mark.parametrize("upright", [True, False])
def test_a_blurred_edge_is_the_distribution_of_a_gaussian(sigma: float, upright: bool) -> None:
    rgb = step(20, 220)
    seen = colored(rgb if upright else rgb.swapaxes(0, 1), blur=sigma)
    seen = seen if upright else seen.swapaxes(0, 1)
    middles = np.arange(64) + 0.5 - 32.0
    expected = 20.0 + 200.0 * norm.cdf(middles / sigma)
    assert np.abs(seen - expected[None, :, None]).max() <= 0.5 + 0.02


def test_blur_is_that_of_a_gaussian_in_any_picture() -> None:
    light = np.random.default_rng(1).uniform(0.0, 255.0, (80, 60, 3)).astype(np.float32)
    # The light of a square of a pixel, and not that of a point in it: a little wider.
    sigma = np.sqrt(2.0**2 + 1.0 / 12.0)
    expected = gaussian_filter(light, (sigma, sigma, 0.0), mode="reflect", truncate=6.0)
    assert np.abs(blurred(light, 2.0) - expected).max() < 0.1


@given(
    arrays(
        np.float32,
        st.tuples(st.integers(1, 12), st.integers(1, 12), st.just(3)),
        elements=st.floats(0.0, 255.0, width=32),
    ),
    st.floats(0.05, 5.0),
)
def test_blur_neither_makes_light_nor_loses_any(light: np.ndarray, sigma: float) -> None:
    spread = blurred(light, sigma)
    assert spread.shape == light.shape and spread.dtype == np.float32
    assert spread.mean(axis=(0, 1)) == pytest.approx(light.mean(axis=(0, 1)), abs=1e-2)
    assert spread.min() >= light.min() - 1e-2 and spread.max() <= light.max() + 1e-2


def test_light_is_blurred_before_it_saturates() -> None:
    # 300 of 255 in the right half: the edge is that of the light, and is cut off only then.
    seen = colored(step(0, 150), blur=2.0, exposure=2.0)
    light = 300.0 * norm.cdf((np.arange(64) + 0.5 - 32.0) / 2.0)
    assert np.abs(seen[0, :, 0] - np.minimum(light, 255.0)).max() <= 0.5 + 0.03


def test_noise_comes_after_the_lens_and_is_not_blurred() -> None:
    seen = [
        with_color_errors(even(1.0), config, np.random.default_rng(5)).rgb
        for config in (ColorConfig(noise=4.0), ColorConfig(noise=4.0, blur=2.0))
    ]
    assert np.abs(seen[0].astype(int) - seen[1]).max() <= 1  # rounded the other way
    errors = seen[1][..., 0] - 100.0
    assert abs(np.mean(errors[:, 1:] * errors[:, :-1])) < 0.02 * np.mean(errors**2)


def test_jpeg_of_the_best_quality_changes_few_grey_levels() -> None:
    assert np.abs(colored(waves(), jpeg_quality=100).astype(int) - waves()).max() <= 6


def test_the_worse_the_quality_the_farther_it_is_from_the_picture() -> None:
    exact = step(20, 220)
    exact[::7] = (200, 30, 60)
    errors = [
        np.abs(colored(exact, jpeg_quality=quality).astype(float) - exact).mean()
        for quality in (95, 50, 10)
    ]
    assert errors == sorted(errors)
    assert errors[-1] > errors[0] + 1.0


def test_a_second_decoder_reads_the_same_picture() -> None:
    image = pytest.importorskip("PIL.Image")
    rgb = table().rgb
    done, data = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 60])
    assert done
    expected = np.asarray(image.open(io.BytesIO(data.tobytes())).convert("RGB")).astype(int)
    assert np.abs(colored(rgb, jpeg_quality=60) - expected).max() <= 2


def test_colours_are_kept_in_their_order_and_coarser_than_light() -> None:
    red = np.zeros((32, 32, 3), np.uint8)
    red[..., 0] = 200
    assert np.abs(colored(red, jpeg_quality=95).astype(int) - red).max() <= 4
    # Red and green in turns, pixel by pixel, as bright as one another (ITU-R BT.601): of that
    # nothing but their mean is left, and of black and white in turns nearly all.
    turns = np.zeros((32, 32, 3), np.uint8)
    turns[:, ::2, 0], turns[:, 1::2, 1] = 196, 100
    seen = colored(turns, jpeg_quality=100).astype(int)
    assert np.abs(np.diff(seen[..., 0], axis=1)).max() < 30
    turns[:, ::2], turns[:, 1::2] = 50, 200
    seen = colored(turns, jpeg_quality=100).astype(int)
    assert np.abs(np.diff(seen[..., 0], axis=1)).min() > 140


def test_noise_is_compressed_with_the_rest() -> None:
    noisy = colored(waves(), noise=6.0)
    assert (colored(waves(), noise=6.0, jpeg_quality=40) == compressed(noisy, 40)).all()
    assert (compressed(noisy, 40) != noisy).any()


@given(
    array_shapes(min_dims=2, max_dims=2, max_side=20).flatmap(
        lambda shape: arrays(np.uint8, (*shape, 3))
    ),
    st.integers(1, 100),
)
def test_any_picture_can_be_compressed(rgb: np.ndarray, quality: int) -> None:
    before = rgb.copy()
    seen = compressed(rgb, quality)
    assert seen.shape == rgb.shape and seen.dtype == np.uint8
    assert (rgb == before).all() and (compressed(rgb, quality) == seen).all()


def test_without_either_colours_stay_what_they_are() -> None:
    exact = table().rgb
    assert (colored(exact) == exact).all()
    light = exact.astype(np.float32)
    assert blurred(light, 0.0) is light and compressed(exact, 0) is exact
