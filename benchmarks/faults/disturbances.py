# SPDX-License-Identifier: Apache-2.0
"""Faults of the world itself: ``sim/disturb`` pushes, covers, jams, at once or at an event."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from tamp_interfaces.srv import Disturb

from faults.injections import Once
from faults.setting import Setting
from scene_graph import BOX, COLORS, Stacks, object_name
from sim_node.cli.client import DisturbClient, SimulatorUnavailableError

#: Which blocks a disturbance is about, by the layout at the beginning and the trial's seed.
Chooser = Callable[[Stacks, int], tuple[str, ...]]


def no_block(_stacks: Stacks, _seed: int) -> tuple[str, ...]:
    """Where it is not about a block, or about that in the hand."""
    return ()


def some_top(stacks: Stacks, seed: int) -> tuple[str, ...]:
    """A block on which nothing stands."""
    tops = [stack[-1] for stack in stacks if stack]
    return (str(np.random.default_rng([seed, 11]).choice(tops)),)


def two_blocks(stacks: Stacks, seed: int) -> tuple[str, ...]:
    """Two different ones."""
    names = sorted(name for stack in stacks for name in stack)
    first, second = np.random.default_rng([seed, 12]).choice(names, 2, replace=False)
    return str(first), str(second)


def new_block(stacks: Stacks, _seed: int) -> tuple[str, ...]:
    """The first box in the order of colours that is not there."""
    there = {name for stack in stacks for name in stack}
    names = (object_name(color, BOX) for color in COLORS)
    return (next(name for name in names if name not in there),)


@dataclass(frozen=True)
class Disturbed(Once):
    """``sim/disturb``; what is left of it is over when the fault ends.

    Args:
        kind: of the disturbance.
        blocks: which it is about.
        fields: of the request, as :class:`Disturb.Request` names them.
        on_top: a block is added on such a top.
    """

    kind: str
    blocks: Chooser = no_block
    fields: Mapping[str, Any] = field(default_factory=dict)
    on_top: bool = False

    def request(self, stacks: Stacks, seed: int) -> Disturb.Request:
        """What is asked of the simulator."""
        on = some_top(stacks, seed)[0] if self.on_top else ""
        blocks = list(self.blocks(stacks, seed))
        return Disturb.Request(kind=self.kind, blocks=blocks, on=on, **self.fields)

    def begin(self, setting: Setting) -> None:
        ask(self.request(setting.initial, setting.seed))

    def end(self, setting: Setting) -> None:
        setting.wait_for_nodes("sim_node")
        ask(Disturb.Request(kind=Disturb.Request.CALM))


def ask(request: Disturb.Request) -> None:
    """Has the simulator do it; raises RuntimeError if it does not."""
    with DisturbClient() as simulator:
        try:
            answer = simulator.disturb(request, timeout=30.0)
        except SimulatorUnavailableError as error:
            raise RuntimeError(f"the world could not be disturbed: {error}") from error
    if not answer.success:
        raise RuntimeError(f"the world could not be disturbed: {answer.message}")
