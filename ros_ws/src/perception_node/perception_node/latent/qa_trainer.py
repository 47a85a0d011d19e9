# SPDX-License-Identifier: Apache-2.0
"""Trains an answerer, then state encoders by what it reads off the pictures their codes show.

That is eq. 4.2 in its three settings. The answerer learns from the images first (the likelihood
term). Where answers are asked of what codes show, it goes on learning from that, too: from the
images and what their codes show alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from perception_node.training.run import Stateful, TrainingRun

from .answering import ANSWERERS, ManyViews, words_in_mirror
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
class ReaderConfig:
    """Hyper-parameters of the answerer's own training.

    Attributes:
        answerer: one of :data:`.answering.ANSWERERS`.
        words, answers: that there are; the first word stands for none.
        mirrored: words that change places in a mirror; without any, no image is mirrored.
        epochs: passes over the images.
        batch: images in a batch, with all of their questions.
        learning_rate: peak of a one-cycle schedule.
        checkpoint_every: steps between checkpoints.
        seed: of weights and batches.
    """

    answerer: str = "program"
    words: tuple[str, ...] = ("",)
    answers: tuple[str, ...] = ("yes", "no")
    mirrored: tuple[tuple[str, str], ...] = ()
    epochs: int = 20
    batch: int = 32
    learning_rate: float = 3e-3
    checkpoint_every: int = 100
    seed: int = 0


@dataclass(frozen=True)
class QaConfig:
    """Hyper-parameters of a state encoder's training by what an answerer reads off its pictures.

    Attributes:
        encoder: what is trained.
        setting: one of :data:`SETTINGS`.
        reader: how the answerer was trained.
        epochs, batch, learning_rate, checkpoint_every, seed: as the reader's.
    """

    encoder: EncoderConfig = field(default_factory=lambda: EncoderConfig(channels=64))
    setting: str = "both"
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    epochs: int = 16
    batch: int = 16
    learning_rate: float = 1.5e-3
    checkpoint_every: int = 100
    seed: int = 0


class ReaderTrainer(TrainingRun[dict[str, float]]):
    """Trains an answerer on the images themselves: the likelihood term of eq. 4.2."""

    def __init__(self, asked: Asked, config: ReaderConfig) -> None:
        super().__init__(config, _steps(asked, config))
        torch.manual_seed(config.seed)
        self.batches = _Batches(asked, config, config.words, config.mirrored)
        self.answerer = ANSWERERS[config.answerer](config.words, config.answers)
        self.reader = ManyViews(self.answerer, config.words, config.mirrored)
        self.optimizer, self.schedule = _optimizer(self.answerer, config, self.steps)

    @property
    def networks(self) -> tuple[nn.Module]:
        """See :class:`TrainingRun`."""
        return (self.answerer,)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        return {
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
        images, questions, owners, answers = self.batches.at(self.step)
        loss = functional.cross_entropy(self.answerer(images, questions, owners), answers)
        _descend(loss, self.answerer, self.optimizer, self.schedule)
        return {"likelihood": float(loss.detach())}


class QaTrainer(TrainingRun[dict[str, float]]):
    """Trains a state encoder by eq. 4.2; each step tells the parts of its loss.

    Args:
        asked: what is shown and asked.
        config: the hyper-parameters.
        reader: a trained one. Of reconstruction only it is asked as it is; a setting with the
            divergence trains one of its own on from there.
        start: a trained encoder of the same kind to go on from; without one, from nothing.
    """

    def __init__(
        self,
        asked: Asked,
        config: QaConfig,
        reader: ManyViews,
        start: StateEncoder | None = None,
    ) -> None:
        super().__init__(config, _steps(asked, config))
        self.alpha, self.beta = SETTINGS[config.setting]
        torch.manual_seed(config.seed)
        mirrored = config.reader.mirrored if self.beta else ()
        self.batches = _Batches(asked, config, config.reader.words, mirrored)
        self.encoder = StateEncoder(config.encoder)
        if start is not None:
            self.encoder.load_state_dict(start.state_dict())
        self.reader = deepcopy(reader).requires_grad_(True) if self.beta else reader
        self._trained = nn.ModuleList(self.networks)
        self.optimizer, self.schedule = _optimizer(self._trained, config, self.steps)

    @property
    def networks(self) -> tuple[nn.Module, ...]:
        """See :class:`TrainingRun`."""
        return (self.encoder, self.reader) if self.beta else (self.encoder,)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        parts: dict[str, Stateful] = {
            "encoder": self.encoder,
            "optimizer": self.optimizer,
            "schedule": self.schedule,
        }
        return parts | {"reader": self.reader} if self.beta else parts

    @property
    def generator(self) -> torch.Generator:
        """PyTorch's own; batches come from seed and epoch."""
        return torch.default_generator

    def advance(self) -> dict[str, float]:
        """See :class:`TrainingRun`."""
        images, questions, owners, answers = self.batches.at(self.step)
        with half_precision():
            features = self.encoder.encoder(images)
        quantised, _, own = self.encoder.quantiser(features.float())
        with half_precision():
            shown = self.encoder.decoder(quantised)
        shown = shown.float()
        error = (shown - images).square().mean()
        loss = self.alpha * error + own
        told = {"error": float(error.detach())}
        if self.beta:
            # One pass, so that what is normalised by batches is so alike for both.
            pictures = torch.cat([images, shown])
            both = torch.cat([owners, owners + len(images)])
            read = self.reader.one_way(pictures, questions.repeat(2, 1), both, mirror=False)
            of_images, of_shown = read.chunk(2)
            likelihood = functional.nll_loss(of_shown, answers)
            from_images = functional.nll_loss(of_images, answers)
            divergence = functional.kl_div(
                of_shown, of_images.detach(), reduction="batchmean", log_target=True
            )
            loss = loss + self.beta * (divergence + likelihood + from_images)
            told |= {
                "likelihood": float(likelihood.detach()),
                "from images": float(from_images.detach()),
                "divergence": float(divergence.detach()),
            }
        _descend(loss, self._trained, self.optimizer, self.schedule)
        return told


class _Batches:
    """Every image once an epoch, with all of its questions, in an order by seed and epoch.

    Args:
        asked: all of them.
        config: with ``batch`` and ``seed``.
        words: of questions.
        mirrored: see :class:`ReaderConfig`; every second batch is mirrored, an image by turns.
    """

    def __init__(
        self,
        asked: Asked,
        config: ReaderConfig | QaConfig,
        words: Sequence[str],
        mirrored: Sequence[tuple[str, str]] = (),
    ) -> None:
        self.asked, self.size, self.seed = asked, config.batch, config.seed
        self._bounds = np.searchsorted(asked.owners, np.arange(len(asked.images) + 1))
        self._in_mirror = words_in_mirror(words, mirrored).numpy()
        self._turns = 2 if mirrored else 1

    def at(self, step: int) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Images of a step, what is asked, about which of them, and the answers."""
        count = len(self.asked.images)
        epoch, place = divmod(step, -(-count // self.size))
        order = np.random.default_rng([self.seed, epoch]).permutation(count)
        picked = order[place * self.size : (place + 1) * self.size]
        rows = [np.arange(self._bounds[i], self._bounds[i + 1]) for i in picked]
        owners = np.repeat(np.arange(len(picked)), [len(row) for row in rows])
        index = np.concatenate(rows)
        images, questions = self.asked.images[picked], self.asked.questions[index]
        if (epoch + place) % self._turns:
            images, questions = images[:, :, ::-1].copy(), self._in_mirror[questions]
        return (
            values_of(images),
            torch.from_numpy(questions),
            torch.from_numpy(owners),
            torch.from_numpy(self.asked.answers[index]),
        )


def _steps(asked: Asked, config: ReaderConfig | QaConfig) -> int:
    return config.epochs * -(-len(asked.images) // config.batch)


def _optimizer(
    network: nn.Module, config: ReaderConfig | QaConfig, steps: int
) -> tuple[torch.optim.Optimizer, torch.optim.lr_scheduler.LRScheduler]:
    optimizer = torch.optim.AdamW(network.parameters(), lr=config.learning_rate, weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, config.learning_rate, total_steps=steps, pct_start=0.1
    )
    return optimizer, schedule


def _descend(
    loss: Tensor,
    network: nn.Module,
    optimizer: torch.optim.Optimizer,
    schedule: torch.optim.lr_scheduler.LRScheduler,
) -> None:
    optimizer.zero_grad(set_to_none=True)
    loss.backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), 2.0)
    optimizer.step()
    schedule.step()
