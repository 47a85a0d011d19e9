# SPDX-License-Identifier: Apache-2.0
"""Answers questions that are told as functional programs, on what is seen of an image's places.

Every function of a program is one of probabilities that can be differentiated, so what is seen is
learnt from answers alone. What is told of places is taken to be independent; numbers of things
then have exactly the distribution of a sum of such events (Poisson binomial), and comparing two of
them is exact, too.

A program is a row of tokens in the order in which they are executed on a stack:

========================  =====================================================================
``scene``                 pushes all places, each as far as it shows a thing
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

from collections.abc import Sequence
from typing import Final

import torch
from torch import Tensor, nn

from .sight import Seen, ThingSight

_TINY: Final = 1e-6
#: Share of every answer's probability that is spread over all: no answer is held impossible.
_DOUBT: Final = 1e-4

#: A function of a program, with what it is told where that changes what is executed.
Step = tuple[str, ...]
Skeleton = tuple[Step, ...]


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
        self._values: dict[str, list[str]] = {}
        for name, value in sorted(t[1:] for t in self._tokens if t[:1] == ("filter",)):
            self._values.setdefault(name, []).append(value)
        self._relations = sorted(t[1] for t in self._tokens if t[:1] == ("relate",))
        # A kind is a number whose digits are the words of each attribute, 0 for any.
        self._strides, stride = {}, 1
        for name, values in reversed(self._values.items()):
            self._strides[name] = stride
            stride *= 1 + len(values)
        self.sight = ThingSight(self._values, len(self._relations))

    def forward(self, images: Tensor, questions: Tensor, owners: Tensor) -> Tensor:
        """Log-probabilities of the answers (m, |Y|); see :meth:`.answering.Answerer.forward`."""
        return self.execute(self.sight(images), questions, owners)

    def execute(self, scene: Seen, questions: Tensor, owners: Tensor) -> Tensor:
        """Log-probabilities (m, |Y|) of programs (m, t) about images that were looked at."""
        groups: dict[Skeleton, tuple[list[int], list[list[int]]]] = {}
        for number, row in enumerate(questions.tolist()):
            skeleton, told = self._told(row)
            members, all_told = groups.setdefault(skeleton, ([], []))
            members.append(number)
            all_told.append(told)
        kinds = self._kinds(scene)
        ends: dict[Step, list[tuple[list[int], list[Tensor]]]] = {}
        for skeleton, (members, all_told) in groups.items():
            told_to_each = torch.tensor(all_told, device=owners.device).unbind(1)
            left = self._executed(scene, kinds, owners[members], skeleton[:-1], told_to_each)
            ends.setdefault(skeleton[-1], []).append((members, left))
        order, found = [], []
        for end, parts in ends.items():
            members = [number for numbers, _ in parts for number in numbers]
            left = [torch.cat(masks) for masks in zip(*(masks for _, masks in parts))]
            found.append(self._ended(scene, owners[members], end, left))
            order += members
        shares = torch.cat(found)[torch.tensor(order).argsort()]
        return (shares.clamp(0.0, 1.0) * (1.0 - _DOUBT) + _DOUBT / shares.shape[1]).log()

    def _told(self, row: Sequence[int]) -> tuple[Skeleton, list[int]]:
        """What programs that are executed together have in common, and what each step is told.

        Filters in a row become one; what that is told is a number of :meth:`_kinds`.
        """
        skeleton: list[Step] = []
        told: list[int] = []
        for function, *rest in (self._tokens[word] for word in row if word):
            if function == "filter":
                kind = self._strides[rest[0]] * (1 + self._values[rest[0]].index(rest[1]))
                if skeleton[-1] == ("filter",):
                    told[-1] += kind
                else:
                    skeleton.append(("filter",))
                    told.append(kind)
            elif function == "relate":
                skeleton.append((function,))
                told.append(self._relations.index(rest[0]))
            else:
                skeleton.append((function, *rest))
                told.append(0)
        return tuple(skeleton), told

    def _kinds(self, scene: Seen) -> Tensor:
        """Probability of each place that all words of a kind fit, (n, k, kinds); 0 is no word."""
        kinds = torch.ones_like(scene.things)[..., None]
        for name in self._values:
            any_word = torch.cat([torch.ones_like(kinds[..., :1]), scene.words[name]], -1)
            kinds = (kinds[..., None] * any_word[..., None, :]).flatten(2)
        return kinds

    def _executed(
        self, scene: Seen, kinds: Tensor, owners: Tensor, skeleton: Skeleton, told: Sequence[Tensor]
    ) -> list[Tensor]:
        """The stack before the last step of programs of one skeleton about images (g,)."""
        things = scene.things[owners]
        stack: list[Tensor] = []
        for (function, *_), words in zip(skeleton, told):
            if function == "scene":
                stack.append(things)
            elif function == "filter":
                stack.append(stack.pop() * kinds[owners, :, words])
            elif function == "unique":
                mask = stack.pop()
                stack.append(mask / (mask.sum(1, keepdim=True) + _TINY))
            elif function == "relate":
                beside = scene.beside[owners, words]
                stack.append(things * torch.einsum("gij,gj->gi", beside, stack.pop()))
            elif function in ("and", "or"):
                # Either mask says of a place that it shows a thing, which is so once.
                second, first = stack.pop(), stack.pop()
                both = first * second / (things + _TINY)
                stack.append(both if function == "and" else first + second - both)
            # Things are counted by the last step, which compares two counts or tells one.
        return stack

    def _ended(self, scene: Seen, owners: Tensor, end: Step, left: Sequence[Tensor]) -> Tensor:
        """Probabilities (g, |Y|) of what the last step makes of what is left on the stack."""
        function, *rest = end
        if function in ("query", "same"):
            shares = scene.words[rest[0]][owners]
            words = [torch.einsum("gp,gpw->gw", thing, shares) for thing in left]
            if function == "query":
                return self._answer(self._values[rest[0]], words[0])
            return self._yes((words[0] * words[1]).sum(1))
        numbers = [how_many(mask) for mask in left]
        if function == "exist":
            return self._yes(1.0 - numbers[0][:, 0])
        if function == "count":
            told = [str(number) for number in range(numbers[0].shape[1])]
            return self._answer(told, numbers[0])
        both = numbers[0][:, :, None] * numbers[1][:, None]
        if function == "equal":
            return self._yes(both.diagonal(dim1=1, dim2=2).sum(1))
        return self._yes((both.tril(-1) if function == "more" else both.triu(1)).sum((1, 2)))

    def _answer(self, words: Sequence[str], shares: Tensor) -> Tensor:
        """Probabilities of words (g, w) as those of answers; what is no answer is left out."""
        kept = [number for number, word in enumerate(words) if word in self._answers]
        columns = torch.tensor([self._answers[words[number]] for number in kept])
        answers = shares.new_zeros(len(shares), len(self._answers))
        return answers.index_copy(1, columns.to(shares.device), shares[:, kept])

    def _yes(self, shares: Tensor) -> Tensor:
        return self._answer(["yes", "no"], torch.stack([shares, 1.0 - shares], dim=1))


class SymbolicNetwork(nn.Module):
    """Answers on the graph that a network holds most likely, as if it were certain.

    Args:
        network: reads the graph off images and executes programs on it.
    """

    def __init__(self, network: ProgramNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor, questions: Tensor, owners: Tensor) -> Tensor:
        """See :meth:`ProgramNetwork.forward`."""
        seen = self.network.sight(images)
        graph = Seen(
            things=seen.things.round(),
            words={name: (s == s.amax(-1, keepdim=True)).float() for name, s in seen.words.items()},
            beside=seen.beside.round(),
        )
        return self.network.execute(graph, questions, owners)


def how_many(shares: Tensor) -> Tensor:
    """The distribution of how many of k independent events happen: (g, k) -> (g, k + 1)."""
    count = shares.shape[1]
    numbers = nn.functional.pad(torch.ones_like(shares[:, :1]), (0, count))
    for event in shares.unbind(1):
        happens = nn.functional.pad(numbers[:, :-1], (1, 0))
        numbers = torch.lerp(numbers, happens, event[:, None])
    return numbers
