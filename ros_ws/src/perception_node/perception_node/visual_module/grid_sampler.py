# SPDX-License-Identifier: Apache-2.0
"""The affine grid sampler ρ: puts a default image where coordinates φ say (3.1.2, A.2.1)."""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional


def translation_matrix(coordinates: Tensor, factor: float) -> Tensor:
    """The matrix α of A.2.1 with ``factor`` in place of its 1.6.

    α = [[1, 0, -factor·a], [0, 1, factor·b]] maps points of the output to points of the input in
    normalised coordinates (-1..1, y down), so content moves right by a and up by b.

    Args:
        coordinates: φ = (a, b), shape (n, 2), in 0..1 from the bottom-left corner.
        factor: 2 lets φ in 0..1 cover the whole image, the thesis' 1.6 four fifths of it.

    Returns:
        Shape (n, 2, 3).
    """
    a, b = coordinates[:, 0], coordinates[:, 1]
    one, zero = torch.ones_like(a), torch.zeros_like(a)
    rows = [torch.stack([one, zero, -factor * a], 1), torch.stack([zero, one, factor * b], 1)]
    return torch.stack(rows, 1)


def sample(default: Tensor, coordinates: Tensor, factor: float) -> Tensor:
    """ũ = ρ(φ, u_def): bilinear (eq. 3.1), zero outside; differentiable in φ.

    Args:
        default: u_def, shape (n, channels, height, width), content at the bottom-left corner.
        coordinates: φ, shape (n, 2).
        factor: see :func:`translation_matrix`.

    Returns:
        Shape of ``default``.
    """
    matrix = translation_matrix(coordinates, factor).to(default.dtype)
    grid = functional.affine_grid(matrix, list(default.shape), align_corners=False)
    return functional.grid_sample(default, grid, padding_mode="zeros", align_corners=False)


def pixels_from_coordinates(coordinates: Tensor, size: int, factor: float) -> Tensor:
    """Translation that φ stands for in a square image of ``size``, right and up [px], (n, 2)."""
    return coordinates * (0.5 * factor * size)
