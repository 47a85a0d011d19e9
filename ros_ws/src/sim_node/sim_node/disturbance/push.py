# SPDX-License-Identifier: Apache-2.0
"""A block is pushed."""

from __future__ import annotations

from typing import Final

from .disturbance import (
    ALONG_X,
    Disturbance,
    Stage,
    along,
    block_in_hand,
    check_there,
    named_blocks,
    unit,
)
from .request import Request

#: Slides a block of 80 g some 5 cm over the table.
DEFAULT_FORCE: Final = 1.1
DEFAULT_SECONDS: Final = 0.1


class Push(Disturbance):
    """A force at the centre of a block: the named one, that of the event, or that in the hand."""

    uses = frozenset({"blocks", "force", "direction", "seconds"})

    def __init__(self, request: Request) -> None:
        self._name = "".join(named_blocks(request, 0, 1))
        self._force = request.force or DEFAULT_FORCE
        self._direction = unit(request.direction, ALONG_X)
        self.seconds = request.seconds or DEFAULT_SECONDS
        self._describe(self._name or "the block in the hand")

    def check(self, stage: Stage) -> None:
        """Of a named block: it is there."""
        check_there(stage, *([self._name] if self._name else []))

    def begin(self, stage: Stage) -> None:
        """Finds the block."""
        name = self._name or stage.block or block_in_hand(stage)
        check_there(stage, name)
        self._name = name
        self._describe(name)

    def act(self, stage: Stage) -> None:
        """Pushes."""
        if self._name in stage.world.names:  # it may be taken away meanwhile
            x, y, z = (self._force * share for share in self._direction)
            stage.world.push(self._name, (x, y, z))

    def _describe(self, block: str) -> None:
        self.sentence = (
            f"{block} is pushed with {self._force:g} N {along(self._direction)} for "
            f"{self.seconds:g} s"
        )
