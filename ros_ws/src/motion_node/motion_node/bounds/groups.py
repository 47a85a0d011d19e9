# SPDX-License-Identifier: Apache-2.0
"""Constraints that act at the same steps, joined, so that the bounds need not know them apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..constraints import AlongPath, AtSwitch, Constraint
from ..errors import InfeasibleError
from ..nlp import TOLERANCE, Demand, JoinedRows
from ..phases import Phase
from ..robots.model import ArmModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Violation:
    """The row that is violated most.

    Attributes:
        step: counted within the steps of the rows.
        amount: [m or rad].
    """

    constraint: Constraint
    row: int
    step: int
    amount: float

    def error(self, bound: str, phase: Phase) -> InfeasibleError:
        """A bound of a phase is infeasible because of it."""
        return InfeasibleError(
            bound,
            self.constraint.row_names(phase)[self.row],
            object_name=phase.object_name,
            violation=self.amount,
            move=phase.move,
            phase=phase.kind,
        )


class Group:
    """Constraints that act at the same steps.

    Args:
        constraints: at least one.
    """

    def __init__(
        self, name: str, constraints: Sequence[Constraint], model: ArmModel, stacks: int
    ) -> None:
        self.constraints = tuple(constraints)
        self._parts = [constraint.rows(model, stacks) for constraint in constraints]
        self._joined = JoinedRows(name, self._parts)
        self.rows = self._joined.rows
        #: Rows by which starting points at switches are compared, shape (rows,).
        self.compared = np.repeat(
            [not constraint.of_the_hand for constraint in constraints],
            [part.count for part in self._parts],
        )

    def at_switches(self, moments: Sequence[AtSwitch]) -> Demand:
        """What is asked at switches, one a step."""
        demands = [
            Demand.after_one_another([constraint.at_switch(moment) for moment in moments])
            for constraint in self.constraints
        ]
        return self._side_by_side(demands)

    def along_path(self, way: AlongPath, start_q: Array) -> Demand:
        """What is asked of a path that starts at a configuration (n,) [rad]."""
        demands = [constraint.along_path(way) for constraint in self.constraints]
        demand = self._side_by_side(demands)
        if way.phase.start is not None:
            return demand
        at_start = np.array(self.rows.value(start_q, demand.parameters[0])).ravel()
        parts = zip(self.constraints, demands, self._joined.split(at_start))
        return self._side_by_side([own.relaxed(asked, rows, way) for own, asked, rows in parts])

    def missed(self, violations: Array, phase: Phase) -> list[str]:
        """The rows in words that count as violated anywhere, of violations (steps, rows)."""
        found = []
        for constraint, share in zip(self.constraints, self._joined.split(violations)):
            names = constraint.row_names(phase)
            found += [names[int(row)] for row in np.flatnonzero(share.max(axis=0) > TOLERANCE)]
        return found

    def worst(self, violations: Array) -> Violation:
        """Of violations (steps, rows)."""
        shares = self._joined.split(violations)
        which = int(np.argmax([share.max(initial=-1.0) for share in shares]))
        share = shares[which]
        step, row = (int(i) for i in np.unravel_index(int(share.argmax()), share.shape))
        return Violation(self.constraints[which], row, step, float(share[step, row]))

    def _side_by_side(self, demands: Sequence[Demand]) -> Demand:
        """Raises ValueError if a constraint asks for other rows or parameters than it has."""
        for constraint, part, demand in zip(self.constraints, self._parts, demands):
            asked = {demand.lower.shape[1], demand.upper.shape[1]}
            given = demand.parameters.shape[1]
            if asked != {part.count} or given != part.parameter_count:
                raise ValueError(
                    f"{constraint.name} has {part.count} rows of {part.parameter_count} "
                    f"parameters, but asks for {sorted(asked)} rows and gives {given} parameters"
                )
        return Demand.side_by_side(demands)


def grouped(
    steps: Sequence[tuple[float, ...]],
    constraints: Sequence[Constraint],
    model: ArmModel,
    stacks: int,
) -> list[tuple[tuple[float, ...], Group]]:
    """Constraints by the steps at which they act, those without steps left out.

    Args:
        steps: of each constraint.
    """
    members: dict[tuple[float, ...], list[Constraint]] = {}
    for own, constraint in zip(steps, constraints):
        if own:
            members.setdefault(own, []).append(constraint)
    return [
        (own, Group(f"rows_{index}", group, model, stacks))
        for index, (own, group) in enumerate(members.items())
    ]
