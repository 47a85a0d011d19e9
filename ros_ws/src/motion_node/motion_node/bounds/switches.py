# SPDX-License-Identifier: Apache-2.0
"""The problems over the switches of phases alone: P1, and what corrections begin with.

They minimise the squared joint distances between consecutive switches. For a path from rest to rest
in a time T the least integral of squared accelerations is 12 |q_b - q_a|^2 / T^3, so this is the
value that P3 would have without its path constraints, were all joints of the same weight.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..constraints import AtSwitch, Clearances, Constraint
from ..errors import InfeasibleError
from ..nlp import Attached, Demand, DifferenceCost, KOrderProblem, Solution, SolverFactory
from ..phases import Phase
from ..robots.model import ArmModel
from .groups import Violation, grouped

Array = NDArray[np.float64]

#: Weight of the distance to the rest posture against the distance between keyframes.
POSTURE_WEIGHT = 0.02


class SwitchProblems:
    """One problem for each number of switches, each built once, for a number of stacks.

    Attributes:
        groups: what is asked at switches.
    """

    def __init__(
        self,
        model: ArmModel,
        stacks: int,
        constraints: Sequence[Constraint],
        solver: SolverFactory,
    ) -> None:
        self.model = model
        self._solver = solver
        acting = [constraint for constraint in constraints if constraint.at_switches]
        self.groups = [group for _, group in grouped([(0,)] * len(acting), acting, model, stacks)]
        self._problems: dict[int, KOrderProblem] = {}
        self._values: dict[int, list[ca.Function]] = {}

    def problem(self, count: int) -> KOrderProblem:
        """For ``count`` switches between a start and home; P1 if there is one."""
        if count not in self._problems:
            steps, n = count + 2, self.model.dimension
            differences = np.eye(steps)[1:] - np.eye(steps)[:-1]
            if count == 1:
                differences = differences[:0]
            posture = np.eye(steps) - np.eye(steps)[:, [-1]] @ np.ones((1, steps))
            free = tuple(range(1, count + 1))
            self._problems[count] = KOrderProblem(
                n,
                steps,
                fixed=(0, steps - 1),
                costs=[
                    DifferenceCost(differences, np.ones(n)),
                    DifferenceCost(posture[1:-1], POSTURE_WEIGHT * np.ones(n)),
                ],
                attached=[Attached(group.rows, free) for group in self.groups],
                solver=self._solver,
            )
        return self._problems[count]

    def demands(self, phases: Sequence[Phase], clear: Clearances) -> list[Demand]:
        """What is asked at the end of each phase."""
        moments = [AtSwitch(self.model.arm, phase, clear) for phase in phases]
        return [group.at_switches(moments) for group in self.groups]

    def solve(
        self,
        start: Array,
        guess: Sequence[Array],
        demands: Sequence[Demand],
        thorough: bool = True,
    ) -> Solution:
        """Configurations at switches between ``start`` (n,) and home, ``guess`` being near them.

        See :meth:`KOrderProblem.solve` for ``thorough``.
        """
        model = self.model
        x = np.vstack([start, *guess, model.home])
        return self.problem(len(guess)).solve(x, demands, model.lower, model.upper, thorough)

    def excess(self, q: Array, demands: Sequence[Demand]) -> Array:
        """By how much configurations (k, n) miss what k switches ask, summed over rows, (k,).

        The hand's pose is left out.
        """
        count, total = len(q), np.zeros(len(q))
        if count not in self._values:
            self._values[count] = [group.rows.value.map(count) for group in self.groups]
        for function, group, demand in zip(self._values[count], self.groups, demands):
            values = np.array(function(q.T, demand.parameters.T)).T
            total += demand.excess(values)[:, group.compared].sum(axis=1)
        return total

    def worst_but_the_hands_pose(self, q: Array, demands: Sequence[Demand]) -> Violation:
        """What a configuration (n,) with the right pose of the hand misses most.

        Args:
            demands: of one switch.
        """
        found = []
        for group, demand in zip(self.groups, demands):
            values = np.array(group.rows.value(q, demand.parameters[0])).reshape(1, -1)
            found.append(group.worst(np.where(group.compared, demand.excess(values), 0.0)))
        return max(found, key=lambda violation: violation.amount)

    def missed(self, q: Array, demands: Sequence[Demand], phase: Phase) -> list[str]:
        """What a configuration (n,) misses but for the hand's pose, each row in words.

        Args:
            demands: of the phase's switch.
        """
        found = []
        for group, demand in zip(self.groups, demands):
            values = np.array(group.rows.value(q, demand.parameters[0])).reshape(1, -1)
            missed = np.where(group.compared, demand.excess(values), 0.0)
            found += group.missed(missed, phase)
        return found

    def least_changes(
        self,
        guess: Array,
        demands: Sequence[Demand],
        unit: float,
        changed: Sequence[Sequence[Demand]],
        reach: tuple[Array, Array],
    ) -> Array | None:
        """What has to change least for one switch to have a configuration near a guess (n,).

        See :meth:`KOrderProblem.least_changes`.
        """
        model = self.model
        x = np.vstack([model.home, guess, model.home])
        limits = (model.lower, model.upper)
        return self.problem(1).least_changes(x, demands, unit, changed, reach, limits)

    def error(self, bound: str, solution: Solution, phases: Sequence[Phase]) -> InfeasibleError:
        """Names the constraint that a solution violates most."""
        found = [group.worst(own) for group, own in zip(self.groups, solution.violations)]
        worst = max(found, key=lambda violation: violation.amount)
        return worst.error(bound, phases[worst.step])
