# SPDX-License-Identifier: Apache-2.0
"""Trains state encoder and answerer together: eq. 4.2 in its three settings."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from perception_node.errors import WeightsError

from .answering import ANSWERERS
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
        questions: words as numbers, 0 after the last one, shape (m, t).
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
        words, answers: how many there are; the first word stands for none.
        epochs: passes over the images.
        batch: images in a batch, with all of their questions.
        learning_rate: peak of a one-cycle schedule.
        checkpoint_every: steps between checkpoints.
        seed: of weights and batches.
    """

    encoder: EncoderConfig = field(default_factory=lambda: EncoderConfig(channels=64))
    setting: str = "both"
    answerer: str = "film"
    words: int = 2
    answers: int = 2
    epochs: int = 30
    batch: int = 16
    learning_rate: float = 1.5e-3
    checkpoint_every: int = 100
    seed: int = 0


class QaTrainer:
    """One run; its whole state can be saved and taken up again."""

    def __init__(self, asked: Asked, config: QaConfig) -> None:
        self.asked, self.config = asked, config
        self.alpha, self.beta = SETTINGS[config.setting]
        torch.manual_seed(config.seed)
        self.encoder = StateEncoder(config.encoder)
        self.answerer = ANSWERERS[config.answerer](config.words, config.answers)
        self.steps = config.epochs * -(-len(asked.images) // config.batch)
        parameters = [*self.encoder.parameters(), *self.answerer.parameters()]
        self.optimizer = torch.optim.AdamW(parameters, lr=config.learning_rate, weight_decay=1e-4)
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=self.steps, pct_start=0.1
        )
        self._bounds = np.searchsorted(asked.owners, np.arange(len(asked.images) + 1))
        self.step = 0
        self.seconds = 0.0

    def run(
        self, on_step: Callable[[int, dict[str, float]], bool], checkpoint: Path | None = None
    ) -> bool:
        """Trains until done, or ``on_step(step, losses)`` returns False; whether it is done."""
        self.encoder.train()
        self.answerer.train()
        go_on = True
        while go_on and self.step < self.steps:
            start = time.perf_counter()
            losses = self._advance()
            self.seconds += time.perf_counter() - start
            go_on = on_step(self.step, losses)
            if checkpoint and self.step % self.config.checkpoint_every == 0:
                self.save(checkpoint)
        if checkpoint:
            self.save(checkpoint)
        self.encoder.eval()
        self.answerer.eval()
        return self.step >= self.steps

    def _advance(self) -> dict[str, float]:
        images, questions, owners, answers = self._batch()
        quantised, _, own = self.encoder.quantiser(self.encoder.encoder(images))
        shown = self.encoder.decoder(quantised)
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
        self.step += 1
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

    def save(self, path: Path) -> None:
        """Writes the whole state of the run; the old file is replaced once the new one is there."""
        path.parent.mkdir(parents=True, exist_ok=True)
        state: dict[str, Any] = {
            "config": asdict(self.config),
            "step": self.step,
            "seconds": self.seconds,
            "encoder": self.encoder.state_dict(),
            "answerer": self.answerer.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "schedule": self.schedule.state_dict(),
            "random": torch.get_rng_state(),
        }
        partial = path.with_suffix(".partial")
        torch.save(state, partial)
        partial.replace(path)

    def resume(self, path: Path) -> None:
        """Takes up a run where :meth:`save` left it; executes nothing from the file.

        Raises:
            WeightsError: if the file is damaged or belongs to a run with other hyper-parameters.
        """
        try:
            state = torch.load(path, weights_only=True)
            if state["config"] != asdict(self.config):
                raise WeightsError(
                    f"checkpoint {path} belongs to a run with other hyper-parameters; "
                    "use another folder, or delete it",
                    path,
                )
            self.encoder.load_state_dict(state["encoder"])
            self.answerer.load_state_dict(state["answerer"])
            self.optimizer.load_state_dict(state["optimizer"])
            self.schedule.load_state_dict(state["schedule"])
            torch.set_rng_state(state["random"])
            self.step, self.seconds = int(state["step"]), float(state["seconds"])
        except WeightsError:
            raise
        except Exception as error:  # torch reports damage by a dozen types
            raise WeightsError(
                f"checkpoint {path} is damaged ({error}); delete it", path
            ) from error
