# SPDX-License-Identifier: Apache-2.0
"""A* on codes: what is left is bounded by the bits that differ from the goal."""

from __future__ import annotations

from ..action_models.interface import ActionModel
from .on_models import DEFAULT_MAX_STATES, ModelPlan, a_star_on


class CodeDistanceAStar:
    """A search on codes, given as bytes, that asks first where fewer bits differ from the goal.

    Args:
        most: bits that one move changes at most, as observed. A plan is a shortest one where no
            move changes more.
    """

    def __init__(self, most: int) -> None:
        if most < 1:
            raise ValueError(f"a move changes {most} bits at most? It changes one or more")
        self._most = most

    def __call__(
        self,
        model: ActionModel[bytes],
        start: bytes,
        goal: bytes,
        max_states: int = DEFAULT_MAX_STATES,
    ) -> ModelPlan[bytes]:
        """See :func:`.on_models.a_star_on`."""
        wanted, most = int.from_bytes(goal, "big"), self._most

        def moves_left(state: bytes) -> int:
            differing = (int.from_bytes(state, "big") ^ wanted).bit_count()
            return -(-differing // most)

        return a_star_on(model, start, goal, max_states, moves_left)
