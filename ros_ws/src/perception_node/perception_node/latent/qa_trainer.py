# SPDX-License-Identifier: Apache-2.0
"""Trains state encoder and answerer together: eq. 4.2 in its three settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from perception_node.training.run import Stateful, TrainingRun

from .answering import ANSWERERS
from .networks import half_precision
from .state_encoder import EncoderConfig, StateEncoder, values_of

#: Settings of eq. 4.2: α of the reconstruction error, β of the divergence.
SETTINGS: Final[dict[str, tuple[float, float]]] = {
    "kl": (0.0, 1.0),
    "reconstruction": (100.0, 0.0),
    "both": (100.0, 1.0),
}


@dataclass(frozen=True)
class Asked:
    """Questions about images.

    Attributes:
        images: shape (n, 128, 128, 3).
        questions: words, or tokens of programs, as numbers, 0 after the last one, shape (m, t).
        owners: which image each is about, ascending, shape (m,).
        answers: as numbers, shape (m,).
    """

    images: NDArray[np.uint8]
    questions: NDArray[np.int64]
    owners: NDArray[np.int64]
    answers: NDArray[np.int64]


@dataclass(frozen=True)
class QaConfig:
    """Hyper-parameters.

    Attributes:
        encoder: what is trained.
        setting: one of :data:`SETTINGS`.
        answerer: one of :data:`.answering.ANSWERERS`.
        words, answers: that there are; the first word stands for none.
        epochs: passes over the images.
        batch: images in a batch, with all of their questions.
        learning_rate: peak of a one-cycle schedule.
        checkpoint_every: steps between checkpoints.
        seed: of weights and batches.
    """

    encoder: EncoderConfig = field(default_factory=lambda: EncoderConfig(channels=64))
    setting: str = "both"
    answerer: str = "program"
    words: tuple[str, ...] = ("",)
    answers: tuple[str, ...] = ("yes", "no")
    epochs: int = 30
    batch: int = 16
    learning_rate: float = 1.5e-3
    checkpoint_every: int = 100
    seed: int = 0


class QaTrainer(TrainingRun[dict[str, float]]):
    """One run; each step tells the parts of its loss."""

    def __init__(self, asked: Asked, config: QaConfig) -> None:
        super().__init__(config, config.epochs * -(-len(asked.images) // config.batch))
        self.asked = asked
        self.alpha, self.beta = SETTINGS[config.setting]
        torch.manual_seed(config.seed)
        self.encoder = StateEncoder(config.encoder)
        self.answerer = ANSWERERS[config.answerer](config.words, config.answers)
        parameters = [*self.encoder.parameters(), *self.answerer.parameters()]
        self.optimizer = torch.optim.AdamW(parameters, lr=config.learning_rate, weight_decay=1e-4)
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=self.steps, pct_start=0.1
        )
        self._bounds = np.searchsorted(asked.owners, np.arange(len(asked.images) + 1))

    @property
    def networks(self) -> tuple[nn.Module, nn.Module]:
        """See :class:`TrainingRun`."""
        return (self.encoder, self.answerer)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        return {
            "encoder": self.encoder,
            "answerer": self.answerer,
            "optimizer": self.optimizer,
            "schedule": self.schedule,
        }

    @property
    def generator(self) -> torch.Generator:
        """PyTorch's own, from which dropout draws; batches come from seed and epoch."""
        return torch.default_generator

    def advance(self) -> dict[str, float]:
        """See :class:`TrainingRun`."""
        images, questions, owners, answers = self._batch()
        with half_precision():
            features = self.encoder.encoder(images)
        quantised, _, own = self.encoder.quantiser(features.float())
        with half_precision():
            shown = self.encoder.decoder(quantised)
        shown = shown.float()
        of_image = self.answerer(images, questions, owners)
        likelihood = functional.cross_entropy(of_image, answers)
        error = (shown - images).square().mean()
        loss = self.alpha * error + own + likelihood
        divergence = error.new_zeros(())
        if self.beta:
            of_shown = self.answerer(shown, questions, owners)
            divergence = functional.kl_div(
                functional.log_softmax(of_shown, 1),
                functional.log_softmax(of_image.detach(), 1),
                reduction="batchmean",
                log_target=True,
            )
            # The likelihood of the answers is asked of what the code shows, too.
            loss = loss + self.beta * (divergence + functional.cross_entropy(of_shown, answers))
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        for network in (self.encoder, self.answerer):
            torch.nn.utils.clip_grad_norm_(network.parameters(), 2.0)
        self.optimizer.step()
        self.schedule.step()
        return {
            "error": float(error.detach()),
            "likelihood": float(likelihood.detach()),
            "divergence": float(divergence.detach()),
        }

    def _batch(self) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Every image once an epoch, in an order that the seed and the epoch give."""
        size, count = self.config.batch, len(self.asked.images)
        epoch, place = divmod(self.step, -(-count // size))
        order = np.random.default_rng([self.config.seed, epoch]).permutation(count)
        picked = order[place * size : (place + 1) * size]
        rows = [np.arange(self._bounds[i], self._bounds[i + 1]) for i in picked]
        owners = np.repeat(np.arange(len(picked)), [len(row) for row in rows])
        index = np.concatenate(rows)
        return (
            values_of(self.asked.images[picked]),
            torch.from_numpy(self.asked.questions[index]),
            torch.from_numpy(owners),
            torch.from_numpy(self.asked.answers[index]),
        )
