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
from ..nlp import Attached, Demand, KOrderProblem, Solution, SolverFactory
from ..obstacles import Obstacle
from ..phases import Phase, PhasePath
from ..robots.inverse_kinematics import InverseKinematics
from ..robots.model import ArmModel
from ..settings import PathSettings
from .costs import joined, path_costs
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
        groups: what it keeps to, by the steps of a phase.
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
    ) -> None:
        self._model, self._inverse, self._settings = model, inverse, settings
        self.obstacles = tuple(obstacles)
        intervals = settings.steps
        own_steps = [constraint.path_steps(settings) for constraint in constraints]
        self.groups = grouped(own_steps, constraints, model, stacks)
        self._problem = KOrderProblem(
            model.dimension,
            phases * intervals + 1,
            fixed=[k * intervals for k in range(phases + 1)],
            costs=path_costs(phases, intervals, acceleration),
            attached=[
                Attached(group.rows, tuple(k * intervals + s for k in range(phases) for s in own))
                for own, group in self.groups
            ],
            solver=solver,
        )

    def guesses(self, ways: Sequence[Way]) -> list[Array]:
        """The first starting point of each of any number of ways, as for :meth:`solve_ways`."""
        return guesses(ways, self._inverse, *_TRIES[0])

    def ways(
        self,
        phases: Sequence[Phase],
        configurations: Sequence[Array],
        clear: Clearances,
        moving: bool = False,
    ) -> list[Way]:
        """Of consecutive phases between configurations at their ends, one more than phases."""
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
            first: starting points, where there are any better ones than ``guesses``.
            second: the configuration after the first one, shape (n,) [rad], where the arm moves
                already: both are the prefix of 3.4; None: it is at rest.

        Raises:
            InfeasibleError: with bound ``path``, naming the constraint that is violated most.
        """
        ways = self.ways(phases, configurations, clear, moving=second is not None)
        return self.solve_ways(ways, first, second)

    def solve_ways(
        self, ways: Sequence[Way], first: Sequence[Array] = (), second: Array | None = None
    ) -> list[PhasePath]:
        """As :meth:`solve`, where the ways are known."""
        settings, phases = self._settings, [way.phase for way in ways]
        demands = self._demands(ways)
        lower, upper = self._limits(ways[0].start_q)
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
        return self.ways([phase], [ends[0], ends[-1]], clear)[0].along

    def demands(self, phase: Phase, ends: Sequence[Array], clear: Clearances) -> list[Demand]:
        """What is asked of one phase between two configurations."""
        return self._demands(self.ways([phase], ends, clear))

    def _demands(self, ways: Sequence[Way]) -> list[Demand]:
        asked = [self.asked(way) for way in ways]
        return [Demand.after_one_another(own) for own in zip(*asked)]

    def asked(self, way: Way) -> list[Demand]:
        """What is asked of one way, of each group; worked out once."""
        if not way.asked:
            way.asked += [group.along_path(way.along, way.start_q) for _, group in self.groups]
        return way.asked

    def _limits(self, start_q: Array) -> tuple[Array, Array]:
        # Where the measured start is a little outside its limits, it may come back in its own time.
        model = self._model
        return np.minimum(model.lower, start_q), np.maximum(model.upper, start_q)

    def straight_starts(
        self, phase: Phase, ends: Sequence[Array], clear: Clearances
    ) -> Iterator[Array]:
        """Starting points over the stacks, whatever else stands around."""
        ways = self.ways([phase], ends, clear)
        for attempt in _TRIES:
            yield guesses(ways, self._inverse, *attempt)[0]

    def missed(self, x: Array, demands: Sequence[Demand], phase: Phase) -> list[str]:
        """What a path (steps + 1, n) misses, each row in words."""
        found = []
        for (_, group), missed in zip(self.groups, self._excess(x, demands)):
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
        limits = self._limits(start[0])
        return self._problem.least_changes(start, demands, unit, changed, reach, limits)

    def _starts(
        self, ways: Sequence[Way], demands: Sequence[Demand], first: Sequence[Array]
    ) -> Iterator[tuple[Array, bool]]:
        """Starting points in the order in which they are tried, and how thoroughly."""
        straight = joined(first or guesses(ways, self._inverse, *_TRIES[0]))
        if not self.obstacles:
            yield straight, True
            for attempt in _TRIES[1:]:
                yield joined(guesses(ways, self._inverse, *attempt)), True
            return
        hopeful = self._missed(straight, demands) < _HOPEFUL
        if hopeful:
            yield straight, False
        around = [way.guesses_round(self._inverse, self.obstacles, _ROUND) for way in ways]
        for found in zip(*around):
            yield joined(found), False
        if not hopeful:
            yield straight, False
        for attempt in _TRIES[1:]:
            yield joined(guesses(ways, self._inverse, *attempt)), False

    def _missed(self, x: Array, demands: Sequence[Demand]) -> float:
        """By how much a starting point misses what is asked most [m or rad]."""
        return max((float(m.max(initial=0.0)) for m in self._excess(x, demands)), default=0.0)

    def _excess(self, x: Array, demands: Sequence[Demand]) -> Iterator[Array]:
        for (steps, group), demand in zip(self.groups, demands):
            at = [k + s for k in range(0, len(x) - 1, self._settings.steps) for s in steps]
            q = (x[np.floor(at).astype(int)] + x[np.ceil(at).astype(int)]) / 2
            values = np.array(group.rows.value(q.T, demand.parameters.T)).T
            yield demand.excess(values)

    def _error(self, phases: Sequence[Phase], solution: Solution) -> InfeasibleError:
        found = [
            (group.worst(own), len(steps))
            for (steps, group), own in zip(self.groups, solution.violations)
        ]
        worst, steps_a_phase = max(found, key=lambda item: item[0].amount)
        return worst.error(PATH, phases[worst.step // steps_a_phase])
