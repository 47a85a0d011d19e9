# SPDX-License-Identifier: Apache-2.0
"""A non-linear program of fixed structure, which solvers are made for, and instances of it.

min over z   z' H z / 2 + linear' z   s.t.   lower_g <= g(z, p) <= upper_g,
                                             lower_z <=   z     <= upper_z
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Largest violation of a constraint that counts as feasible [m or rad].
TOLERANCE = 1e-4


@dataclass(frozen=True)
class Program:
    """What stays from instance to instance.

    Attributes:
        z: symbols of the unknowns; configurations one after another.
        p: symbols of the linear cost, then of the constraints' parameters.
        cost, g: expressions of z and p.
        hessian: H, constant and positive definite, shape (z, z).
        block: number of the unknowns that are one configuration.
        jacobian: (z, p) -> (g, dg/dz), sparse.
        library: which has it as machine code; None where there is none.
        make_curvature: makes (z, p, factor, multipliers) -> upper triangle of the Hessian of
            factor * cost + multipliers . g.
    """

    z: ca.MX
    p: ca.MX
    cost: ca.MX
    g: ca.MX
    hessian: Array
    block: int
    jacobian: ca.Function
    library: Path | None
    make_curvature: Callable[[], ca.Function]

    @cached_property
    def hessian_sparse(self) -> ca.DM:
        """H without its zeros."""
        return ca.sparsify(ca.DM(self.hessian))

    @cached_property
    def curvature(self) -> ca.Function:
        """What ``make_curvature`` makes, made once."""
        return self.make_curvature()


@dataclass(frozen=True)
class Instance:
    """One instance of a program, all of it flat.

    Attributes:
        start: starting point, within its limits.
        linear: linear cost.
        parameters: of the constraints.
        lower_z, upper_z: limits of the unknowns [rad].
        lower_g, upper_g: limits of the constraints.
    """

    start: Array
    linear: Array
    parameters: Array
    lower_z: Array
    upper_z: Array
    lower_g: Array
    upper_g: Array

    @cached_property
    def p(self) -> Array:
        """Values of :attr:`Program.p`."""
        return np.concatenate([self.linear, self.parameters])

    def excess(self, values: Array) -> Array:
        """By how much constraints with these values are violated."""
        excess = np.maximum(np.maximum(self.lower_g - values, values - self.upper_g), 0.0)
        return np.asarray(np.where(np.isnan(values), np.inf, excess))

    def feasible(self, values: Array) -> bool:
        """Whether constraints with these values hold; the point need not be optimal then."""
        return bool(self.excess(values).max(initial=0.0) <= TOLERANCE)
