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

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ..constraints import AlongPath, Clearances, Constraint
from ..errors import PATH, InfeasibleError
from ..nlp import Attached, Demand, DifferenceCost, KOrderProblem, Solution, SolverFactory
from ..obstacles import Obstacle
from ..phases import Phase, PhasePath
from ..robots.inverse_kinematics import InverseKinematics
from ..robots.model import ArmModel
from ..settings import PathSettings
from .groups import grouped
from .way import Way, guesses

Array = NDArray[np.float64]

#: Starting points in the order in which they are tried: how much higher than needed to pass over
#: the stacks [m], and the share by which the way across is drawn towards the arm's base.
_TRIES = ((0.0, 0.0), (0.08, 0.0), (0.04, 0.12), (0.15, 0.25))
#: So many ways round obstacles are tried; the straight one before them, if it misses what is asked
#: by no more than this [m].
_ROUND = 3
_HOPEFUL = 0.05


class PathProblem:
    """Solves P3 phase by phase for one arm and number of stacks.

    Args:
        acceleration: acceleration limits, shape (n,) [rad/s²]; they weigh the joints.
        phases: number of phases solved at once, between given switches.
        obstacles: around which starting points lead.

    Attributes:
        obstacles: may be changed.
    """

    def __init__(
        self,
        model: ArmModel,
        stacks: int,
        constraints: Sequence[Constraint],
        inverse: InverseKinematics,
        acceleration: Array,
        settings: PathSettings,
        solver: SolverFactory,
        phases: int = 1,
        obstacles: Sequence[Obstacle] = (),
        joint: bool = False,
    ) -> None:
        self._model, self._inverse, self._settings = model, inverse, settings
        self.obstacles = tuple(obstacles)
        intervals = settings.steps
        weights = (np.median(acceleration) / acceleration) ** 2 * intervals**3 / 10.0
        steps = phases * intervals + 1
        velocities = np.eye(steps)[1:] - np.eye(steps)[:-1]
        own_steps = [constraint.path_steps(settings) for constraint in constraints]
        self._groups = grouped(own_steps, constraints, model, stacks)
        switches = [k * intervals for k in range(1, phases)] if joint else []
        acting = [constraint for constraint in constraints if constraint.at_switches]
        self._at_switches = (
            grouped([(0,)] * len(acting), acting, model, stacks, "switches") if switches else []
        )
        self._problem = KOrderProblem(
            model.dimension,
            steps,
            fixed=[k * intervals for k in range(phases + 1) if k * intervals not in switches],
            costs=[
                DifferenceCost(_accelerations(phases, intervals), weights),
                DifferenceCost(velocities, np.full(model.dimension, 3.0 * intervals)),
            ],
            attached=[
                Attached(group.rows, tuple(k * intervals + s for k in range(phases) for s in own))
                for own, group in self._groups
            ]
            + [Attached(group.rows, tuple(switches)) for _, group in self._at_switches],
            solver=solver,
        )

    def guesses(
        self, phases: Sequence[Phase], configurations: Sequence[Array], clear: Clearances
    ) -> list[Array]:
        """The first starting point of each of any number of phases, as for :meth:`solve`."""
        ways = self._ways(phases, configurations, clear)
        return guesses(ways, self._inverse, *_TRIES[0])

    def _ways(
        self,
        phases: Sequence[Phase],
        configurations: Sequence[Array],
        clear: Clearances,
        moving: bool = False,
    ) -> list[Way]:
        return [
            Way(self._model, self._settings, phase, start, goal, clear, moving)
            for phase, start, goal in zip(phases, configurations, configurations[1:])
        ]

    def solve(
        self,
        phases: Sequence[Phase],
        configurations: Sequence[Array],
        clear: Clearances,
        first: Sequence[Array] = (),
        second: Array | None = None,
    ) -> list[PhasePath]:
        """P3 for consecutive phases between given configurations at rest.

        Args:
            phases: as many as the problem was built for.
            configurations: at their ends, one more than phases, each of shape (n,) [rad].
            first: what ``guesses`` found, if it was asked.
            second: the configuration after the first one, shape (n,) [rad], where the arm moves
                already: both are the prefix of 3.4; None: it is at rest.

        Raises:
            InfeasibleError: with bound ``path``, naming the constraint that is violated most.
        """
        settings = self._settings
        ways = self._ways(phases, configurations, clear, moving=second is not None)
        demands = self._demands(ways)
        lower, upper = self._limits(configurations)
        if second is not None:
            shape = (len(phases) * settings.steps + 1, 1)
            lower, upper = np.tile(lower, shape), np.tile(upper, shape)
            lower[1] = upper[1] = second
        attempts: list[Solution] = []
        for x, thorough in self._starts(ways, demands, first):
            solution = self._problem.solve(x, demands, lower, upper, thorough)
            if solution.feasible:
                ends = range(0, len(x), settings.steps)
                return [
                    PhasePath(phase, solution.x[a : b + 1])
                    for phase, a, b in zip(phases, ends, ends[1:])
                ]
            attempts.append(solution)
        raise self._error(phases, min(attempts, key=lambda item: item.violation))

    def along(self, phase: Phase, ends: Sequence[Array], clear: Clearances) -> AlongPath:
        """What constraints are told of one phase between its first and last configuration."""
        return self._ways([phase], [ends[0], ends[-1]], clear)[0].along

    def demands(self, phase: Phase, ends: Sequence[Array], clear: Clearances) -> list[Demand]:
        """What is asked of one phase between two configurations."""
        return self._demands(self._ways([phase], ends, clear))

    def _demands(self, ways: Sequence[Way]) -> list[Demand]:
        return [
            Demand.after_one_another([group.along_path(way.along, way.start_q) for way in ways])
            for _, group in self._groups
        ]

    def _limits(self, configurations: Sequence[Array]) -> tuple[Array, Array]:
        # Where the measured start is a little outside its limits, it may come back in its own time.
        model = self._model
        return np.minimum(model.lower, configurations[0]), np.maximum(
            model.upper, configurations[0]
        )

    def straight_starts(
        self, phase: Phase, ends: Sequence[Array], clear: Clearances
    ) -> Iterator[Array]:
        """Starting points over the stacks, whatever else stands around."""
        ways = self._ways([phase], ends, clear)
        for attempt in _TRIES:
            yield guesses(ways, self._inverse, *attempt)[0]

    def missed(self, x: Array, demands: Sequence[Demand], phase: Phase) -> list[str]:
        """What a path (steps + 1, n) misses, each row in words."""
        found = []
        for (_, group), missed in zip(self._groups, self._excess(x, demands)):
            found += group.missed(missed, phase)
        return found

    def least_changes(
        self,
        start: Array,
        demands: Sequence[Demand],
        unit: float,
        changed: Sequence[Sequence[Demand]],
        reach: tuple[Array, Array],
    ) -> Array | None:
        """What has to change least for one phase to have a path near a starting point.

        See :meth:`KOrderProblem.least_changes`.
        """
        limits = self._limits([start[0]])
        return self._problem.least_changes(start, demands, unit, changed, reach, limits)

    def _starts(
        self, ways: Sequence[Way], demands: Sequence[Demand], first: Sequence[Array]
    ) -> Iterator[tuple[Array, bool]]:
        """Starting points in the order in which they are tried, and how thoroughly."""
        straight = _joined(first or guesses(ways, self._inverse, *_TRIES[0]))
        if not self.obstacles:
            yield straight, True
            for attempt in _TRIES[1:]:
                yield _joined(guesses(ways, self._inverse, *attempt)), True
            return
        hopeful = self._missed(straight, demands) < _HOPEFUL
        if hopeful:
            yield straight, False
        around = [way.guesses_round(self._inverse, self.obstacles, _ROUND) for way in ways]
        for found in zip(*around):
            yield _joined(found), False
        if not hopeful:
            yield straight, False
        for attempt in _TRIES[1:]:
            yield _joined(guesses(ways, self._inverse, *attempt)), False

    def _missed(self, x: Array, demands: Sequence[Demand]) -> float:
        """By how much a starting point misses what is asked most [m or rad]."""
        return max((float(m.max(initial=0.0)) for m in self._excess(x, demands)), default=0.0)

    def _excess(self, x: Array, demands: Sequence[Demand]) -> Iterator[Array]:
        for (steps, group), demand in zip(self._groups, demands):
            at = [k + s for k in range(0, len(x) - 1, self._settings.steps) for s in steps]
            q = (x[np.floor(at).astype(int)] + x[np.ceil(at).astype(int)]) / 2
            values = np.array(group.rows.value(q.T, demand.parameters.T)).T
            yield demand.excess(values)

    def _error(self, phases: Sequence[Phase], solution: Solution) -> InfeasibleError:
        found = [
            (group.worst(own), len(steps))
            for (steps, group), own in zip(self._groups, solution.violations)
        ]
        worst, steps_a_phase = max(found, key=lambda item: item[0].amount)
        return worst.error(PATH, phases[worst.step // steps_a_phase])


def _joined(parts: Sequence[Array]) -> Array:
    """The starting points of phases as one."""
    return np.vstack([parts[0], *[part[1:] for part in parts[1:]]])


def _accelerations(phases: int, intervals: int) -> Array:
    """Second differences over the steps of phases, each at rest at both ends.

    By central differences: x_{-1} = x_1 and x_{T+1} = x_{T-1}, which stand for the prefix of 3.4.
    """
    result = np.zeros((phases * (intervals + 1), phases * intervals + 1))
    for k in range(phases):
        index = intervals - np.abs(intervals - np.abs(np.arange(-1, intervals + 2)))
        index += k * intervals
        for row in range(intervals + 1):
            for offset, factor in enumerate((1.0, -2.0, 1.0)):
                result[k * (intervals + 1) + row, index[row + offset]] += factor
    return result
