# SPDX-License-Identifier: Apache-2.0
"""Trains the learnt action model M2 on transitions: codes and actions, never what stands where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from perception_node.errors import WeightsError
from perception_node.training.run import Stateful, TrainingRun

from ..errors import PlannerError
from .effect_network import Discriminator, EffectConfig, EffectNetwork

#: What π is trained on: eq. 4.3, or the cross-entropy of every bit.
THESIS: Final = "thesis"
BITS: Final = "bits"
OBJECTIVES: Final = (BITS, THESIS)
#: γ of eq. 4.3.
_GAMMA: Final = 1.0


class CheckpointError(PlannerError):
    """A checkpoint that is damaged, or of another run."""


@dataclass(frozen=True)
class Transitions:
    """What was seen.

    Attributes:
        codes: packed, shape (s, r, b): r pictures of each of s moments.
        before, action, after: which action led from which moment to which, shape (t,).
        possible: which actions were possible at each moment, shape (s, |A|).
        parts: bits that change by themselves, as indices into a code.
    """

    codes: NDArray[np.uint8]
    before: NDArray[np.int64]
    action: NDArray[np.int64]
    after: NDArray[np.int64]
    possible: NDArray[np.bool_]
    parts: tuple[NDArray[np.int64], ...]


@dataclass(frozen=True)
class ActionTraining:
    """Hyper-parameters.

    Attributes:
        effect: the networks.
        objective: one of :data:`OBJECTIVES`.
        steps: number of batches.
        batch: transitions in a batch.
        learning_rate: peak of a one-cycle schedule.
        changed: weight of bits that the action changes, beside 1 for the others.
        flips: share of bits of the input that are turned.
        swaps: share of parts that an action left alone that are given another content, before and
            after it: what does not change is taken to be of no influence.
        checkpoint_every: steps between checkpoints.
        seed: of weights and batches.
    """

    effect: EffectConfig = field(default_factory=EffectConfig)
    objective: str = BITS
    steps: int = 3000
    batch: int = 128
    learning_rate: float = 1e-3
    changed: float = 4.0
    flips: float = 0.002
    swaps: float = 0.5
    checkpoint_every: int = 200
    seed: int = 0


class ActionTrainer(TrainingRun[dict[str, float]]):
    """One run of both networks; each step tells the losses of π and D."""

    def __init__(self, seen: Transitions, config: ActionTraining) -> None:
        super().__init__(config, config.steps)
        self.seen = seen
        torch.manual_seed(config.seed)
        self.policy = EffectNetwork(config.effect, seen.parts)
        self.discriminator = Discriminator(config.effect, seen.parts)
        index = self.policy.index.numpy()
        self._values = torch.from_numpy(np.unpackbits(seen.codes, axis=2)[:, :, index])
        parameters = [*self.policy.parameters(), *self.discriminator.parameters()]
        self.optimizer = torch.optim.AdamW(
            parameters, lr=config.learning_rate, weight_decay=0.01, betas=(0.9, 0.98)
        )
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=config.steps, pct_start=0.1
        )
        self.rng = torch.Generator().manual_seed(config.seed)

    @property
    def networks(self) -> tuple[EffectNetwork, Discriminator]:
        """See :class:`TrainingRun`."""
        return (self.policy, self.discriminator)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        return {
            "policy": self.policy,
            "discriminator": self.discriminator,
            "optimizer": self.optimizer,
            "schedule": self.schedule,
        }

    @property
    def generator(self) -> torch.Generator:
        """See :class:`TrainingRun`."""
        return self.rng

    def advance(self) -> dict[str, float]:
        """See :class:`TrainingRun`."""
        seen = self.seen
        picked = torch.randint(len(seen.before), (self.config.batch,), generator=self.rng).numpy()
        before = self._drawn(seen.before[picked])
        after = self._drawn(seen.after[picked])
        possible = torch.from_numpy(seen.possible[seen.before[picked]]).float()
        of_discriminator = torch.nn.functional.binary_cross_entropy_with_logits(
            self.discriminator(self._flipped(before)), possible
        )  # eq. 4.4
        before, after = self._swapped(before, after)
        logits = self.policy(self._flipped(before), torch.from_numpy(seen.action[picked]))
        of_policy = self._policy_loss(logits, before, after)
        self.optimizer.zero_grad(set_to_none=True)
        (of_policy + of_discriminator).backward()
        torch.nn.utils.clip_grad_norm_(self.policy.parameters(), 1.0)
        self.optimizer.step()
        self.schedule.step()
        return {"π": float(of_policy.detach()), "D": float(of_discriminator.detach())}

    def _policy_loss(self, logits: Tensor, before: Tensor, after: Tensor) -> Tensor:
        if self.config.objective == THESIS:
            predicted = torch.sigmoid(logits)
            right = (predicted - after).square().flatten(1).sum(1)
            other = (predicted - after.roll(1, 0)).square().flatten(1).sum(1)
            return (right + torch.relu(_GAMMA - other)).mean()  # eq. 4.3
        weights = torch.where(before == after, 1.0, self.config.changed)
        return torch.nn.functional.binary_cross_entropy_with_logits(logits, after, weights)

    def _drawn(self, states: NDArray[np.int64]) -> Tensor:
        """Bits of all parts (n, m) of one picture each of some moments."""
        renders = self._values.shape[1]
        drawn = torch.randint(renders, (len(states),), generator=self.rng)
        return self._values[torch.from_numpy(states), drawn].float()

    def _flipped(self, values: Tensor) -> Tensor:
        turned = torch.rand(values.shape, generator=self.rng) < self.config.flips
        return torch.where(turned, 1.0 - values, values)

    def _swapped(self, before: Tensor, after: Tensor) -> tuple[Tensor, Tensor]:
        """Parts that are the same before and after, some with the content of another moment."""
        if self.config.swaps == 0.0 or self.config.objective == THESIS:
            return before, after
        others = self._drawn(
            torch.randint(len(self._values), (len(before),), generator=self.rng).numpy()
        )
        lengths = self.policy.lengths
        parts = zip(*(values.split(lengths, dim=1) for values in (before, after, others)))
        swapped = []
        for was, becomes, other in parts:
            drawn = torch.rand(len(was), 1, generator=self.rng) < self.config.swaps
            free = drawn & (was == becomes).all(1, keepdim=True)
            swapped.append((torch.where(free, other, was), torch.where(free, other, becomes)))
        return torch.cat([w for w, _ in swapped], 1), torch.cat([b for _, b in swapped], 1)

    def resume(self, path: Path) -> None:
        """Takes up a run where :meth:`save` left it; executes nothing from the file.

        Raises:
            CheckpointError: it is damaged, or of a run with other hyper-parameters or codes.
        """
        try:
            super().resume(path)
        except WeightsError as error:
            raise CheckpointError(str(error)) from error

    def is_of_this_run(self, state: dict[str, Any]) -> bool:
        """Whether it was trained on the same bits, too."""
        same = torch.equal(state["policy"]["index"], self.policy.index)
        return same and super().is_of_this_run(state)
