# SPDX-License-Identifier: Apache-2.0
"""The hand points down at switches and along vertical lines, and leans little in between."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..nlp import Demand
from ..phases import Phase
from ..robots.model import ArmModel
from .constraint import START_SLACK, Constraint
from .situation import AlongPath, AtSwitch

Array = NDArray[np.float64]

#: A hand that leans more than this at its start takes half the way to come upright [rad].
SMALL_LEAN = 0.02


class Upright(Constraint):
    """Rows: lean of the hand along world x and y, sines of angles."""

    name = "upright"
    of_the_hand = True

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """x and y of the hand's z axis."""
        rotation, _ = model.hand_pose
        return rotation[:2, 2]

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        return ("tilt of the hand",) * 2

    def at_switch(self, moment: AtSwitch) -> Demand:
        """None."""
        return Demand.constant(1, (0.0, 0.0), (0.0, 0.0))

    def along_path(self, way: AlongPath) -> Demand:
        """None at the vertical ends, little in between."""
        most = np.full((way.steps, 2), way.shape.max_lean)
        for _, here in way.vertical:
            most[here] = 0.0
        return Demand(np.zeros((way.steps, 0)), -most, most)

    def relaxed(self, demand: Demand, at_start: Array, way: AlongPath) -> Demand:
        """As at the start while leaving it; up to half the way if it leans much there."""
        lean = float(np.abs(at_start).max()) + START_SLACK
        most = demand.upper.copy()
        if lean > SMALL_LEAN:
            most[: way.shape.steps // 2] = max(lean, way.shape.max_lean)
        else:
            leaving = slice(0, way.shape.vertical)
            most[leaving] = np.maximum(most[leaving], lean)
        return Demand(demand.parameters, -most, most)
