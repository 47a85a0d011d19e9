# SPDX-License-Identifier: Apache-2.0
"""What a constraint is: a part of g and h of equation 3.4 that knows all about its rows."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..nlp import Demand, Rows
from ..phases import Phase
from ..robots.model import ArmModel
from ..settings import PathSettings
from .situation import AlongPath, AtSwitch

Array = NDArray[np.float64]

#: By how much a row may be worse than at a start that violates it [m or rad].
START_SLACK = 1e-3


class Constraint(ABC):
    """Rows of one configuration: what they are, what is asked of them and when, their names.

    A subclass gives ``expression`` and what is asked of it; derivatives follow. Instances hold no
    state: one serves for all plans.

    Attributes:
        name: letters, digits and single underscores.
        at_switches: whether it acts at switches (P1 and P2).
        of_the_hand: whether it is about the hand's pose only, which inverse kinematics sees to:
            starting points at switches are not compared by it.
    """

    name: str
    at_switches: bool = True
    of_the_hand: bool = False

    def parameter_count(self, stacks: int) -> int:
        """How many numbers the rows depend on besides q."""
        return 0

    @abstractmethod
    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """The rows, a column of symbols.

        Args:
            model: has the symbols q and the poses of the links there.
            parameters: symbols, shape (parameter_count, 1).
            stacks: number of stacks.
        """

    @abstractmethod
    def row_names(self, phase: Phase) -> Sequence[str]:
        """Each row in words that say what is wrong if it is violated in a phase."""

    def at_switch(self, moment: AtSwitch) -> Demand:
        """What is asked at the switch of a phase, as one step, if it acts ``at_switches``."""
        raise NotImplementedError(f"{self.name} acts at switches, but asks nothing of them")

    def along_path(self, way: AlongPath) -> Demand:
        """What is asked at each of ``path_steps``; infinite bounds where nothing is."""
        raise NotImplementedError(f"{self.name} acts along paths, but asks nothing of them")

    def path_steps(self, shape: PathSettings) -> tuple[float, ...]:
        """Steps of a phase at which it acts in P3, of 1 to ``shape.steps`` - 1; all of them.

        Half a step is half way between two of them.
        """
        return tuple(range(1, shape.steps))

    def relaxed(self, demand: Demand, at_start: Array, way: AlongPath) -> Demand:
        """What is asked of a path from anywhere, a start that violates it included.

        Rows may be as bad as at the start while the hand moves away from it; they may not get
        worse.

        Args:
            demand: what ``along_path`` asks.
            at_start: the rows at the start, shape (rows,).
        """
        lower, upper = demand.lower.copy(), demand.upper.copy()
        leaving = slice(0, way.shape.vertical)
        lower[leaving] = np.minimum(lower[leaving], at_start - START_SLACK)
        upper[leaving] = np.maximum(upper[leaving], at_start + START_SLACK)
        return Demand(demand.parameters, lower, upper)

    def rows(self, model: ArmModel, stacks: int) -> Rows:
        """Its rows for an arm and a number of stacks."""
        parameters = ca.SX.sym("parameters", self.parameter_count(stacks))
        return Rows(self.name, model.q, parameters, self.expression(model, parameters, stacks))
