# SPDX-License-Identifier: Apache-2.0
"""What a solver is, and how several become one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .program import Instance, Program

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Found:
    """Where a solver stopped; whether that is feasible is for its caller to see.

    Attributes:
        z: the unknowns.
        values: of the constraints there.
        solver: who found it.
        iterations: how many it took.
    """

    z: Array
    values: Array
    solver: str
    iterations: int


class Solver(Protocol):
    """Solves instances of the program that it was made for."""

    def solve(self, instance: Instance) -> Found:
        """The best point it finds from ``instance.start``."""


#: Makes a solver for a program. It may be slow (code is generated), solving may not.
SolverFactory = Callable[[Program], Solver]


class Chain:
    """Solvers in turn, each from the same start, until one finds a feasible point.

    The verdict of the last one stands.
    """

    def __init__(self, solvers: tuple[Solver, ...]) -> None:
        self._solvers = solvers

    @property
    def first(self) -> Solver:
        """The one that is asked first."""
        return self._solvers[0]

    def solve(self, instance: Instance) -> Found:
        """The first feasible point, or where the last solver stopped."""
        for solver in self._solvers[:-1]:
            found = solver.solve(instance)
            if instance.feasible(found.values):
                return found
        return self._solvers[-1].solve(instance)


def quickest(solver: Solver) -> Solver:
    """The first of several solvers in turn; else the solver itself."""
    return solver.first if isinstance(solver, Chain) else solver


def chain(*factories: SolverFactory) -> SolverFactory:
    """Makes a :class:`Chain` of what the factories make."""
    return lambda program: Chain(tuple(factory(program) for factory in factories))
