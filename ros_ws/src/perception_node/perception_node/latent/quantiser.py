# SPDX-License-Identifier: Apache-2.0
"""Quantisers: what makes discrete codes of the features at every place of the latent map.

A code is told in bits, so that all of them can be compared, hashed and predicted alike.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import torch
from torch import Tensor, nn

#: Levels of each feature of finite scalar quantisation; 256 codes at each place.
FSQ_LEVELS: Final = (8, 8, 4)
#: Embedding vectors of vector quantisation, K of 4.2.1.
CODEBOOK: Final = 256


class Quantiser(nn.Module):
    """One way to make codes of features; ``bits`` says how many a place has.

    Args:
        channels: o, the features at each place.
        bits: of the code at each place.
    """

    def __init__(self, channels: int, bits: int) -> None:
        super().__init__()
        self.channels, self.bits = channels, bits

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """What stands for features (n, o, h, w) in the decoder.

        Returns:
            The quantised features, shape (n, o, h, w), through which gradients pass as if nothing
            had happened; bits 0 or 1, shape (n, bits, h, w); the quantiser's own loss, a scalar.
        """
        raise NotImplementedError

    def embedded(self, bits: Tensor) -> Tensor:
        """The quantised features of bits (n, bits, h, w) -> (n, o, h, w); 0 and 1 only."""
        raise NotImplementedError

    def disagreement(self, features: Tensor, bits: Tensor) -> Tensor:
        """How far features are from giving these bits with a margin, a scalar."""
        target = self.embedded(bits).detach()
        return (features - target).square().mean()


class Binary(Quantiser):
    """The sign of each feature: o bits at each place, each with a threshold of its own at 0."""

    def __init__(self, channels: int) -> None:
        super().__init__(channels, channels)

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """See :class:`Quantiser`."""
        bits = (features > 0.0).to(features.dtype)
        soft = torch.tanh(features)
        return soft + (2.0 * bits - 1.0 - soft).detach(), bits, features.new_zeros(())

    def embedded(self, bits: Tensor) -> Tensor:
        """See :class:`Quantiser`."""
        return 2.0 * bits - 1.0

    def disagreement(self, features: Tensor, bits: Tensor) -> Tensor:
        """The cross-entropy of the bits, features as their logits; it asks for a margin."""
        return nn.functional.binary_cross_entropy_with_logits(features, bits)


class _OfLibrary(Quantiser):
    """A quantiser of vector-quantize-pytorch, which numbers its codes."""

    def _bits_of(self, numbers: Tensor) -> Tensor:
        shifts = torch.arange(self.bits, device=numbers.device)
        return ((numbers[:, None] >> shifts[:, None, None]) & 1).float()

    def _numbers_of(self, bits: Tensor) -> Tensor:
        weights = 2 ** torch.arange(self.bits, device=bits.device)
        return (bits.round().long() * weights[:, None, None]).sum(1)


class FiniteScalar(_OfLibrary):
    """FSQ: each of a few features is rounded to one of its levels."""

    def __init__(self, channels: int) -> None:
        from vector_quantize_pytorch import FSQ

        size = int(torch.tensor(FSQ_LEVELS).prod())
        super().__init__(channels, (size - 1).bit_length())
        self.fsq = FSQ(list(FSQ_LEVELS), dim=channels, channel_first=True)

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """See :class:`Quantiser`."""
        quantised, numbers = self.fsq(features)
        return quantised, self._bits_of(numbers.long()), features.new_zeros(())

    def embedded(self, bits: Tensor) -> Tensor:
        """See :class:`Quantiser`."""
        return self.fsq.indices_to_codes(self._numbers_of(bits))


class Vector(_OfLibrary):
    """VQ: the nearest of K embedding vectors, which are means of what they stand for.

    Vectors that stand for hardly anything are drawn anew from the features of the batch.
    """

    def __init__(self, channels: int) -> None:
        from vector_quantize_pytorch import VectorQuantize

        super().__init__(channels, (CODEBOOK - 1).bit_length())
        self.vq = VectorQuantize(
            channels,
            codebook_size=CODEBOOK,
            decay=0.95,
            threshold_ema_dead_code=2,
            commitment_weight=0.25,
            accept_image_fmap=True,
            kmeans_init=True,
        )

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """See :class:`Quantiser`."""
        quantised, numbers, loss = self.vq(features)
        return quantised, self._bits_of(numbers.long()), loss.sum()

    def embedded(self, bits: Tensor) -> Tensor:
        """See :class:`Quantiser`."""
        vectors: Tensor = self.vq.get_codes_from_indices(self._numbers_of(bits))
        return vectors.permute(0, 3, 1, 2) if vectors.shape[-1] == self.channels else vectors


QUANTISERS: Final[dict[str, Callable[[int], Any]]] = {
    "binary": Binary,
    "fsq": FiniteScalar,
    "vq": Vector,
}


def quantiser_named(name: str, channels: int) -> Quantiser:
    """Raises ValueError for an unknown name; the sentence lists the known ones."""
    if name not in QUANTISERS:
        raise ValueError(f"no quantiser {name!r}; known: {', '.join(QUANTISERS)}")
    quantiser: Quantiser = QUANTISERS[name](channels)
    return quantiser
