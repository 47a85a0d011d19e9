# SPDX-License-Identifier: Apache-2.0
"""Trains the state encoder on pictures; its whole state can be saved and taken up again."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from perception_node.errors import WeightsError

from .objective import Parts, Weights, paired_loss
from .state_encoder import EncoderConfig, StateEncoder, values_of

#: Pictures (s, r, 128, 128, 3): r of each of s states.
Pictures = NDArray[np.uint8]


@dataclass(frozen=True)
class TrainingConfig:
    """Hyper-parameters.

    Attributes:
        encoder: what is trained.
        weights: of the parts of the loss.
        steps: number of batches.
        batch: states in a batch, two pictures of each.
        learning_rate: peak of a one-cycle schedule.
        grain: standard deviations of noise that pictures get are drawn up to this [0..1].
        checkpoint_every: steps between checkpoints.
        seed: of weights and batches.
    """

    encoder: EncoderConfig = field(default_factory=EncoderConfig)
    weights: Weights = field(default_factory=Weights)
    steps: int = 3000
    batch: int = 16
    learning_rate: float = 2e-3
    grain: float = 0.03
    checkpoint_every: int = 200
    seed: int = 0


class EncoderTrainer:
    """One run."""

    def __init__(self, pictures: Pictures, config: TrainingConfig) -> None:
        self.pictures, self.config = pictures, config
        torch.manual_seed(config.seed)
        self.encoder = StateEncoder(config.encoder)
        self.optimizer = torch.optim.AdamW(
            self.encoder.parameters(), lr=config.learning_rate, weight_decay=1e-4
        )
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=config.steps, pct_start=0.1
        )
        self.rng = torch.Generator().manual_seed(config.seed)
        self.step = 0
        self.seconds = 0.0

    def run(self, on_step: Callable[[int, Parts], bool], checkpoint: Path | None = None) -> bool:
        """Trains until done, or until ``on_step(step, parts)`` returns False; whether it is done.

        A checkpoint is written now and then, and at the end in either case.
        """
        self.encoder.train()
        go_on = True
        while go_on and self.step < self.config.steps:
            start = time.perf_counter()
            parts = self._advance()
            self.seconds += time.perf_counter() - start
            go_on = on_step(self.step, parts)
            if checkpoint and self.step % self.config.checkpoint_every == 0:
                self.save(checkpoint)
        if checkpoint:
            self.save(checkpoint)
        self.encoder.eval()
        return self.step >= self.config.steps

    def _advance(self) -> Parts:
        first, second = self._batch()
        parts = paired_loss(self.encoder, first, second, self.config.weights, self.rng)
        self.optimizer.zero_grad(set_to_none=True)
        parts.total(self.config.weights).backward()
        torch.nn.utils.clip_grad_norm_(self.encoder.parameters(), 1.0)
        self.optimizer.step()
        self.schedule.step()
        self.step += 1
        return parts

    def _batch(self) -> tuple[Tensor, Tensor]:
        states, renders = self.pictures.shape[:2]
        picked = torch.randint(states, (self.config.batch,), generator=self.rng)
        pairs = torch.stack(
            [torch.randperm(renders, generator=self.rng)[:2] for _ in range(len(picked))]
        )
        index, pair = picked.numpy(), pairs.numpy()
        one, other = (
            values_of(self.pictures[index, pair[:, side % pair.shape[1]]]) for side in (0, 1)
        )
        return self._grained(one), self._grained(other)

    def _grained(self, images: Tensor) -> Tensor:
        strength = self.config.grain * torch.rand(len(images), 1, 1, 1, generator=self.rng) ** 2
        noise = torch.randn(images.shape, generator=self.rng)
        return (images + strength * noise).contiguous(memory_format=torch.channels_last)

    def save(self, path: Path) -> None:
        """Writes the whole state of the run; the old file is replaced once the new one is there."""
        path.parent.mkdir(parents=True, exist_ok=True)
        state: dict[str, Any] = {
            "config": asdict(self.config),
            "step": self.step,
            "seconds": self.seconds,
            "encoder": self.encoder.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "schedule": self.schedule.state_dict(),
            "rng": self.rng.get_state(),
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
                    "use another --run folder, or delete it",
                    path,
                )
            self.encoder.load_state_dict(state["encoder"])
            self.optimizer.load_state_dict(state["optimizer"])
            self.schedule.load_state_dict(state["schedule"])
            self.rng.set_state(state["rng"])
            self.step, self.seconds = int(state["step"]), float(state["seconds"])
        except WeightsError:
            raise
        except Exception as error:  # torch reports damage by a dozen types
            raise WeightsError(
                f"checkpoint {path} is damaged ({error}); delete it", path
            ) from error
