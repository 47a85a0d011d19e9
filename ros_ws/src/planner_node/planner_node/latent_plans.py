# SPDX-License-Identifier: Apache-2.0
"""Plans from pictures alone (Chapter 4): codes of both, and a search on a learnt action model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move

from .action_models.learnt import LearntModel
from .search.on_models import both_ends_on

#: Pictures (n, 128, 128, 3) to packed codes (n, b), and which are valid: the state encoder G.
Read = Callable[[NDArray[np.uint8]], tuple[NDArray[np.uint8], NDArray[np.bool_]]]

#: States that a search may find; 5 blocks have 2,520.
MAX_STATES: Final = 6000


class StrangePictureError(Exception):
    """A picture that shows what the state encoder does not know; whether that is the goal's."""

    def __init__(self, is_goal: bool) -> None:
        super().__init__(
            f"the {'goal image' if is_goal else 'picture of the camera'} shows something that the "
            "state encoder was not trained on: other blocks, another camera, or something before "
            "them"
        )
        self.is_goal = is_goal


@dataclass(frozen=True)
class LatentPlan:
    """Moves that lead from one picture to another.

    Attributes:
        moves: a shortest sequence, as the action model has it.
        codes: of the states before, between and after them.
        confidence: share of these states that prediction forward from the start and backward from
            the goal agree on.
        expanded: number of states that the action model was asked about.
    """

    moves: tuple[Move, ...]
    codes: tuple[bytes, ...]
    confidence: float
    expanded: int


class LatentPlanner:
    """Finds moves between two pictures of the same blocks; no name of a block is known to it."""

    def __init__(self, read: Read, model: LearntModel) -> None:
        self._read, self._model = read, model

    def plan(self, now: NDArray[np.uint8], goal: NDArray[np.uint8]) -> LatentPlan:
        """Moves from what one picture shows to what the other one does, each (128, 128, 3).

        Raises:
            StrangePictureError: a picture shows nothing that is known.
            NoModelPlanError: the model knows no way, as when the pictures show other blocks than
                each other.
        """
        codes, valid = self._read(np.stack([now, goal]))
        if not valid.all():
            raise StrangePictureError(is_goal=bool(valid[0]))
        found = both_ends_on(self._model, codes[0].tobytes(), codes[1].tobytes(), MAX_STATES)
        return LatentPlan(
            found.moves, found.states, self._agreement(codes, found.moves), found.expanded
        )

    def _agreement(self, codes: NDArray[np.uint8], moves: tuple[Move, ...]) -> float:
        forward = self._model.rolled_out(codes[0], moves)
        undone = tuple(Move(move.target, move.source) for move in reversed(moves))
        backward = self._model.rolled_out(codes[1], undone)[::-1]
        same = [bool((one == other).all()) for one, other in zip(forward, backward)]
        return sum(same) / len(same)
