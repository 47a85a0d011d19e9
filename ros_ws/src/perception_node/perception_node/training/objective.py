# SPDX-License-Identifier: Apache-2.0
"""The self-supervised training objective (eq. 5.3)."""

from __future__ import annotations

from torch import Tensor
from torch.nn import functional

#: Levels of the pyramid: squared errors are taken at full size and at 1/2, 1/4, … 1/32 of it.
LEVELS = 6


def reconstruction_loss(predicted: Tensor, target: Tensor, levels: int = LEVELS) -> Tensor:
    """l = l_mse(Σ ũ_i, Σ u_i) + Σ l_mse(ũ_i, u_i), on a pyramid of resolutions.

    Where ũ_i and u_i do not overlap, the plain squared error does not change when ũ_i moves a
    little, and nothing is learnt. Averaged over larger and larger squares they do overlap. The
    exact coordinates are still those of the finest level, where the other levels are zero as well.

    The squared errors of a level are divided by the squares of its target, so that every level
    counts alike, whatever the size and colour of the objects.

    Args:
        predicted: ũ_i, shape (scenes, objects, channels, size, size).
        target: u_i, the same shape.

    Returns:
        A scalar, the mean over scenes.
    """
    total = predicted.new_zeros(())
    objects = predicted.shape[1]
    difference, reference = (predicted - target).flatten(0, 1), target.flatten(0, 1)
    for level in range(levels):
        if level:
            difference = functional.avg_pool2d(difference, 2)
            reference = functional.avg_pool2d(reference, 2)
        power = reference.square().mean() + 1e-9
        scene = difference.unflatten(0, (-1, objects)).sum(1)
        total = total + (scene.square().mean() + objects * difference.square().mean()) / power
    return total / (levels * objects)
