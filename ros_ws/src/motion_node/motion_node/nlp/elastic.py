# SPDX-License-Identifier: Apache-2.0
"""A program whose parameters give way: the smallest change with which it has a solution.

    min over z, d   w sum_i |d_i| + v cost(z)   s.t.   lower <= g(z, p + S d) - B d <= upper

S and B say what a unit of each change does to parameters and bounds. The absolute values make d
sparse: one thing far, not all things a little. |d| is split into two parts that are not negative.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .program import TOLERANCE, Instance, Program

Array = NDArray[np.float64]

#: What changes cost [1/m], and what the cost of the program counts beside them.
_CHANGE: Final = 10.0
_COST: Final = 1e-3
_OPTIONS: Final[dict[str, Any]] = {
    "print_time": False,
    "error_on_fail": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "tol": 1e-4,
        "constr_viol_tol": 2e-5,
        "acceptable_tol": 1e-2,
        "acceptable_constr_viol_tol": 5e-5,
        "acceptable_iter": 4,
        "max_iter": 80,
        "hessian_approximation": "limited-memory",
        "bound_relax_factor": 0.0,
    },
}


@dataclass(frozen=True)
class Slopes:
    """What a unit of each change does, one column a change.

    Attributes:
        parameters: to the parameters of the constraints, shape (parameters, changes).
        bounds: to the bounds of the constraints, shape (rows, changes).
        lower, upper: how far each change may go, shape (changes,); 0 lies between them.
    """

    parameters: Array
    bounds: Array
    lower: Array
    upper: Array


class Elastic:
    """Built once for a program and a number of changes."""

    def __init__(self, program: Program, changes: int) -> None:
        z, p, rows = program.z, program.p, program.g.numel()
        self._changes = changes
        self._linear = p.numel()
        more, less = ca.MX.sym("more", changes), ca.MX.sym("less", changes)
        slopes = ca.MX.sym("slopes", p.numel(), changes)
        bounds = ca.MX.sym("bounds", rows, changes)
        whole = ca.Function("whole", [z, p], [program.cost, program.g])
        cost, g = whole(z, p + ca.mtimes(slopes, more - less))
        self._solver = ca.nlpsol(
            "elastic",
            "ipopt",
            {
                "x": ca.vertcat(z, more, less),
                "p": ca.vertcat(p, ca.vec(slopes), ca.vec(bounds)),
                "f": _CHANGE * (ca.sum1(more) + ca.sum1(less)) + _COST * cost,
                "g": g - ca.mtimes(bounds, more - less),
            },
            _OPTIONS,
        )

    def solve(self, instance: Instance, slopes: Slopes) -> Array | None:
        """The smallest changes (changes,) that were found from the start; None if there are none.

        A local solver found them: smaller ones may exist.
        """
        nothing = np.zeros(self._changes)
        given = np.zeros((self._linear, self._changes))
        given[len(instance.linear) :] = slopes.parameters
        result = self._solver(
            x0=np.concatenate([instance.start, nothing, nothing]),
            p=np.concatenate(
                [instance.p, given.ravel(order="F"), slopes.bounds.ravel(order="F")]
            ),
            lbx=np.concatenate([instance.lower_z, nothing, nothing]),
            ubx=np.concatenate([instance.upper_z, slopes.upper, -slopes.lower]),
            lbg=instance.lower_g,
            ubg=instance.upper_g,
        )  # fmt: skip
        values = np.array(result["g"]).ravel()
        if not instance.excess(values).max(initial=0.0) <= TOLERANCE:
            return None
        more, less = np.split(np.array(result["x"]).ravel()[len(instance.start) :], 2)
        return np.asarray(more - less)
