# SPDX-License-Identifier: Apache-2.0
"""Next to a switch the hand moves along a vertical line: it comes from above, leaves upwards."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..nlp import Demand
from ..phases import Phase
from ..robots.model import ArmModel
from ..settings import PathSettings
from .constraint import Constraint
from .situation import AlongPath, VerticalEnd
from .switch_pose import REFERENCE_SIZE, tool_on_line

Array = NDArray[np.float64]


class VerticalLine(Constraint):
    """Rows: see :func:`tool_on_line`. Parameters: the reference, the same for all of an end.

    The line has a least length: the step farthest from the switch is lifted.
    """

    name = "vertical_line"
    at_switches = False
    of_the_hand = True

    def parameter_count(self, stacks: int) -> int:
        """See :class:`Constraint`."""
        return REFERENCE_SIZE

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """See :func:`tool_on_line`."""
        return tool_on_line(model, parameters)

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        return ("vertical line", "vertical line", "direction of the fingers", "lift")

    def path_steps(self, shape: PathSettings) -> tuple[float, ...]:
        """The first and the last few."""
        last = shape.steps
        return (*range(1, shape.vertical + 1), *range(last - shape.vertical, last))

    def along_path(self, way: AlongPath) -> Demand:
        """On the line, not below the switch, and lifted at the line's upper end."""
        near = way.shape.vertical
        references = np.zeros((2 * near, REFERENCE_SIZE))
        lower = np.full((2 * near, 4), -np.inf)
        upper = np.full((2 * near, 4), np.inf)

        def ask(end: VerticalEnd | None, here: slice, top: int) -> None:
            if end is None:
                return
            references[here] = end.reference
            lower[here, :3] = upper[here, :3] = 0.0
            lower[here, 3] = end.height
            lower[top, 3] = end.height + end.lift

        ask(way.first, slice(0, near), near - 1)
        ask(way.last, slice(near, 2 * near), near)
        return Demand(references, lower, upper)

    def relaxed(self, demand: Demand, at_start: Array, way: AlongPath) -> Demand:
        """The same: the line begins at the start."""
        return demand
