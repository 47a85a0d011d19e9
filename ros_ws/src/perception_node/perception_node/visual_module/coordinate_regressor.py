# SPDX-License-Identifier: Apache-2.0
"""Coordinate regressors π: from one object's image u_i to its coordinates φ (5.2.1, A.2.1).

Two kinds. The thesis' ResNet-34 with a sigmoid-activated layer FC(512, 2), which can only
interpolate between the places it was trained on; and the default, a small fully convolutional
network that points at the object. Moving the object moves where it points by the same amount, so
what was learnt on towers of five holds for towers of seven.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import torch
from torch import Tensor, nn


class PointingRegressor(nn.Module):
    """Convolutions, two heat maps, and their expected positions (a spatial soft-argmax).

    φ = scale * (E[x], E[y]) + offset, where the expectation of x is over the first map's softmax,
    that of y over the second's. Positions run from the image's bottom-left corner, 0..1.
    """

    def __init__(self, channels: int = 32) -> None:
        super().__init__()
        half = channels // 2
        self.features = nn.Sequential(
            _block(3, half, 5, stride=2),
            _block(half, channels, 3, stride=2),
            _block(channels, channels, 3),
            _block(channels, channels, 3, dilation=2),
            _block(channels, channels, 3, dilation=4),
            _block(channels, channels, 3),
        )
        self.heat = nn.Conv2d(channels, 2, 1)
        # Uniform heat maps and φ = (0.5, 0.5) at the start: neither corner is preferred.
        for parameter in self.heat.parameters():
            nn.init.zeros_(parameter)
        self.scale = nn.Parameter(torch.ones(2))
        self.offset = nn.Parameter(torch.zeros(2))

    def forward(self, images: Tensor) -> Tensor:
        """u_i in 0..1, shape (n, 3, height, width) -> φ, shape (n, 2)."""
        return self.pointed(self.heat(self.features(images)))

    def pointed(self, heat: Tensor) -> Tensor:
        """Where heat maps point to, shape (n, 2, rows, columns) -> φ, shape (n, 2)."""
        heat = heat.float()
        n, _, rows, columns = heat.shape
        weights = heat.flatten(2).softmax(-1).view(n, 2, rows, columns)
        x = (torch.arange(columns, device=heat.device) + 0.5) / columns
        y = 1.0 - (torch.arange(rows, device=heat.device) + 0.5) / rows
        expected_x = (weights[:, 0].sum(1) * x).sum(-1)
        expected_y = (weights[:, 1].sum(2) * y).sum(-1)
        return torch.stack([expected_x, expected_y], 1) * self.scale + self.offset


class ResNetRegressor(nn.Module):
    """The thesis' regressor: a ResNet whose last layer is a sigmoid-activated FC(512, 2)."""

    def __init__(self, build: Callable[..., nn.Module], weights: str | None = None) -> None:
        super().__init__()
        self.network = build(weights=weights)
        self.network.fc = nn.Linear(512, 2)
        # The last layer starts at zero, so that φ starts in the middle of the image.
        nn.init.zeros_(self.network.fc.weight)
        nn.init.zeros_(self.network.fc.bias)

    def forward(self, images: Tensor) -> Tensor:
        """u_i in 0..1, shape (n, 3, height, width) -> φ, shape (n, 2)."""
        return torch.sigmoid(self.network(images).float())


def _block(
    inputs: int, outputs: int, kernel: int, stride: int = 1, dilation: int = 1
) -> nn.Sequential:
    padding = dilation * (kernel // 2)
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, kernel, stride, padding, dilation, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )


DEFAULT_BACKBONE: Final = "pointing"
BACKBONES: Final[tuple[str, ...]] = (DEFAULT_BACKBONE, "resnet18", "resnet34")


def make_regressor(backbone: str, imagenet: bool = False) -> nn.Module:
    """A fresh π.

    Args:
        backbone: one of ``BACKBONES``.
        imagenet: start from torchvision's ImageNet weights (downloads them; ResNets only).

    Raises:
        ValueError: for an unknown backbone, or ImageNet weights where there are none.
        OSError: if the ImageNet weights cannot be downloaded.
    """
    if backbone not in BACKBONES:
        raise ValueError(f"unknown backbone {backbone!r}; there are {', '.join(BACKBONES)}")
    if backbone == DEFAULT_BACKBONE:
        if imagenet:
            raise ValueError(f"there are no ImageNet weights of the backbone {backbone!r}")
        return PointingRegressor()
    # torchvision is slow to import, and the default backbone needs none of it.
    from torchvision import models

    build = {"resnet18": models.resnet18, "resnet34": models.resnet34}[backbone]
    return ResNetRegressor(build, "DEFAULT" if imagenet else None)
