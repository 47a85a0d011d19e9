# SPDX-License-Identifier: Apache-2.0
"""Answers questions that are told as functional programs, by learnt concepts on places of an image.

What a place shows (whether a thing has its middle there, which attributes it has, what is beside
what) is learnt from answers alone, through the program, every function of which can be
differentiated. Neither things nor attributes are labelled.

A program is a row of tokens in the order in which they are executed on a stack:

========================  =====================================================================
``scene``                 pushes all places, each 1
``filter ATTRIBUTE WORD`` places times the probability of the word
``unique``                places become a distribution over things
``relate RELATION``       a distribution becomes the places that stand so to its thing
``and``, ``or``           of two masks of places
``count``, ``exist``      how many things, whether any
``query ATTRIBUTE``       which word fits a thing
``same ATTRIBUTE``        whether two things share it
``more|fewer|equal``      of two counts
========================  =====================================================================
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import torch
from torch import Tensor, nn

from .networks import half_precision

#: Edge of the map of places, and channels of what is seen of each.
_EDGE: Final = 32
_SEEN: Final = 48
#: Width of what relations are told by.
_BESIDE: Final = 32
_TINY: Final = 1e-6


@dataclass(frozen=True)
class Seen:
    """What is seen of n images, once for all questions about them.

    Attributes:
        features: of each of p places, shape (n, p, c).
        things: probability that a thing has its middle there, shape (n, p).
        words: by attribute, probability of each of its k words, in alphabetical order, (n, p, k).
        here: what tells relations to a place, shape (n, p, h).
    """

    features: Tensor
    things: Tensor
    words: Mapping[str, Tensor]
    here: Tensor


def first_layers(channels: int) -> nn.Sequential:
    """Images (n, 3, s, s) -> (n, channels, s / 4, s / 4); what every answerer begins with."""
    return nn.Sequential(
        nn.Conv2d(3, 32, 5, stride=2, padding=2),
        nn.BatchNorm2d(32),
        nn.ReLU(),
        nn.Conv2d(32, channels, 3, stride=2, padding=1),
        nn.BatchNorm2d(channels),
        nn.ReLU(),
    )


class PlaceSight(nn.Module):
    """Images (n, 3, 128, 128) -> what is seen of 32 x 32 places, (n, 1024, 50).

    The last two say where a place is. Layers look farther and farther around.
    """

    where: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.start = first_layers(_SEEN)
        self.around = nn.ModuleList(
            nn.Sequential(
                nn.Conv2d(_SEEN, _SEEN, 3, padding=reach, dilation=reach),
                nn.BatchNorm2d(_SEEN),
                nn.ReLU(),
            )
            for reach in (1, 2, 4)
        )
        line = torch.linspace(-1.0, 1.0, _EDGE)
        where = torch.stack(torch.meshgrid(line, line, indexing="ij"))
        self.register_buffer("where", where.flatten(1).T[None].contiguous())

    def forward(self, images: Tensor) -> Tensor:
        """See the class."""
        with half_precision(self.training):
            seen = self.start(images - 0.5)
            for layer in self.around:
                seen = seen + layer(seen)
        places = seen.float().flatten(2).transpose(1, 2)
        return torch.cat([places, self.where.expand(len(places), -1, -1)], dim=2)


class ProgramNetwork(nn.Module):
    """The interface of :class:`.answering.Answerer`; its words are tokens of programs.

    Args:
        words: tokens of programs; the first stands for none.
        answers: that there are.
    """

    def __init__(self, words: Sequence[str], answers: Sequence[str]) -> None:
        super().__init__()
        self._tokens = [tuple(word.split()) for word in words]
        self._answers = {answer: number for number, answer in enumerate(answers)}
        filters = [token[1:] for token in self._tokens if token[:1] == ("filter",)]
        self._values: dict[str, list[str]] = {}
        for name, value in sorted(filters):
            self._values.setdefault(name, []).append(value)
        self._relations = sorted(token[1] for token in self._tokens if token[:1] == ("relate",))
        width = _SEEN + 2
        self.sight = PlaceSight()
        self.thing = nn.Linear(width, 1)
        nn.init.constant_(self.thing.bias, -5.0)
        self.attributes = nn.ModuleDict(
            {name: nn.Linear(width, len(values)) for name, values in self._values.items()}
        )
        self.here = nn.Linear(width, _BESIDE)
        self.there = nn.Linear(width, max(1, len(self._relations)) * _BESIDE)
        self.beside = nn.Parameter(0.2 * torch.randn(max(1, len(self._relations)), _BESIDE))
        self.beside_bias = nn.Parameter(torch.zeros(max(1, len(self._relations))))
        self.sharpness = nn.Parameter(torch.tensor(2.0))

    def forward(self, images: Tensor, questions: Tensor, owners: Tensor) -> Tensor:
        """Logits of the answers, shape (m, |Y|); see :meth:`.answering.Answerer.forward`."""
        return self.execute(self.look(images), questions, owners)

    def look(self, images: Tensor) -> Seen:
        """What is seen of images (n, 3, 128, 128)."""
        features = self.sight(images)
        return Seen(
            features=features,
            things=torch.sigmoid(self.thing(features)[..., 0]),
            words={name: head(features).softmax(-1) for name, head in self.attributes.items()},
            here=self.here(features),
        )

    def execute(self, scene: Seen, questions: Tensor, owners: Tensor) -> Tensor:
        """Logits (m, |Y|) of programs (m, t) about images that were looked at."""
        groups: dict[tuple[Any, ...], list[int]] = defaultdict(list)
        rows = questions.tolist()
        for number, row in enumerate(rows):
            groups[self._skeleton(row)].append(number)
        logits = scene.things.new_full((len(rows), len(self._answers)), -12.0)
        order, found = [], []
        for skeleton, members in groups.items():
            tokens = [[self._tokens[word] for word in rows[number] if word] for number in members]
            found.append(self._executed(scene, owners[members], skeleton, tokens, logits[members]))
            order += members
        return torch.cat(found)[torch.tensor(order).argsort()]

    def _skeleton(self, row: Sequence[int]) -> tuple[Any, ...]:
        """What programs that are executed together have in common: all but words and relations."""
        return tuple(self._tokens[word][:2] if self._tokens[word][0] != "relate" else ("relate",)
                     for word in row if word)  # fmt: skip

    def _executed(
        self,
        scene: Seen,
        owners: Tensor,
        skeleton: Sequence[tuple[str, ...]],
        tokens: Sequence[Sequence[tuple[str, ...]]],
        logits: Tensor,
    ) -> Tensor:
        """Answers (g, |Y|) of programs of one skeleton about images (g,)."""
        things = scene.things[owners]
        stack: list[Tensor] = []
        for place, (function, *rest) in enumerate(skeleton):
            if function == "scene":
                stack.append(torch.ones_like(things))
            elif function == "filter":
                values = self._values[rest[0]]
                wanted = torch.tensor([values.index(row[place][2]) for row in tokens])
                stack.append(stack.pop() * scene.words[rest[0]][owners, :, wanted])
            elif function == "unique":
                weights = stack.pop() * things
                stack.append(weights / (weights.sum(1, keepdim=True) + _TINY))
            elif function == "relate":
                kinds = torch.tensor([self._relations.index(row[place][1]) for row in tokens])
                stack.append(self._beside(scene, owners, stack.pop(), kinds))
            elif function in ("and", "or"):
                second, first = stack.pop(), stack.pop()
                both = first * second
                stack.append(both if function == "and" else first + second - both)
            elif function in ("count", "exist"):
                stack.append((stack.pop() * things).sum(1))
            elif function in ("query", "same"):
                shares = scene.words[rest[0]][owners]
                first = torch.einsum("gp,gpk->gk", stack.pop(), shares)
                if function == "query":
                    return self._words(logits, self._values[rest[0]], (first + _TINY).log())
                second = torch.einsum("gp,gpk->gk", stack.pop(), shares)
                return self._yes_no(logits, (first * second).sum(1).logit(1e-4))
            else:
                second, first = stack.pop(), stack.pop()
                margin = {
                    "more": first - second - 0.5,
                    "fewer": second - first - 0.5,
                    "equal": 0.5 - (first - second).abs(),
                }[function]
                return self._yes_no(logits, 2.0 * self.sharpness * margin)
        number = stack.pop()
        if skeleton[-1][0] == "exist":
            return self._yes_no(logits, 2.0 * self.sharpness * (number - 0.5))
        counts = [answer for answer in self._answers if answer.isdigit()]
        told = number.new_tensor([float(answer) for answer in counts])
        return self._words(logits, counts, -self.sharpness * (number[:, None] - told).square())

    def _beside(self, scene: Seen, owners: Tensor, anchor: Tensor, kinds: Tensor) -> Tensor:
        """Probability (g, 1024) that what is at a place stands so to the thing at an anchor."""
        shown = torch.einsum("gp,gpc->gc", anchor, scene.features[owners])
        rows = torch.arange(len(kinds))
        there = self.there(shown).unflatten(1, (-1, _BESIDE))[rows, kinds]
        hidden = torch.tanh(scene.here[owners] + there[:, None])
        score = torch.einsum("gph,gh->gp", hidden, self.beside[kinds])
        return torch.sigmoid(4.0 * score + self.beside_bias[kinds][:, None])

    def _words(self, logits: Tensor, words: Sequence[str], values: Tensor) -> Tensor:
        columns = [self._answers[word] for word in words if word in self._answers]
        kept = [number for number, word in enumerate(words) if word in self._answers]
        logits = logits.clone()
        logits[:, columns] = values[:, kept]
        return logits

    def _yes_no(self, logits: Tensor, yes: Tensor) -> Tensor:
        return self._words(logits, ["yes", "no"], torch.stack([0.5 * yes, -0.5 * yes], dim=1))
