# SPDX-License-Identifier: Apache-2.0
"""The interior-point method IPOPT with the exact Hessian."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from .program import Instance, Program
from .solver import Found

_OPTIONS: dict[str, Any] = {
    "print_time": False,
    "error_on_fail": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "tol": 1e-3,
        "constr_viol_tol": 1e-5,
        "acceptable_tol": 1e-2,
        "acceptable_constr_viol_tol": 1e-5,
        "acceptable_iter": 3,
        "mu_init": 1e-2,
        "alpha_for_y": "full",
        "max_iter": 100,
        "bound_relax_factor": 0.0,
        "mumps_scaling": 0,
        "mumps_permuting_scaling": 0,
    },
}


class Ipopt:
    """Slower and more robust than :class:`Sqp`; built when it is first needed."""

    def __init__(self, program: Program) -> None:
        self._program = program

    @cached_property
    def _solver(self) -> ca.Function:
        program = self._program
        return ca.nlpsol(
            "k_order",
            "ipopt",
            {"x": program.z, "p": program.p, "f": program.cost, "g": program.g},
            {**_OPTIONS, "jac_g": program.jacobian, "hess_lag": program.curvature},
        )

    def solve(self, instance: Instance) -> Found:
        """Where IPOPT stopped, by convergence or by its limit of iterations."""
        result = self._solver(
            x0=instance.start,
            p=instance.p,
            lbx=instance.lower_z,
            ubx=instance.upper_z,
            lbg=instance.lower_g,
            ubg=instance.upper_g,
        )
        return Found(
            np.array(result["x"]).ravel(),
            np.array(result["g"]).ravel(),
            "ipopt",
            int(self._solver.stats()["iter_count"]),
        )
