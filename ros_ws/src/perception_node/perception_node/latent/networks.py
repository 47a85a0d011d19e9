# SPDX-License-Identifier: Apache-2.0
"""The two networks around the quantiser: image to features, quantised features to image.

Both look at a neighbourhood only, so that a block has the same code whatever stands far from it.
Neither normalises over the picture, for the same reason.
"""

from __future__ import annotations

from typing import Final

import torch
from torch import Tensor, nn

#: Edges of the image [px] and of the latent map.
IMAGE: Final = 128
MAP: Final = 32
_STRIDE: Final = IMAGE // MAP


def half_precision(wanted: bool = True) -> torch.autocast:
    """Within it convolutions are done in bfloat16, where the processor can: half the time.

    Args:
        wanted: False for a context in which nothing changes.
    """
    able = torch.ops.mkldnn._is_mkldnn_bf16_supported()
    return torch.autocast("cpu", torch.bfloat16, enabled=wanted and able)


class _Residual(nn.Module):
    def __init__(self, width: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(width, width, 3, padding=1)
        self.second = nn.Conv2d(width, width, 3, padding=1)
        for parameter in self.second.parameters():
            nn.init.zeros_(parameter)

    def forward(self, x: Tensor) -> Tensor:
        inner = self.second(nn.functional.silu(self.first(nn.functional.silu(x))))
        return torch.add(x, inner)


class _Body(nn.Module):
    """From (n, w, 32, 32) to the same, by way of (n, 2w, 16, 16); knows where it is."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.where = nn.Parameter(torch.zeros(1, width, MAP, MAP))
        self.down = nn.Conv2d(width, 2 * width, 2, stride=2)
        self.coarse = _Residual(2 * width)
        self.up = nn.ConvTranspose2d(2 * width, width, 2, stride=2)
        self.fine = _Residual(width)

    def forward(self, x: Tensor) -> Tensor:
        x = x + self.where
        x = x + self.up(nn.functional.silu(self.coarse(self.down(nn.functional.silu(x)))))
        return nn.functional.silu(self.fine(x))


class Encoder(nn.Module):
    """Images (n, 3, 128, 128) of values 0 to 1 -> features (n, o, 32, 32)."""

    def __init__(self, channels: int, width: int) -> None:
        super().__init__()
        self.stem = nn.Conv2d(3 * _STRIDE**2, width, 3, padding=1)
        self.body = _Body(width)
        self.head = nn.Conv2d(width, channels, 1)

    def forward(self, images: Tensor) -> Tensor:
        """See the class."""
        cells = nn.functional.pixel_unshuffle(images - 0.5, _STRIDE)
        features: Tensor = self.head(self.body(self.stem(cells)))
        return features


class Decoder(nn.Module):
    """Quantised features (n, o, 32, 32) -> images (n, 3, 128, 128)."""

    def __init__(self, channels: int, width: int) -> None:
        super().__init__()
        self.stem = nn.Conv2d(channels, width, 3, padding=1)
        self.body = _Body(width)
        self.head = nn.Conv2d(width, 3 * _STRIDE**2, 1)

    def forward(self, quantised: Tensor) -> Tensor:
        """See the class."""
        return (
            nn.functional.pixel_shuffle(self.head(self.body(self.stem(quantised))), _STRIDE) + 0.5
        )
