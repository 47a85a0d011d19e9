# SPDX-License-Identifier: Apache-2.0
"""What is seen of an image: places that may show a thing, what each is like, what is beside it.

Nothing of it is labelled. Which places show things, which words fit them and what stands where is
learnt from answers alone, through the programs of :mod:`.programs`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import torch
from torch import Tensor, nn

from .networks import IMAGE, MAP, half_precision

#: Places that are looked at: of the most likely ones, none beside a likelier one in its row.
PLACES: Final = 16
_SEEN: Final = 48
_WIDTH: Final = 96
#: Learnt coordinates, by whose differences relations are told, and how finely they are told where
#: a place is: the softest step of what follows is 1 wide.
_COORDINATES: Final = 4
_FINE: Final = 8.0


@dataclass(frozen=True)
class Seen:
    """What is seen of n images, once for all questions about them.

    Attributes:
        things: probability that each of k places shows a thing, shape (n, k).
        words: by attribute, probability of each of its w words, in their order, (n, k, w).
        beside: probability that what is at place i stands in relation r to what is at place j,
            shape (n, r, k, k), i before j.
    """

    things: Tensor
    words: Mapping[str, Tensor]
    beside: Tensor


class PlaceSight(nn.Module):
    """Images (n, 3, 128, 128) -> what is seen of 32 x 32 places, (n, 48, 32, 32).

    Layers look farther and farther around.
    """

    def __init__(self) -> None:
        super().__init__()
        stride = IMAGE // MAP
        self.start = self._layer(3 * stride**2, 1)
        self.around = nn.ModuleList(self._layer(_SEEN, reach) for reach in (1, 2, 4))
        self.stride = stride

    def forward(self, images: Tensor) -> Tensor:
        """See the class."""
        with half_precision(torch.is_grad_enabled()):
            seen: Tensor = self.start(nn.functional.pixel_unshuffle(images - 0.5, self.stride))
            for layer in self.around:
                seen = seen + layer(seen)
        return seen.float()

    @staticmethod
    def _layer(channels: int, reach: int) -> nn.Sequential:
        return nn.Sequential(
            nn.Conv2d(channels, _SEEN, 3, padding=reach, dilation=reach),
            nn.BatchNorm2d(_SEEN),
            nn.ReLU(),
        )


class ThingSight(nn.Module):
    """Images (n, 3, 128, 128) -> :class:`Seen`.

    Args:
        attributes: the words of each.
        relations: how many there are.
    """

    where: Tensor

    def __init__(self, attributes: Mapping[str, Sequence[str]], relations: int) -> None:
        super().__init__()
        self.places = PlaceSight()
        self.likely = nn.Conv2d(_SEEN, 1, 1)
        self.looks = nn.Sequential(
            nn.Linear(_SEEN + 2, _WIDTH), nn.ReLU(), nn.Linear(_WIDTH, _WIDTH), nn.ReLU()
        )
        self.thing = nn.Linear(_WIDTH, 1)
        self.attributes = nn.ModuleDict(
            {name: nn.Linear(_WIDTH, len(words)) for name, words in attributes.items()}
        )
        self.coordinates = nn.Linear(_WIDTH + 2, _COORDINATES)
        self.relations = nn.Sequential(
            nn.Linear(_COORDINATES, 32), nn.Tanh(), nn.Linear(32, max(1, relations))
        )
        line = torch.linspace(-1.0, 1.0, MAP)
        where = torch.stack(torch.meshgrid(line, line, indexing="ij"))
        self.register_buffer("where", where.flatten(1).T[None].contiguous())

    def forward(self, images: Tensor) -> Seen:
        """See the class."""
        seen = self.places(images)
        likely = self.likely(seen)
        picked = self._picked(likely[:, 0])
        features = _at(torch.cat([seen.flatten(2), likely.flatten(2)], 1).transpose(1, 2), picked)
        where = _at(self.where.expand(len(images), -1, -1), picked)
        looks = self.looks(torch.cat([features[..., :-1], where], 2))
        coordinates = self.coordinates(torch.cat([looks, _FINE * where], 2))
        beside = torch.sigmoid(2.0 * self.relations(coordinates[:, :, None] - coordinates[:, None]))
        other = 1.0 - torch.eye(PLACES, device=images.device)
        return Seen(
            things=torch.sigmoid(features[..., -1] + self.thing(looks)[..., 0]),
            words={name: head(looks).softmax(-1) for name, head in self.attributes.items()},
            beside=beside.permute(0, 3, 1, 2) * other,
        )

    @torch.no_grad()
    def _picked(self, likely: Tensor) -> Tensor:
        """The likeliest places (n, k) of a map (n, 32, 32)."""
        beside = nn.functional.max_pool2d(likely[:, None], (1, 3), 1, (0, 1))[:, 0]
        alone = likely.masked_fill(likely < beside, -torch.inf)
        return alone.flatten(1).topk(PLACES, 1).indices


def _at(values: Tensor, places: Tensor) -> Tensor:
    """Values (n, p, c) at places (n, k) -> (n, k, c)."""
    return values.gather(1, places[..., None].expand(-1, -1, values.shape[2]))
