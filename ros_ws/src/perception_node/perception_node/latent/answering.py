# SPDX-License-Identifier: Apache-2.0
"""Networks that answer a question about an image: p(y | x, w), the RN of 4.2.1 and a lighter one.

Several questions about one image share what is seen of it; only what is asked is done for each.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import product
from typing import Final

import torch
from torch import Tensor, nn

from .programs import ProgramNetwork

#: Channels of what is seen and of the question, and edge of the map that is asked about.
_SEEN: Final = 48
_ASKED: Final = 128
_EDGE: Final = 16
#: Edge of the map whose places are the relation network's objects.
_OBJECTS: Final = 6
#: By how many pixels, down and to the right, an image is moved before it is read.
SHIFTS: Final = tuple(product((-1, 0, 1), repeat=2))


class _Sight(nn.Module):
    """Images (n, 3, 128, 128) -> (n, 50, 16, 16), of which the last two say where a place is."""

    where: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Conv2d(3, 32, 5, stride=2, padding=2),
            nn.BatchNorm2d(32),
            nn.ReLU(),
            nn.Conv2d(32, _SEEN, 3, stride=2, padding=1),
            nn.BatchNorm2d(_SEEN),
            nn.ReLU(),
            nn.Conv2d(_SEEN, _SEEN, 3, stride=2, padding=1),
            nn.BatchNorm2d(_SEEN),
            nn.ReLU(),
        )
        line = torch.linspace(-1.0, 1.0, _EDGE)
        self.register_buffer("where", torch.stack(torch.meshgrid(line, line, indexing="ij"))[None])

    def forward(self, images: Tensor) -> Tensor:
        seen = self.layers(images - 0.5)
        return torch.cat([seen, self.where.expand(len(seen), -1, -1, -1)], dim=1)


class _Reader(nn.Module):
    """Words (m, t), 0 where there is none any more -> (m, 128)."""

    def __init__(self, words: int) -> None:
        super().__init__()
        self.embedding = nn.Embedding(words, 64, padding_idx=0)
        self.memory = nn.GRU(64, _ASKED, batch_first=True)

    def forward(self, words: Tensor) -> Tensor:
        states, _ = self.memory(self.embedding(words))
        last = (words > 0).sum(1).clamp(min=1) - 1
        return states[torch.arange(len(words)), last]


class Answerer(nn.Module):
    """Of questions in words; what both of its kinds share.

    Args:
        words: of the vocabulary; the first stands for none.
    """

    def __init__(self, words: Sequence[str]) -> None:
        super().__init__()
        self.sight = _Sight()
        self.reader = _Reader(len(words))

    def forward(self, images: Tensor, questions: Tensor, owners: Tensor) -> Tensor:
        """Logits of the answers, shape (m, |Y|).

        Args:
            images: shape (n, 3, 128, 128).
            questions: words (m, t), 0 after the last one.
            owners: which image each is about, shape (m,).
        """
        return self.reason(self.sight(images), self.reader(questions), owners)

    def reason(self, seen: Tensor, asked: Tensor, owners: Tensor) -> Tensor:
        """From what is seen (n, 50, 16, 16) and asked (m, 128) to logits (m, |Y|)."""
        raise NotImplementedError


class RelationNetwork(Answerer):
    """f of the sum over all pairs of places of g of both and the question, as in the thesis."""

    def __init__(self, words: Sequence[str], answers: Sequence[str]) -> None:
        super().__init__(words)
        width = 128
        self.one = nn.Linear(_SEEN + 2, width)
        self.other = nn.Linear(_SEEN + 2, width)
        self.asked = nn.Linear(_ASKED, width)
        self.of_pairs = nn.Sequential(
            nn.ReLU(), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, width), nn.ReLU()
        )
        self.of_sum = nn.Sequential(
            nn.Linear(width, width), nn.ReLU(), nn.Dropout(0.1), nn.Linear(width, len(answers))
        )

    def reason(self, seen: Tensor, asked: Tensor, owners: Tensor) -> Tensor:
        """See :class:`Answerer`."""
        objects = nn.functional.adaptive_avg_pool2d(seen, _OBJECTS).flatten(2).transpose(1, 2)
        pairs = self.one(objects)[:, :, None] + self.other(objects)[:, None]
        both = pairs.flatten(1, 2)[owners] + self.asked(asked)[:, None]
        logits: Tensor = self.of_sum(self.of_pairs(both).mean(1))
        return logits


class FilmNetwork(Answerer):
    """The question scales and shifts what convolutions see; cheaper than all pairs of places."""

    def __init__(self, words: Sequence[str], answers: Sequence[str], blocks: int = 4) -> None:
        super().__init__(words)
        self.start = nn.Conv2d(_SEEN + 2, _SEEN, 1)
        self.convolutions = nn.ModuleList(
            nn.Conv2d(_SEEN + 2, _SEEN, 3, padding=1) for _ in range(blocks)
        )
        self.norms = nn.ModuleList(nn.BatchNorm2d(_SEEN, affine=False) for _ in range(blocks))
        self.film = nn.Linear(_ASKED, 2 * _SEEN * blocks)
        self.end = nn.Sequential(nn.Linear(2 * _SEEN, 128), nn.ReLU(), nn.Linear(128, len(answers)))

    def reason(self, seen: Tensor, asked: Tensor, owners: Tensor) -> Tensor:
        """See :class:`Answerer`."""
        x = torch.relu(self.start(seen))[owners]
        where = seen[:1, -2:].expand(len(x), -1, -1, -1)
        changes = self.film(asked).unflatten(1, (len(self.convolutions), 2, _SEEN))
        for number, (convolution, norm) in enumerate(zip(self.convolutions, self.norms)):
            scale, shift = changes[:, number, 0], changes[:, number, 1]
            inner = norm(convolution(torch.cat([x, where], dim=1)))
            x = x + torch.relu((1.0 + scale[..., None, None]) * inner + shift[..., None, None])
        found: Tensor = self.end(torch.cat([x.amax((2, 3)), x.mean((2, 3))], dim=1))
        return found


class ManyViews(nn.Module):
    """Reads an image in several views, and holds what it reads in each of them equally likely.

    Views are the image and its mirror image, each where it is and a pixel farther in the eight
    directions: what lies on the border of two places for one view does not for another one.

    Args:
        answerer: the interface of :class:`Answerer`; it was trained on mirrored images, too.
        words: of questions.
        mirrored: those that change places in a mirror, by pairs; without any, nothing is mirrored.
    """

    in_mirror: Tensor

    def __init__(
        self, answerer: nn.Module, words: Sequence[str], mirrored: Sequence[tuple[str, str]]
    ) -> None:
        super().__init__()
        self.answerer = answerer
        self.ways = (False, True) if mirrored else (False,)
        self.register_buffer("in_mirror", words_in_mirror(words, mirrored), persistent=False)

    def forward(self, images: Tensor, questions: Tensor, owners: Tensor) -> Tensor:
        """Log-probabilities of the answers, shape (m, |Y|); see :meth:`Answerer.forward`."""
        read = [
            self.one_way(moved(images, down, right), questions, owners, mirror)
            for down, right in SHIFTS
            for mirror in self.ways
        ]
        return torch.logsumexp(torch.stack(read), 0) - math.log(len(read))

    def one_way(self, images: Tensor, questions: Tensor, owners: Tensor, mirror: bool) -> Tensor:
        """The same, read where it is, in one way only."""
        if mirror:
            images, questions = images.flip(3), self.in_mirror[questions]
        return self.answerer(images, questions, owners).log_softmax(1)


def moved(images: Tensor, down: int, right: int) -> Tensor:
    """Images (n, c, h, w) moved by at most a pixel each way; what enters repeats the border."""
    height, width = images.shape[2:]
    wide = nn.functional.pad(images, (1, 1, 1, 1), mode="replicate")
    return wide[:, :, 1 - down : 1 - down + height, 1 - right : 1 - right + width]


def words_in_mirror(words: Sequence[str], mirrored: Sequence[tuple[str, str]]) -> Tensor:
    """The number of the word that each one becomes in a mirror."""
    numbers = torch.arange(len(words))
    for one, other in mirrored:
        numbers[[words.index(one), words.index(other)]] = torch.tensor(
            [words.index(other), words.index(one)]
        )
    return numbers


#: By name; those of :data:`READ_PROGRAMS` are told questions as programs.
ANSWERERS: Final[dict[str, Callable[[Sequence[str], Sequence[str]], nn.Module]]] = {
    "film": FilmNetwork,
    "program": ProgramNetwork,
    "relation": RelationNetwork,
}

READ_PROGRAMS: Final = frozenset({"program"})
