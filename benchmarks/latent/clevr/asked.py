# SPDX-License-Identifier: Apache-2.0
"""Questions as numbers for the networks, and what is answered without any picture."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from perception_node.latent.answering import READ_PROGRAMS
from perception_node.latent.qa_trainer import Asked
from perception_node.latent.state_encoder import StateEncoder, values_of

from .dataset import ClevrSet
from .programs import tokens_of
from .questions import Question
from .things import ATTRIBUTES, RELATIONS

_WORDS = frozenset(word for words in ATTRIBUTES.values() for word in words) | set(RELATIONS)


#: How a question is told to a network.
Telling = Callable[[Question], tuple[str, ...]]


def told_to(answerer: str) -> Telling:
    """As its program to those who read programs, else in words."""
    if answerer in READ_PROGRAMS:
        return lambda question: tokens_of(question.program)
    return lambda question: question.words


@dataclass(frozen=True)
class Vocabulary:
    """Words of questions, of which the first stands for none, and answers."""

    words: tuple[str, ...]
    answers: tuple[str, ...]

    @staticmethod
    def of(data: ClevrSet, told: Telling) -> Vocabulary:
        """Of the training questions."""
        asked = list(_all(data))
        words = sorted({word for question in asked for word in told(question)})
        return Vocabulary(("", *words), tuple(sorted({question.answer for question in asked})))


def asked_of(data: ClevrSet, vocabulary: Vocabulary, told: Telling) -> Asked:
    """All questions of a set; words and answers that training did not have are left out."""
    words = {word: number for number, word in enumerate(vocabulary.words)}
    answers = {answer: number for number, answer in enumerate(vocabulary.answers)}
    asked = list(_all(data))
    texts = [told(question) for question in asked]
    numbers = np.zeros((len(asked), max(map(len, texts))), np.int64)
    for row, text in enumerate(texts):
        known = [words[word] for word in text if word in words]
        numbers[row, : len(known)] = known
    owners = np.repeat(np.arange(len(data.images)), [len(items) for items in data.questions])
    right = np.array([answers.get(question.answer, -1) for question in asked])
    return Asked(data.images, numbers, owners, right)


@torch.inference_mode()
def answered(
    encoder: StateEncoder | None, answerer: nn.Module, asked: Asked, batch: int = 64
) -> NDArray[np.int64]:
    """Answers as numbers, from what codes show; without an encoder from the images themselves."""
    answerer.eval()
    found = []
    bounds = np.searchsorted(asked.owners, np.arange(len(asked.images) + 1))
    for start in range(0, len(asked.images), batch):
        images = asked.images[start : start + batch]
        rows = slice(bounds[start], bounds[start + len(images)])
        seen = values_of(images)
        if encoder is not None:
            bits = encoder.quantiser(encoder.encoder(seen))[1]
            seen = encoder.decoder(encoder.quantiser.embedded(bits))
        owners = torch.from_numpy(asked.owners[rows] - start)
        logits = answerer(seen, torch.from_numpy(asked.questions[rows]), owners)
        found.append(logits.argmax(1).numpy())
    return np.concatenate(found)


def without_picture(train: ClevrSet, test: ClevrSet) -> dict[str, list[str]]:
    """What the question alone suggests: the most frequent answer to others like it.

    ``majority per family`` asks its family only; ``question only`` the same words, else the same
    words but for what they name, else the family.
    """
    counts: dict[object, Counter[str]] = defaultdict(Counter)
    for question in _all(train):
        for key in _keys(question):
            counts[key][question.answer] += 1
    best = {
        key: sorted(c.items(), key=lambda item: (-item[1], item[0]))[0] for key, c in counts.items()
    }
    found: dict[str, list[str]] = {"majority per family": [], "question only": []}
    for question in _all(test):
        keys = _keys(question)
        found["majority per family"].append(best[keys[-1]][0])
        found["question only"].append(next(best[key][0] for key in keys if key in best))
    return found


def shares_right(
    given: Sequence[str], questions: Iterable[Question]
) -> tuple[float, dict[str, float]]:
    """Share of right answers, and by family."""
    right: dict[str, list[bool]] = defaultdict(list)
    for answer, question in zip(given, questions):
        right[question.family].append(answer == question.answer)
    everything = [item for items in right.values() for item in items]
    return float(np.mean(everything)), {name: float(np.mean(v)) for name, v in right.items()}


def all_questions(data: ClevrSet) -> list[Question]:
    """Of all scenes, in the order of :func:`asked_of`."""
    return list(_all(data))


def _keys(question: Question) -> tuple[object, ...]:
    masked = tuple("*" if word in _WORDS else word for word in question.words)
    return (question.words, (question.family, masked), question.family)


def _all(data: ClevrSet) -> Iterable[Question]:
    for questions in data.questions:
        yield from questions
