# SPDX-License-Identifier: Apache-2.0
"""The bound P2 of 3.4: the switches of the whole sequence together.

It is the joint problem of which nothing is kept but the switches and the upper ends of the vertical
lines beside them: a path that has to rise first is not the straight one, and its ends are best
elsewhere than those of the straight one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..constraints import Clearances
from ..errors import InfeasibleError
from ..nlp import Demand
from ..phases import HOME, Phase
from ..robots.inverse_kinematics import InverseKinematics
from ..settings import PathSettings
from .joint import JointProblem
from .path import PathProblem
from .pose import Poses
from .pose_among_obstacles import PosesAmongObstacles
from .switches import SwitchProblems
from .way import Way

Array = NDArray[np.float64]


class Keyframes:
    """Solves P1 for each switch, then P2 from there.

    Args:
        path: what is asked of ways.
        make: makes the joint problem of a number of phases of which some steps are kept.

    Attributes:
        poses, among: P1 as it is solved without obstacles, and among them.
    """

    def __init__(
        self,
        problems: SwitchProblems,
        inverse: InverseKinematics,
        path: PathProblem,
        make: Callable[[int, Sequence[int]], JointProblem],
        shape: PathSettings,
    ) -> None:
        self.problems = problems
        self.poses = Poses(problems, inverse)
        self.among = PosesAmongObstacles(problems, inverse)
        self._inverse, self._path, self._make, self._shape = inverse, path, make, shape
        self._problems: dict[int, JointProblem] = {}

    def problem(self, phases: int) -> JointProblem:
        """P2 for a number of phases, built once."""
        if phases not in self._problems:
            near = self._shape.vertical
            self._problems[phases] = self._make(phases, (near, self._shape.steps - near))
        return self._problems[phases]

    def solve(
        self, start: Array, phases: Sequence[Phase], clear: Clearances, sampled: bool = False
    ) -> list[Way]:
        """The way of each phase between the switches that were found.

        Args:
            start: configuration before the first phase, shape (n,) [rad].
            phases: the last one leads home, and no other.
            sampled: whether P1 is refused as quickly as among obstacles, where there is a choice
                of grasps to go on with.

        Raises:
            InfeasibleError: with bound ``pose``, where one switch alone has no solution.
        """
        switching = [phase for phase in phases if phase.kind != HOME]
        home = self.problems.model.home
        if not switching:
            return self._path.ways(phases, [start, home], clear)
        demands = self.problems.demands(switching, clear)
        poses = self._solve_poses(switching, demands, clear, sampled)
        ways = self._path.ways(phases, [start, *poses, home], clear)
        problem = self.problem(len(phases))
        asked = [self._path.asked(way) for way in ways]
        solution = problem.solve(self._knots(ways), asked, demands, thorough=False)
        if not solution.feasible:
            # What P2 asks of switches does not reach from one to another: the poses do it, too.
            # Whether the rest can be done is for P3 to say.
            return ways
        found = [start, *(solution.x[index] for index in problem.switches), home]
        return [way.between(*ends) for way, *ends in zip(ways, found, found[1:])]

    def _solve_poses(
        self,
        phases: Sequence[Phase],
        demands: Sequence[Demand],
        clear: Clearances,
        sampled: bool,
    ) -> list[Array]:
        """P1."""
        if sampled:
            return self.among.solve_all(phases, clear)
        try:
            return self.poses.solve(phases, demands)
        except InfeasibleError as error:
            for phase in phases:
                if (phase.move, phase.kind) == (error.move, error.phase):
                    raise self.among.verdict(phase, clear) from error
            raise

    def _knots(self, ways: Sequence[Way]) -> Array:
        """A starting point of P2: the hand is lifted above each switch, turned as there."""
        near, points, places = [], [], []
        found = [ways[0].start_q]
        for way in ways:
            for end, q in ((way.along.first, way.start_q), (way.along.last, way.goal_q)):
                if end is not None:
                    places.append(len(found))
                    near.append(q)
                    points.append((*end.reference[:2], end.height + end.lift))
                found.append(q)
            found.append(way.goal_q)
        x = np.array(found)
        if places:
            x[places] = self._inverse.moved(np.array(near), np.array(points))
        return x
