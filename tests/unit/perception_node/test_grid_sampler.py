# SPDX-License-Identifier: Apache-2.0
"""The affine grid sampler ρ moves the default crop by φ (A.2.1)."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from perception_node.visual_module.grid_sampler import (
    pixels_from_coordinates,
    sample,
    translation_matrix,
)

SIZE = 128


def default_crop(width: int = 12, height: int = 14) -> torch.Tensor:
    crop = torch.zeros(1, 1, SIZE, SIZE)
    crop[..., SIZE - height :, :width] = 0.2 + 0.8 * torch.rand(
        height, width, generator=torch.Generator().manual_seed(0)
    )
    return crop


def test_the_matrix_is_that_of_the_thesis() -> None:
    matrix = translation_matrix(torch.tensor([[0.25, 0.5]]), 1.6)[0]
    assert matrix.numpy() == pytest.approx(np.array([[1.0, 0.0, -0.4], [0.0, 1.0, 0.8]]))


@given(st.integers(0, SIZE - 12), st.integers(0, SIZE - 14))
def test_whole_pixels_are_moved_exactly_right_and_up(right: int, up: int) -> None:
    crop = default_crop()
    moved = sample(crop, torch.tensor([[right / SIZE, up / SIZE]]), 2.0)
    expected = torch.roll(crop, (-up, right), (2, 3))
    assert torch.allclose(moved, expected, atol=1e-4)


@given(st.floats(0.0, 0.8), st.floats(0.0, 0.8))
def test_nothing_is_gained_or_lost_inside_the_image(a: float, b: float) -> None:
    crop = default_crop()
    moved = sample(crop, torch.tensor([[a, b]]), 2.0)
    assert float(moved.sum()) == pytest.approx(float(crop.sum()), rel=1e-3)


def test_factor_two_covers_the_image_and_the_thesis_factor_four_fifths_of_it() -> None:
    one = torch.ones(1, 2)
    assert pixels_from_coordinates(one, SIZE, 2.0).tolist() == [[SIZE, SIZE]]
    assert pixels_from_coordinates(one, SIZE, 1.6)[0, 0] == pytest.approx(0.8 * SIZE)


def test_the_gradient_of_the_error_moves_the_crop_towards_the_target() -> None:
    crop = default_crop().gt(0).float()
    target = torch.roll(crop, (-30, 40), (2, 3))
    coordinates = torch.tensor([[38.5 / SIZE, 32.5 / SIZE]], requires_grad=True)
    (sample(crop, coordinates, 2.0) - target).square().sum().backward()
    assert coordinates.grad is not None
    assert coordinates.grad[0, 0] < 0 < coordinates.grad[0, 1]
