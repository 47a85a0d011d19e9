# SPDX-License-Identifier: Apache-2.0
"""The path problem of 5.1 undivided: all phases at once, and the switches free.

Path costs and clearances move the switches here, as far as the hand's pose there leaves it open.
Steps may be dropped, with what is asked of them: the cost is then the least that it can be through
those that are kept, and the problem a lower bound of the whole one (3.4). P2 is such a bound.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..nlp import Attached, Demand, KOrderProblem, Solution, SolverFactory
from ..robots.model import ArmModel
from .costs import least_through, path_costs
from .groups import Group

Array = NDArray[np.float64]


class JointProblem:
    """Built for a number of phases, the last of which ends at the arm's home.

    Args:
        along: what acts along paths, by its steps of a phase.
        at_switches: what acts at switches.
        acceleration: acceleration limits, shape (n,) [rad/s²]; they weigh the joints.
        intervals: of a phase.
        kept: those of its steps 1 to ``intervals`` - 1 that are not dropped.

    Attributes:
        steps: those that are kept, the first and the last of phases among them, counted over all.
    """

    def __init__(
        self,
        model: ArmModel,
        along: Sequence[tuple[tuple[float, ...], Group]],
        at_switches: Sequence[Group],
        acceleration: Array,
        solver: SolverFactory,
        phases: int,
        intervals: int,
        kept: Sequence[int],
    ) -> None:
        self._model = model
        whole = range(phases * intervals + 1)
        self.steps = [s for s in whole if s % intervals == 0 or s % intervals in kept]
        costs = path_costs(phases, intervals, acceleration)
        if len(self.steps) < len(whole):
            costs = least_through(costs, self.steps)
        # A half step is kept with both steps that it lies between.
        near = {0, *kept, intervals}
        self._chosen = [
            [i for i, s in enumerate(own) if {int(np.floor(s)), int(np.ceil(s))} <= near]
            for own, _ in along
        ]
        place = {step: index for index, step in enumerate(self.steps)}

        def placed(step: float) -> float:
            return (place[int(np.floor(step))] + place[int(np.ceil(step))]) / 2

        attached = [
            Attached(
                group.rows,
                tuple(placed(k * intervals + own[i]) for k in range(phases) for i in chosen),
            )
            for (own, group), chosen in zip(along, self._chosen)
        ]
        self.switches = [place[k * intervals] for k in range(1, phases)]
        attached += [Attached(group.rows, tuple(self.switches)) for group in at_switches]
        self._problem = KOrderProblem(
            model.dimension,
            len(self.steps),
            fixed=(0, len(self.steps) - 1),
            costs=costs,
            attached=attached,
            solver=solver,
        )

    def solve(
        self,
        x: Array,
        along: Sequence[Sequence[Demand]],
        at_switches: Sequence[Demand],
        thorough: bool = True,
    ) -> Solution:
        """From a starting point.

        Args:
            x: configurations at ``steps``, (steps, n) [rad]; the first and the last one are given.
            along: of each phase, what is asked of all its steps, of each group.
            at_switches: what is asked at the switches, of each group.
            thorough: see :meth:`KOrderProblem.solve`.
        """
        demands = [
            Demand.after_one_another([own[index].at(chosen) for own in along])
            for index, chosen in enumerate(self._chosen)
        ]
        # Where the measured start is a little outside its limits, it may come back in its own time.
        lower, upper = np.minimum(self._model.lower, x[0]), np.maximum(self._model.upper, x[0])
        return self._problem.solve(x, [*demands, *at_switches], lower, upper, thorough)

    def cost(self, x: Array) -> float:
        """Of configurations (steps, n) [rad], whether they keep to the constraints or not."""
        return self._problem.cost(x)
