# SPDX-License-Identifier: Apache-2.0
"""The hand with what it holds keeps its distance to the table, but where it is to touch it."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from ..nlp import Demand
from ..phases import Phase
from ..robots import Arm
from ..robots.model import ArmModel
from .constraint import Constraint
from .hand_clearance import hand_in_words
from .hulls import HAND_SIZE, HandBox, hand_parameters
from .situation import AlongPath


class TableClearance(Constraint):
    """Row: height of the hand's lowest point above the table less the margin [m].

    Parameters: the hand's box, least height.
    """

    name = "table_clearance"
    #: What stands on the table touches it.
    at_switches = False

    def __init__(self, arm: Arm) -> None:
        self._arm = arm

    def parameter_count(self, stacks: int) -> int:
        """See :class:`Constraint`."""
        return HAND_SIZE + 1

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """See the class."""
        return HandBox(model, parameters[:HAND_SIZE]).height() - parameters[HAND_SIZE]

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        return (f"clearance of {hand_in_words(phase)} to the table",)

    def along_path(self, way: AlongPath) -> Demand:
        """Above it between the vertical ends."""
        lower = np.zeros((way.steps, 1))
        for _, here in way.vertical:
            lower[here] = -np.inf
        box = hand_parameters(self._arm.gripper, way.phase.tool)
        parameters = np.repeat([[*box, way.clear.floor + way.clear.margin]], way.steps, axis=0)
        return Demand(parameters, lower, np.full_like(lower, np.inf))
