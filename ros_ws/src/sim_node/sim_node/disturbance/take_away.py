# SPDX-License-Identifier: Apache-2.0
"""Somebody takes a block away."""

from __future__ import annotations

from .disturbance import Disturbance, Stage, block_in_hand, check_there, named_blocks
from .request import Request


class TakeAway(Disturbance):
    """The named block, that of the event or that in the hand is gone; what stood on it falls."""

    uses = frozenset({"blocks"})

    def __init__(self, request: Request) -> None:
        self._name = "".join(named_blocks(request, 0, 1))
        self.sentence = f"{self._name or 'the block in the hand'} is taken away"

    def check(self, stage: Stage) -> None:
        """Of a named block: it is there."""
        check_there(stage, *([self._name] if self._name else []))

    def begin(self, stage: Stage) -> None:
        """Takes it away."""
        name = self._name or stage.block or block_in_hand(stage)
        check_there(stage, name)
        self.sentence = f"{name} is taken away"
        stage.world.remove_block(name)
