# SPDX-License-Identifier: Apache-2.0
"""The bound P3: the full path through all phases (5.1), as k-order problems with k = 2.

The path problem is one problem over all phases: squared accelerations are minimised subject to
switch constraints h_switch and path constraints g_path. Because the velocity is zero at every
switch and P2 has fixed the configurations there, no term of the sum reaches across a switch, and
the problem falls apart into one problem a phase without loss. All phases share one structure, so
it is built once, whatever the number of moves; ``phases`` > 1 builds the undivided problem.

Each phase has ``steps`` intervals. The hand moves vertically during the first and the last
``vertical`` of them, which makes it come from above and leave upwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import PATH, InfeasibleError
from .features import Features
from .inverse_kinematics import InverseKinematics
from .k_order import Attached, Bounds, DifferenceCost, KOrderProblem, Solution
from .keyframes import Clearances
from .phase_bounds import PathSettings, PhaseBounds
from .phases import Phase

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PhasePath:
    """A solved phase.

    Attributes:
        phase: what it is about.
        q: configurations at equal steps, first and last included, shape (steps + 1, n) [rad].
    """

    phase: Phase
    q: Array


class PathProblem:
    """Solves P3 phase by phase for one arm and number of stacks.

    Args:
        lower, upper: joint limits, shape (n,) [rad].
        acceleration: acceleration limits, shape (n,) [rad/s²]; they weigh the joints.
        phases: number of phases solved at once, between given switches.
    """

    def __init__(
        self,
        features: Features,
        inverse: InverseKinematics,
        lower: Array,
        upper: Array,
        acceleration: Array,
        settings: PathSettings,
        phases: int = 1,
    ) -> None:
        self.features, self.inverse, self.settings = features, inverse, settings
        self.lower, self.upper = lower, upper
        n, intervals, ends = features.dimension, settings.steps, settings.vertical
        steps = phases * intervals + 1
        fixed = [k * intervals for k in range(phases + 1)]
        accelerations = np.zeros((phases * (intervals + 1), steps))
        for k in range(phases):
            # At rest at both ends, by central differences: x_{-1} = x_1 and x_{T+1} = x_{T-1},
            # which stand for the prefix of 3.4.
            index = intervals - np.abs(intervals - np.abs(np.arange(-1, intervals + 2)))
            index += k * intervals
            for row in range(intervals + 1):
                for offset, factor in enumerate((1.0, -2.0, 1.0)):
                    accelerations[k * (intervals + 1) + row, index[row + offset]] += factor
        velocities = np.eye(steps)[1:] - np.eye(steps)[:-1]
        weights = (np.median(acceleration) / acceleration) ** 2 * intervals**3 / 10.0
        inner = tuple(step for step in range(steps) if step not in fixed)
        edge = tuple(
            k * intervals + step
            for k in range(phases)
            for step in (*range(1, ends + 1), *range(intervals - ends, intervals))
        )
        self._inner, self._edge = np.array(inner), np.array(edge)
        self._problem = KOrderProblem(
            n,
            steps,
            fixed=fixed,
            costs=[
                DifferenceCost(accelerations, weights),
                DifferenceCost(velocities, np.full(n, 0.01 * intervals)),
            ],
            attached=[Attached(features.path, inner), Attached(features.switch, edge)],
        )

    def solve(
        self, phases: Sequence[Phase], configurations: Sequence[Array], clear: Clearances
    ) -> list[PhasePath]:
        """P3 for consecutive phases between given configurations at rest.

        Args:
            phases: as many as the problem was built for.
            configurations: at their ends, one more than phases, each of shape (n,) [rad].

        Raises:
            InfeasibleError: with bound ``path``, naming the constraint that is violated most.
        """
        plans = [
            PhaseBounds(self.features, self.settings, phase, start, goal, clear)
            for phase, start, goal in zip(phases, configurations, configurations[1:])
        ]
        pairs = [plan.bounds() for plan in plans]
        bounds = [
            Bounds(
                np.vstack([item.parameters for item in column]),
                np.vstack([item.lower for item in column]),
                np.vstack([item.upper for item in column]),
            )
            for column in zip(*pairs)
        ]
        # Where the measured start is a little outside its limits, it may come back in its own time.
        lower = np.minimum(self.lower, configurations[0])
        upper = np.maximum(self.upper, configurations[0])
        attempts = []
        for higher, inwards in ((0.0, 0.0), (0.08, 0.0), (0.04, 0.12), (0.15, 0.25)):
            guesses = [plan.guess(self.inverse, higher, inwards) for plan in plans]
            x = np.vstack([guesses[0], *[guess[1:] for guess in guesses[1:]]])
            solution = self._problem.solve(x, bounds, lower, upper)
            if solution.feasible:
                ends = range(0, len(x), self.settings.steps)
                return [
                    PhasePath(phase, solution.x[a : b + 1])
                    for phase, a, b in zip(phases, ends, ends[1:])
                ]
            attempts.append(solution)
        raise self._error(phases, min(attempts, key=lambda item: item.violation))

    def _error(self, phases: Sequence[Phase], solution: Solution) -> InfeasibleError:
        path, switch = solution.violations
        if path.max() >= switch.max():
            step, row = np.unravel_index(int(path.argmax()), path.shape)
            phase = phases[int(step) // (self.settings.steps - 1)]
            constraint = self.features.path_names(phase.tool)[int(row)]
        else:
            step, row = np.unravel_index(int(switch.argmax()), switch.shape)
            phase = phases[int(step) // (2 * self.settings.vertical)]
            names = ("vertical line", "vertical line", "direction of the fingers", "lift")
            constraint = names[int(row)]
        return InfeasibleError(
            PATH,
            constraint,
            object_name=phase.object_name,
            violation=solution.violation,
            move=phase.move,
            phase=phase.kind,
        )
