# SPDX-License-Identifier: Apache-2.0
"""The oracular action model M1 of 4.2.2: it has observed every transition there is."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from typing import Generic, TypeVar

import numpy as np

from scene_graph import Move

State = TypeVar("State", bound=Hashable)


class AmbiguousTransitionError(ValueError):
    """One move in one state was seen to lead to two states: states share a code."""


class ObservedModel(Generic[State]):
    """An :class:`.interface.ActionModel` that knows what it has seen, and nothing else.

    Args:
        transitions: state, move and state after it.

    Raises:
        AmbiguousTransitionError: see there.
    """

    def __init__(self, transitions: Iterable[tuple[State, Move, State]]) -> None:
        table: dict[State, dict[Move, State]] = {}
        for before, move, after in transitions:
            seen = table.setdefault(before, {}).setdefault(move, after)
            if seen != after:
                raise AmbiguousTransitionError(
                    f"the move {move} was observed to lead from one code to two others; some "
                    "states share a code, so that no action model of codes can be right"
                )
        self._table = {state: sorted(moves.items()) for state, moves in table.items()}

    def successors(self, states: Sequence[State]) -> list[list[tuple[Move, State]]]:
        """See :class:`.interface.ActionModel`; a state never seen has none."""
        return [self._table.get(state, []) for state in states]

    def nearest(self: ObservedModel[bytes], code: bytes) -> bytes:
        """The observed state that a packed code stands for: itself, else the one most like it.

        One part of a picture that was read wrong makes a code of no state, but two states differ
        in two parts at least: where a block was, and where it is. A code that was not snapped
        tells best which one is meant. Where two states are equally near, or none was observed,
        the code is returned as it is.
        """
        if code in self._table or not self._table:
            return code
        states = list(self._table)
        known = np.frombuffer(b"".join(states), np.uint8).reshape(len(states), -1)
        differ = np.bitwise_count(known ^ np.frombuffer(code, np.uint8)).sum(axis=1)
        best = np.flatnonzero(differ == differ.min())
        return states[best[0]] if len(best) == 1 else code
