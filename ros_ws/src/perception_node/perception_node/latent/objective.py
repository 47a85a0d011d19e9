# SPDX-License-Identifier: Apache-2.0
"""What the state encoder is trained on beside eq. 4.2: pictures of one state have one code.

Nobody says which state that is; it is known of pictures only that they were taken of the same one.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from .state_encoder import StateEncoder


@dataclass(frozen=True)
class Weights:
    """Of the parts of the loss.

    Attributes:
        reconstruction: of the mean squared error, α of eq. 4.2.
        agreement: of the disagreement of each picture's features with the other one's bits.
        return_: of the disagreement of what a decoded code is encoded to, with that code.
        flips: share of bits that are turned before decoding; half of that in whole neighbourhoods.
    """

    reconstruction: float = 300.0
    agreement: float = 1.0
    return_: float = 1.0
    flips: float = 0.01


@dataclass(frozen=True)
class Parts:
    """The parts of one loss, unweighted."""

    reconstruction: Tensor
    agreement: Tensor
    return_: Tensor
    own: Tensor

    def total(self, weights: Weights) -> Tensor:
        """Their weighted sum."""
        return (
            weights.reconstruction * self.reconstruction
            + weights.agreement * self.agreement
            + weights.return_ * self.return_
            + self.own
        )


def paired_loss(
    encoder: StateEncoder,
    first: Tensor,
    second: Tensor,
    weights: Weights,
    rng: torch.Generator,
) -> Parts:
    """The loss of two pictures of each state, shape (n, 3, 128, 128).

    The code of one picture is decoded to the other one, which keeps everything out of the code that
    differs between them. Before that some of its bits are turned: what is decoded from them shall
    still be the state, and encode to the code without the damage.
    """
    both = encoder.encoder(torch.cat([first, second]))
    quantised, bits, own = encoder.quantiser(both)
    count = len(first)
    swapped = torch.cat([bits[count:], bits[:count]]).detach()
    agreement = encoder.quantiser.disagreement(both, swapped)
    decoded = encoder.decoder(quantised)
    reconstruction = (decoded - torch.cat([second, first])).square().mean()
    zero = reconstruction.new_zeros(())
    if weights.return_ == 0.0:
        return Parts(reconstruction, agreement, zero, own)
    damaged = turned(bits[:count].detach(), weights.flips, rng)
    shown = encoder.decoder(encoder.quantiser.embedded(damaged))
    reconstruction = 0.5 * (reconstruction + (shown - second).square().mean())
    again = encoder.encoder(shown)
    return_ = encoder.quantiser.disagreement(again, bits[:count].detach())
    return Parts(reconstruction, agreement, return_, own)


def turned(bits: Tensor, share: float, rng: torch.Generator) -> Tensor:
    """Bits of which about ``share`` are turned, half alone and half in squares of 3 x 3 places."""
    alone = torch.rand(bits.shape, generator=rng) < 0.5 * share
    hit = (torch.rand((len(bits), 1, *bits.shape[2:]), generator=rng) < 0.1 * share).float()
    near = torch.nn.functional.max_pool2d(hit, 3, 1, 1) > 0.0
    together = near & (torch.rand(bits.shape, generator=rng) < 0.5)
    return torch.where(alone | together, 1.0 - bits, bits)
