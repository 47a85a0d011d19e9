# SPDX-License-Identifier: Apache-2.0
"""One run of a training, whatever is trained: step after step, saved, and taken up again."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import torch
from torch import nn

from perception_node.errors import WeightsError

Told = TypeVar("Told")


class Stateful(Protocol):
    """A network, an optimiser or a schedule."""

    def state_dict(self) -> dict[str, Any]:
        """All that it needs to go on."""

    def load_state_dict(self, state: dict[str, Any], /) -> Any:
        """The inverse."""


class TrainingRun(ABC, Generic[Told]):
    """Advances a training by steps that tell how it goes.

    Args:
        config: the hyper-parameters, a dataclass with ``checkpoint_every``.
        steps: how many there are.

    Attributes:
        step: how many are done.
        seconds: time spent in them [s].
    """

    def __init__(self, config: Any, steps: int) -> None:
        self.config, self.steps = config, steps
        self.step, self.seconds = 0, 0.0

    @property
    @abstractmethod
    def networks(self) -> Sequence[nn.Module]:
        """What is trained."""

    @property
    @abstractmethod
    def parts(self) -> Mapping[str, Stateful]:
        """What a checkpoint holds, by name."""

    @property
    @abstractmethod
    def generator(self) -> torch.Generator:
        """Where batches are drawn from."""

    @abstractmethod
    def advance(self) -> Told:
        """Does the next step, all but counting it."""

    def run(self, on_step: Callable[[int, Told], bool], checkpoint: Path | None = None) -> bool:
        """Trains until done, or until ``on_step(step, what it told)`` returns False.

        A checkpoint is written now and then, and at the end in either case.

        Returns:
            Whether all steps are done.
        """
        for network in self.networks:
            network.train()
        go_on = True
        while go_on and self.step < self.steps:
            start = time.perf_counter()
            told = self.advance()
            self.step += 1
            self.seconds += time.perf_counter() - start
            go_on = on_step(self.step, told)
            if checkpoint and self.step % self.config.checkpoint_every == 0:
                self.save(checkpoint)
        if checkpoint:
            self.save(checkpoint)
        for network in self.networks:
            network.eval()
        return self.step >= self.steps

    def save(self, path: Path) -> None:
        """Writes the whole state of the run; the old file is replaced once the new one is there."""
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_suffix(".partial")
        state: dict[str, Any] = {
            **{name: part.state_dict() for name, part in self.parts.items()},
            "config": asdict(self.config),
            "step": self.step,
            "seconds": self.seconds,
            "generator": self.generator.get_state(),
        }
        torch.save(state, partial)
        partial.replace(path)

    def resume(self, path: Path) -> None:
        """Takes up a run where :meth:`save` left it; executes nothing from the file.

        Raises:
            WeightsError: if the file is damaged or belongs to a run with other hyper-parameters.
        """
        try:
            state = torch.load(path, weights_only=True)
            if not self.is_of_this_run(state):
                raise WeightsError(
                    f"checkpoint {path} belongs to a run with other hyper-parameters; "
                    "use another --run folder, or delete it",
                    path,
                )
            for name, part in self.parts.items():
                part.load_state_dict(state[name])
            self.generator.set_state(state["generator"])
            self.step, self.seconds = int(state["step"]), float(state["seconds"])
        except WeightsError:
            raise
        except Exception as error:  # torch reports damage by a dozen types
            raise WeightsError(
                f"checkpoint {path} is damaged ({error}); delete it", path
            ) from error

    def is_of_this_run(self, state: dict[str, Any]) -> bool:
        """Whether a checkpoint can be taken up."""
        return bool(state["config"] == asdict(self.config))
