# SPDX-License-Identifier: Apache-2.0
"""Sequential quadratic programming with the costs' own Hessian, on the active-set method DAQP."""

from __future__ import annotations

import casadi as ca
import numpy as np

from .buffered import Buffered
from .program import TOLERANCE, Instance, Program
from .solver import Found

#: Largest step of a joint at which it has converged [rad].
STEP_TOLERANCE = 2e-2
#: Steps it may take, and how far a joint may move in the first of them [rad].
MAX_STEPS = 20
TRUST = 0.5


class Sqp:
    """Linearises the constraints, so each step is a small convex quadratic program.

    The constraints' curvature is left out (Gauss-Newton). From the starting points of this package
    it converges within some four steps in nearly all cases; it proves nothing where it does not.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        slopes = program.jacobian.sparsity_out(1)
        quadratic = ca.conic(
            "quadratic",
            "daqp",
            {"h": program.hessian_sparse.sparsity(), "a": slopes},
            {"error_on_fail": False},
        )
        self._jacobian, self._quadratic = Buffered(program.jacobian), Buffered(quadratic)
        self._hessian = np.array(program.hessian_sparse.nonzeros())
        # The same as a matrix, its columns one after another.
        self._slopes = np.zeros(slopes.size2() * slopes.size1())
        self._places = np.array(slopes.find(), dtype=int)

    def solve(self, instance: Instance) -> Found:
        """Where it converged, or where it gave up."""
        program = self._program
        z, step, trust = instance.start, np.inf, TRUST
        for iteration in range(MAX_STEPS + 1):
            g, jacobian = self._jacobian(z, instance.p)
            values = g.copy()
            holds = instance.excess(values).max(initial=0.0) < TOLERANCE / 2
            done = step < STEP_TOLERANCE and holds
            if done or iteration == MAX_STEPS or not np.isfinite(values).all():
                break
            delta = self._quadratic(
                self._hessian,
                program.hessian @ z + instance.linear,
                jacobian,
                instance.lower_g - values,
                instance.upper_g - values,
                np.maximum(instance.lower_z - z, -trust),
                np.minimum(instance.upper_z - z, trust),
            )[0]
            self._slopes[self._places] = jacobian
            # Where the linearised constraints contradict one another, it stops somewhere.
            if not instance.feasible(values + delta @ self._slopes.reshape(len(z), -1)):
                break
            # Without the constraints' curvature, steps can go to and fro; shorter ones settle. A
            # step that ends at a limit of half the one before has done its part: rounding must not
            # decide whether it is cut again.
            before, step = step, float(np.abs(delta).max())
            if step > before / 2 * (1 + 1e-9):
                trust = step / 2
            z = z + delta
        return Found(z, values, "sqp", iteration)
