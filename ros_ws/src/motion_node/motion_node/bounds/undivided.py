# SPDX-License-Identifier: Apache-2.0
"""The bound P3 undivided: what comes of letting path costs move the switches, too (5.1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..constraints import Clearances
from ..phases import HOME, Phase, PhasePath
from .costs import joined
from .joint import JointProblem
from .path import PathProblem
from .switches import SwitchProblems

Array = NDArray[np.float64]


class Undivided:
    """Solves P3 over all phases and their switches at once; each number of phases is built once.

    Args:
        switches, path: what is asked at switches and along ways.
        make: makes the joint problem of a number of phases.
        steps: of a phase.
    """

    def __init__(
        self,
        switches: SwitchProblems,
        path: PathProblem,
        make: Callable[[int], JointProblem],
        steps: int,
    ) -> None:
        self._switches, self._path, self._make, self._steps = switches, path, make, steps
        self._problems: dict[int, JointProblem] = {}

    def problem(self, phases: int) -> JointProblem:
        """For a number of phases."""
        if phases not in self._problems:
            self._problems[phases] = self._make(phases)
        return self._problems[phases]

    def solve(self, phases: Sequence[Phase], x: Array, clear: Clearances) -> list[PhasePath] | None:
        """The paths that are found from a starting point; None if none are.

        The solver is local: they need not cost less than others.

        Args:
            phases: the last one leads home, and no other.
            x: configurations of all phases, (phases * steps + 1, n) [rad]; the first and the last
                one are given.
        """
        ends = range(0, len(x), self._steps)
        ways = self._path.ways(phases, [x[end] for end in ends], clear)
        switching = [phase for phase in phases if phase.kind != HOME]
        solution = self.problem(len(phases)).solve(
            x,
            [self._path.asked(way) for way in ways],
            self._switches.demands(switching, clear),
            thorough=False,
        )
        if not solution.feasible:
            return None
        parts = zip(phases, pairwise(ends))
        return [PhasePath(phase, solution.x[a : b + 1]) for phase, (a, b) in parts]

    def cost(self, paths: Sequence[PhasePath]) -> float:
        """The cost of 5.1, of paths one after another."""
        return self.problem(len(paths)).cost(joined([path.q for path in paths]))
