# SPDX-License-Identifier: Apache-2.0
"""Sequential quadratic programming with the costs' own Hessian, on the active-set method DAQP."""

from __future__ import annotations

import casadi as ca
import numpy as np

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
        self._quadratic = ca.conic(
            "quadratic",
            "daqp",
            {"h": program.hessian_sparse.sparsity(), "a": program.jacobian.sparsity_out(1)},
            {"error_on_fail": False},
        )

    def solve(self, instance: Instance) -> Found:
        """Where it converged, or where it gave up."""
        program = self._program
        z, step, trust = instance.start, np.inf, TRUST
        for iteration in range(MAX_STEPS + 1):
            g, jacobian = program.jacobian(z, instance.p)
            values = np.array(g).ravel()
            holds = instance.excess(values).max(initial=0.0) < TOLERANCE / 2
            done = step < STEP_TOLERANCE and holds
            if done or iteration == MAX_STEPS or not np.isfinite(values).all():
                break
            result = self._quadratic(
                h=program.hessian_sparse,
                g=program.hessian @ z + instance.linear,
                a=jacobian,
                lba=instance.lower_g - values,
                uba=instance.upper_g - values,
                lbx=np.maximum(instance.lower_z - z, -trust),
                ubx=np.minimum(instance.upper_z - z, trust),
            )
            if not self._quadratic.stats()["success"]:
                break
            delta = np.array(result["x"]).ravel()
            # Without the constraints' curvature, steps can go to and fro; shorter ones settle. A
            # step that ends at a limit of half the one before has done its part: rounding must not
            # decide whether it is cut again.
            before, step = step, float(np.abs(delta).max())
            if step > before / 2 * (1 + 1e-9):
                trust = step / 2
            z = z + delta
        return Found(z, values, "sqp", iteration)
