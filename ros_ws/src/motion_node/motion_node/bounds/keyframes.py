# SPDX-License-Identifier: Apache-2.0
"""The bound P2 of 3.4: the switches of the whole sequence together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..constraints import Clearances
from ..errors import KEYFRAMES, InfeasibleError
from ..phases import Phase
from ..robots.inverse_kinematics import InverseKinematics
from .pose import Poses
from .pose_among_obstacles import PosesAmongObstacles
from .switches import SwitchProblems

Array = NDArray[np.float64]


class Keyframes:
    """Solves P1 for each switch, then P2 from there.

    Attributes:
        poses, among: P1 as it is solved without obstacles, and among them.
    """

    def __init__(self, problems: SwitchProblems, inverse: InverseKinematics) -> None:
        self.problems = problems
        self.poses = Poses(problems, inverse)
        self.among = PosesAmongObstacles(problems, inverse)

    def solve(
        self, start: Array, phases: Sequence[Phase], clear: Clearances, sampled: bool = False
    ) -> Array:
        """Configurations at the switches of all phases but the way home, shape (k, n) [rad].

        Args:
            start: configuration before the first phase, shape (n,) [rad].
            phases: those that end with a switch.
            sampled: whether P1 is refused as quickly as among obstacles, where there is a choice
                of grasps to go on with.

        Raises:
            InfeasibleError: with bound ``pose`` where one switch alone has no solution, else with
                ``keyframes``.
        """
        if not phases:
            return np.zeros((0, self.problems.model.dimension))
        demands = self.problems.demands(phases, clear)
        if sampled:
            poses = self.among.solve_all(phases, clear)
            solution = self.problems.solve(start, poses, demands, thorough=False)
            # No constraint reaches from switch to switch: the poses are a solution, too.
            return solution.x[1:-1] if solution.feasible else np.array(poses)
        try:
            poses = self.poses.solve(phases, demands)
        except InfeasibleError as error:
            for phase in phases:
                if (phase.move, phase.kind) == (error.move, error.phase):
                    raise self.among.verdict(phase, clear) from error
            raise
        solution = self.problems.solve(start, poses, demands)
        if solution.feasible:
            return solution.x[1:-1]
        raise self.problems.error(KEYFRAMES, solution, phases)
