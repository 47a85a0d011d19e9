# SPDX-License-Identifier: Apache-2.0
"""What a search asks of an action model; on what kind of states it works is no matter to it."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Protocol, TypeVar

from scene_graph import Move

State = TypeVar("State", bound=Hashable)


class ActionModel(Protocol[State]):
    """M: which moves are possible in a state, and the state that each leads to (4.1, A.2.3).

    States are anything that can be compared and hashed: stacks of names, or codes of a picture.
    """

    def successors(self, states: Sequence[State]) -> list[list[tuple[Move, State]]]:
        """For each state the possible moves, in their order, with the state after each.

        It is asked about many states at once, since networks answer for many as fast as for few.
        """
        ...
