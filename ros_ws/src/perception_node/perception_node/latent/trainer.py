# SPDX-License-Identifier: Apache-2.0
"""Trains the state encoder on pictures; its whole state can be saved and taken up again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from perception_node.training.run import Stateful, TrainingRun

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


class EncoderTrainer(TrainingRun[Parts]):
    """One run; each step tells the parts of its loss."""

    def __init__(self, pictures: Pictures, config: TrainingConfig) -> None:
        super().__init__(config, config.steps)
        self.pictures = pictures
        torch.manual_seed(config.seed)
        self.encoder = StateEncoder(config.encoder)
        self.optimizer = torch.optim.AdamW(
            self.encoder.parameters(), lr=config.learning_rate, weight_decay=1e-4
        )
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=config.steps, pct_start=0.1
        )
        self.rng = torch.Generator().manual_seed(config.seed)

    @property
    def networks(self) -> tuple[StateEncoder]:
        """See :class:`TrainingRun`."""
        return (self.encoder,)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        return {"encoder": self.encoder, "optimizer": self.optimizer, "schedule": self.schedule}

    @property
    def generator(self) -> torch.Generator:
        """See :class:`TrainingRun`."""
        return self.rng

    def advance(self) -> Parts:
        """See :class:`TrainingRun`."""
        first, second = self._batch()
        parts = paired_loss(self.encoder, first, second, self.config.weights, self.rng)
        self.optimizer.zero_grad(set_to_none=True)
        parts.total(self.config.weights).backward()
        torch.nn.utils.clip_grad_norm_(self.encoder.parameters(), 1.0)
        self.optimizer.step()
        self.schedule.step()
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
