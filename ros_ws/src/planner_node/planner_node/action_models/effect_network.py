# SPDX-License-Identifier: Apache-2.0
"""The networks of the learnt action model M2 (4.2.2): what a move does to a code, and which can be.

The code is cut into patches of 4 x 4 places. Patches whose bits no training picture ever changed
are copied. The others are tokens of a transformer: what comes to a place depends on what is there
and on what is taken from elsewhere, wherever that is, and so it can look there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import torch
from torch import Tensor, nn

#: Edges of the latent map and of a patch, in places.
MAP: Final = 32
PATCH: Final = 4
#: How sure a bit is of staying what it is before anything was learnt.
_COPY_LOGIT: Final = 2.0


@dataclass(frozen=True)
class EffectConfig:
    """What the networks are like.

    Attributes:
        bits: of the code at each place.
        moves: number of actions in A.
        width, layers, heads: of the transformer.
        hidden: of the discriminator.
    """

    bits: int = 8
    moves: int = 6
    width: int = 96
    layers: int = 3
    heads: int = 4
    hidden: int = 64

    @property
    def values(self) -> int:
        """Bits of a patch."""
        return self.bits * PATCH * PATCH


def patches_of(bits: Tensor) -> Tensor:
    """Bits (n, b, 32, 32) as patches (n, 64, b · 16)."""
    return nn.functional.pixel_unshuffle(bits, PATCH).flatten(2).transpose(1, 2)


def bits_of_patches(patches: Tensor) -> Tensor:
    """The inverse of :func:`patches_of`."""
    side = MAP // PATCH
    return nn.functional.pixel_shuffle(patches.transpose(1, 2).unflatten(2, (side, side)), PATCH)


class EffectNetwork(nn.Module):
    """π: the bits after a move, as logits. Patches that never change are not asked about.

    Args:
        active: which patches ever change, shape (64,) bool.
    """

    active: Tensor

    def __init__(self, config: EffectConfig, active: Tensor) -> None:
        super().__init__()
        self.config = config
        self.register_buffer("active", active.bool())
        tokens = int(active.sum())
        self.read = nn.Linear(config.values, config.width)
        self.where = nn.Parameter(0.02 * torch.randn(1, tokens, config.width))
        self.action = nn.Embedding(config.moves, config.width)
        self.place = nn.Parameter(0.02 * torch.randn(config.moves, tokens, config.width))
        layer = nn.TransformerEncoderLayer(
            config.width,
            config.heads,
            2 * config.width,
            dropout=0.0,
            activation="gelu",
            batch_first=True,
            norm_first=True,
        )
        self.layers = nn.TransformerEncoder(layer, config.layers, enable_nested_tensor=False)
        self.write = nn.Linear(config.width, config.values)
        self.copy = nn.Parameter(torch.tensor(_COPY_LOGIT))

    def forward(self, patches: Tensor, moves: Tensor) -> Tensor:
        """Active patches (n, t, v) of 0 and 1, and actions (n,) -> logits (n, t, v)."""
        signs = 2.0 * patches - 1.0
        tokens = self.read(signs) + self.where
        tokens = tokens + self.action(moves)[:, None] + self.place[moves]
        logits: Tensor = self.write(self.layers(tokens)) + self.copy * signs
        return logits

    def after(self, bits: Tensor, moves: Tensor) -> tuple[Tensor, Tensor]:
        """Bits (n, b, 32, 32) and actions (n,) -> the bits after, and the least margin (n,)."""
        patches = patches_of(bits).clone()
        logits = self(patches[:, self.active], moves)
        patches[:, self.active] = (logits > 0.0).to(patches.dtype)
        return bits_of_patches(patches), logits.abs().flatten(1).amin(1)


class Discriminator(nn.Module):
    """D: which actions are possible in a state, as logits."""

    active: Tensor

    def __init__(self, config: EffectConfig, active: Tensor) -> None:
        super().__init__()
        self.register_buffer("active", active.bool())
        self.layers = nn.Sequential(
            nn.Flatten(),
            nn.Linear(int(active.sum()) * config.values, config.hidden),
            nn.SiLU(),
            nn.Linear(config.hidden, config.moves),
        )

    def forward(self, patches: Tensor) -> Tensor:
        """Active patches (n, t, v) of 0 and 1 -> logits (n, |A|)."""
        logits: Tensor = self.layers(2.0 * patches - 1.0)
        return logits

    def possible(self, bits: Tensor) -> Tensor:
        """Which actions are possible: bits (n, b, 32, 32) -> (n, |A|) bool."""
        possible: Tensor = self(patches_of(bits)[:, self.active]) > 0.0
        return possible
