# SPDX-License-Identifier: Apache-2.0
"""Colours have the errors that were asked for, of the size that was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from sensor_frames import even

from sim_node import ColorConfig
from sim_node.sensor.color import with_color_errors


def colored(value: int, config: ColorConfig) -> np.ndarray:
    return with_color_errors(even(1.0, value), config, np.random.default_rng(5)).rgb


@pytest.mark.parametrize("sigma", [2.0, 10.0])
def test_noise_is_as_strong_as_declared_in_every_channel(sigma: float) -> None:
    errors = colored(100, ColorConfig(noise=sigma)).astype(float) - 100.0
    # Whole numbers add the variance of rounding, 1/12.
    assert errors.std(axis=(0, 1)) == pytest.approx(np.sqrt(sigma**2 + 1.0 / 12.0), rel=0.01)
    assert np.abs(errors.mean(axis=(0, 1))).max() < 4.0 * sigma / 300.0
    channels = np.corrcoef(errors.reshape(-1, 3).T)
    assert np.abs(channels - np.eye(3)).max() < 0.02


def test_exposure_and_cast_are_factors_that_saturate() -> None:
    frame = even(1.0, side=16)
    frame.rgb[:] = np.arange(256, dtype=np.uint8).reshape(16, 16, 1)
    config = ColorConfig(exposure=1.5, cast=(1.2, 1.0, 0.5))
    rgb = with_color_errors(frame, config, np.random.default_rng(0)).rgb
    expected = np.minimum(frame.rgb * np.array([1.8, 1.5, 0.75]), 255.0)
    assert np.abs(rgb - expected).max() <= 0.5 + 1e-4
    assert rgb.dtype == np.uint8 and rgb.max() == 255


def test_what_saturates_is_noisy_but_within_range() -> None:
    rgb = colored(255, ColorConfig(noise=10.0, exposure=2.0))
    assert rgb.max() == 255
    # Half of the errors are cut off.
    assert (rgb == 255).mean() == pytest.approx(0.52, abs=0.02)
    assert colored(0, ColorConfig(noise=10.0)).min() == 0


def test_without_light_all_is_black() -> None:
    assert not colored(200, ColorConfig(exposure=0.0)).any()
