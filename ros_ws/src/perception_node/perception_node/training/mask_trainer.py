# SPDX-License-Identifier: Apache-2.0
"""Trains the network that finds blocks in colour alone, on repainted pictures of the simulator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from perception_node.segment.mask_network import BLOCK, MaskNetwork, read_weights, where

from .mask_views import Views, shown
from .run import Stateful, TrainingRun


@dataclass(frozen=True)
class MaskTraining:
    """Hyper-parameters.

    Attributes:
        steps: number of batches.
        batch: views a batch.
        size: edge of the part of a view that is shown, a multiple of 16 [px].
        learning_rate: peak of a one-cycle schedule.
        weight_decay: of AdamW.
        middles: weight of the middles' error beside that of the classes.
        bfloat16: autocast of the network; slower where the processor cannot multiply it.
        checkpoint_every: steps between checkpoints.
        seed: of weights, batches and paint.
        start: weights to begin with, the path of a file; empty: random ones.
    """

    steps: int = 2200
    batch: int = 6
    size: int = 160
    learning_rate: float = 2e-3
    weight_decay: float = 1e-4
    middles: float = 0.5
    bfloat16: bool = True
    checkpoint_every: int = 200
    seed: int = 0
    start: str = ""


class MaskTrainer(TrainingRun[float]):
    """One training run; each step tells its loss.

    Raises:
        WeightsError: if it is to begin with weights that cannot be read.
    """

    def __init__(self, views: Views, config: MaskTraining) -> None:
        super().__init__(config, config.steps)
        self.views = views
        torch.manual_seed(config.seed)
        begun = read_weights(Path(config.start)) if config.start else MaskNetwork()
        self.network = begun.to(memory_format=torch.channels_last)
        self.optimizer = torch.optim.AdamW(
            self.network.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay
        )
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=config.steps, pct_start=0.1
        )
        self._generator = torch.Generator().manual_seed(config.seed)

    @property
    def networks(self) -> tuple[MaskNetwork]:
        """See :class:`TrainingRun`."""
        return (self.network,)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        return {"network": self.network, "optimizer": self.optimizer, "schedule": self.schedule}

    @property
    def generator(self) -> torch.Generator:
        """See :class:`TrainingRun`."""
        return self._generator

    def advance(self) -> float:
        """See :class:`TrainingRun`."""
        views, classes, middles, weight = self._batch()
        with torch.autocast("cpu", torch.bfloat16, enabled=self.config.bfloat16):
            logits, told = self.network(views)
        logits, told = logits.float(), told.float()
        loss = (functional.cross_entropy(logits, classes, reduction="none") * weight).mean()
        block = (classes == BLOCK)[:, None] * weight[:, None]
        off = functional.smooth_l1_loss(told, middles, reduction="none", beta=0.1)
        loss = loss + self.config.middles * (off * block).sum() / (2.0 * block.sum() + 1.0)
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self.optimizer.step()
        self.schedule.step()
        return float(loss.detach())

    def _batch(self) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Inputs; and of each pixel class, middle and weight."""
        size = self.config.size
        seed = int(torch.randint(2**31, (), generator=self.generator))
        rng = np.random.default_rng(seed)
        picked = rng.integers(len(self.views), size=self.config.batch)
        items = [shown(self.views, int(index), size, rng) for index in picked]
        feet, aside = (
            torch.from_numpy(np.stack(rows))
            for rows in ([item.feet for item in items], [item.aside for item in items])
        )
        steepness = torch.tensor([item.steepness for item in items])
        colors = torch.from_numpy(np.stack([item.rgb for item in items]))
        views = torch.cat([colors, where(feet, aside, steepness, size)], 1)
        return (
            views.contiguous(memory_format=torch.channels_last),
            torch.from_numpy(np.stack([item.classes for item in items])),
            torch.from_numpy(np.stack([item.middles for item in items])),
            torch.from_numpy(np.stack([item.weight for item in items])),
        )
