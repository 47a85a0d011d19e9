# SPDX-License-Identifier: Apache-2.0
"""The training objective (eq. 5.3) teaches also where crop and target do not overlap."""

import pytest
import torch

from perception_node.training.objective import reconstruction_loss
from perception_node.visual_module.grid_sampler import sample


def crop() -> torch.Tensor:
    image = torch.zeros(1, 3, 128, 128)
    image[..., 114:, :12] = 0.7
    return image


def loss_at(distance: int, levels: int) -> float:
    """Of a crop that is off its target by so many pixels, right and up."""
    target = torch.roll(crop(), (-80, 80), (2, 3))[:, None]
    place = (80 - distance) / 128
    predicted = sample(crop(), torch.tensor([[place, place]]), 2.0)[:, None]
    return float(reconstruction_loss(predicted, target, levels))


def test_a_perfect_reconstruction_costs_nothing() -> None:
    scene = torch.rand(2, 5, 3, 64, 64)
    assert float(reconstruction_loss(scene, scene)) == 0.0


def test_the_plain_error_says_nothing_about_a_far_target_the_pyramid_does() -> None:
    plain = [loss_at(distance, levels=1) for distance in (70, 50, 30)]
    assert plain == pytest.approx([plain[0]] * 3, rel=1e-3)
    pyramid = [loss_at(distance, levels=6) for distance in (16, 8, 4, 2, 1, 0)]
    assert pyramid == sorted(pyramid, reverse=True)
    assert pyramid[-1] == pytest.approx(0.0, abs=1e-6)


def test_the_scene_term_sees_objects_that_change_places() -> None:
    scene = torch.zeros(1, 2, 3, 64, 64)
    scene[0, 0, :, 10:20, 10:20] = 0.5
    scene[0, 1, :, 40:50, 40:50] = 0.5
    swapped = scene.flip(1)
    # The sum over objects is the same, so only the second term of eq. 5.3 remains.
    loss = reconstruction_loss(swapped, scene, levels=1)
    difference, power = (swapped - scene).square().mean(), scene.square().mean()
    assert float(loss) == pytest.approx(float(difference / power), rel=1e-4)
