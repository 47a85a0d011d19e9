# SPDX-License-Identifier: Apache-2.0
"""The networks of the learnt action model M2 (4.2.2): what a move does to a code, and which can be.

The code has parts that change by themselves, found without labels. Each part is a token of a
transformer, read by weights of its own into a language that all of them share, in which what an
action takes from one and gives to another is learnt once. Bits of no part are copied.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

#: How sure a bit is of staying what it is before anything was learnt.
_COPY_LOGIT: Final = 2.0


@dataclass(frozen=True)
class EffectConfig:
    """What the networks are like.

    Attributes:
        moves: number of actions in A.
        width, layers, heads: of the transformer.
        hidden: of the discriminator.
    """

    moves: int = 6
    width: int = 128
    layers: int = 3
    heads: int = 4
    hidden: int = 64


class _Parts(nn.Module):
    """Which bits of a code belong to parts, and how many to each."""

    index: Tensor
    sizes: Tensor

    def __init__(self, parts: Sequence[NDArray[np.int64]]) -> None:
        super().__init__()
        self.register_buffer("index", torch.from_numpy(np.concatenate(parts).astype(np.int64)))
        self.register_buffer("sizes", torch.tensor([len(part) for part in parts]))

    @property
    def lengths(self) -> list[int]:
        """Bits of each part."""
        lengths: list[int] = self.sizes.tolist()
        return lengths


class EffectNetwork(_Parts):
    """π: the bits of all parts after a move, as logits.

    Args:
        parts: the bits of each part, as indices into a code.
    """

    def __init__(self, config: EffectConfig, parts: Sequence[NDArray[np.int64]]) -> None:
        super().__init__(parts)
        self.config = config
        width, lengths = config.width, self.lengths
        self.read = nn.ModuleList(nn.Linear(length, width) for length in lengths)
        self.write = nn.ModuleList(nn.Linear(width, length) for length in lengths)
        #: What an action means to each part.
        self.action = nn.Parameter(0.3 * torch.randn(config.moves, len(lengths), width))
        layer = nn.TransformerEncoderLayer(
            width,
            config.heads,
            4 * width,
            dropout=0.0,
            activation="gelu",
            batch_first=True,
            norm_first=True,
        )
        self.layers = nn.TransformerEncoder(layer, config.layers, enable_nested_tensor=False)
        self.copy = nn.Parameter(torch.tensor(_COPY_LOGIT))

    def forward(self, values: Tensor, moves: Tensor) -> Tensor:
        """Bits of all parts (n, m), 0 and 1, and actions (n,) -> logits (n, m)."""
        signs = 2.0 * values - 1.0
        each = signs.split(self.lengths, dim=1)
        tokens = torch.stack([read(part) for read, part in zip(self.read, each)], dim=1)
        tokens = self.layers(tokens + self.action[moves])
        written = [write(tokens[:, number]) for number, write in enumerate(self.write)]
        logits: Tensor = torch.cat(written, dim=1) + self.copy * signs
        return logits

    def after(self, bits: Tensor, moves: Tensor) -> Tensor:
        """What moves do: bits (n, b) and actions (n,) -> bits (n, b)."""
        changed = bits.clone()
        changed[:, self.index] = (self(bits[:, self.index], moves) > 0.0).to(bits.dtype)
        return changed


class Discriminator(_Parts):
    """D: which actions are possible in a state, as logits."""

    def __init__(self, config: EffectConfig, parts: Sequence[NDArray[np.int64]]) -> None:
        super().__init__(parts)
        self.layers = nn.Sequential(
            nn.Linear(len(self.index), config.hidden),
            nn.SiLU(),
            nn.Linear(config.hidden, config.moves),
        )

    def forward(self, values: Tensor) -> Tensor:
        """Bits of all parts (n, m), 0 and 1 -> logits (n, |A|)."""
        logits: Tensor = self.layers(2.0 * values - 1.0)
        return logits

    def possible(self, bits: Tensor) -> Tensor:
        """Which actions are possible: bits (n, b) -> (n, |A|) bool."""
        possible: Tensor = self(bits[:, self.index]) > 0.0
        return possible
