# SPDX-License-Identifier: Apache-2.0
"""Somebody takes a block away."""

from __future__ import annotations

from .disturbance import Disturbance, Stage, check_there, named_blocks
from .request import Request


class TakeAway(Disturbance):
    """A block is gone, also out of the hand; what stood on it falls."""

    uses = frozenset({"blocks"})

    def __init__(self, request: Request) -> None:
        (self._name,) = named_blocks(request, 1, 1)
        self.sentence = f"{self._name} is taken away"

    def check(self, stage: Stage) -> None:
        """It is there."""
        check_there(stage, self._name)

    def begin(self, stage: Stage) -> None:
        """Takes it away."""
        check_there(stage, self._name)
        stage.world.remove_block(self._name)
