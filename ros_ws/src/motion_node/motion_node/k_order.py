# SPDX-License-Identifier: Apache-2.0
"""The k-order Markov problem of equation 3.4 as one non-linear program, solved by IPOPT.

    min over x_{0:T}   sum_t f_t(x_{t-k:t})   s.t.   g_t(x_t) <= 0,  h_t(x_t) = 0

Costs are squares of finite differences of configurations, so their Hessian is constant and
banded. Constraints are features of single configurations with their exact second derivatives,
evaluated over all steps at once; equality and inequality differ only in their bounds, which are
given anew for each solve. All three bounds of 3.4 are such problems: P1 has one configuration,
P2 the switches with k = 1, P3 the whole path with k = 2.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .features import Feature

Array = NDArray[np.float64]

#: Largest violation of a constraint that counts as feasible [m or rad].
TOLERANCE = 1e-4

_IPOPT = {
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
        "max_iter": 100,
        "bound_relax_factor": 0.0,
        "mumps_scaling": 0,
        "mumps_permuting_scaling": 0,
    },
}


@dataclass(frozen=True)
class DifferenceCost:
    """A cost sum_r ||diag(sqrt(weights)) sum_t differences[r, t] x_t||^2.

    Attributes:
        differences: finite-difference operator over the steps, shape (r, steps).
        weights: per joint, shape (n,).
    """

    differences: Array
    weights: Array


@dataclass(frozen=True)
class Attached:
    """A feature and the steps at which it is evaluated."""

    feature: Feature
    steps: tuple[int, ...]


@dataclass(frozen=True)
class Bounds:
    """Values for one attached feature, for each of its steps.

    Attributes:
        parameters: shape (len(steps), parameter size).
        lower, upper: shape (len(steps), rows); infinite where a row does not count.
    """

    parameters: Array
    lower: Array
    upper: Array


@dataclass(frozen=True)
class Solution:
    """What came out of a solve.

    Attributes:
        x: configurations, fixed ones included, shape (steps, n).
        cost: value of the cost up to the constant of the fixed configurations.
        violations: for each attached feature, shape (len(steps), rows) [m or rad].
        status: IPOPT's return status.
    """

    x: Array
    cost: float
    violations: tuple[Array, ...]
    status: str
    iterations: int
    seconds: float

    @property
    def violation(self) -> float:
        """Largest violation of all constraints [m or rad]."""
        return max((float(v.max()) for v in self.violations if v.size), default=0.0)

    @property
    def feasible(self) -> bool:
        """Whether all constraints hold; the point need not be optimal then."""
        return self.violation <= TOLERANCE


class KOrderProblem:
    """A problem of fixed structure: built once, solved for many parameters.

    Args:
        dimension: n, number of joints.
        steps: number of configurations, fixed ones included.
        fixed: indices of the configurations that are given.
        costs: the cost terms.
        attached: the constraints.
    """

    def __init__(
        self,
        dimension: int,
        steps: int,
        fixed: Sequence[int],
        costs: Sequence[DifferenceCost],
        attached: Sequence[Attached],
    ) -> None:
        self.dimension, self.steps = dimension, steps
        self.free = np.array([step for step in range(steps) if step not in set(fixed)])
        self.fixed = np.array(sorted(set(fixed)), dtype=int)
        self.attached = tuple(attached)
        full = np.zeros((steps * dimension, steps * dimension))
        for cost in costs:
            gram = cost.differences.T @ cost.differences
            full += 2.0 * np.kron(gram, np.diag(cost.weights))
        rows_free = self._rows(self.free)
        rows_fixed = self._rows(self.fixed)
        self._hessian = full[np.ix_(rows_free, rows_free)]
        self._coupling = full[np.ix_(rows_free, rows_fixed)]
        self._constant = full[np.ix_(rows_fixed, rows_fixed)]
        self._solver = self._build()

    def _rows(self, steps: NDArray[np.int_]) -> NDArray[np.int_]:
        return (steps[:, None] * self.dimension + np.arange(self.dimension)).ravel()

    def _build(self) -> ca.Function:
        count, n = len(self.free), self.dimension
        column = {int(step): index for index, step in enumerate(self.free)}
        x = ca.MX.sym("x", count * n)
        linear = ca.MX.sym("linear", count * n)
        factor = ca.MX.sym("factor")
        by_step = ca.horzsplit(ca.reshape(x, n, count), 1)
        hessian = ca.sparsify(ca.DM(self._hessian))
        cost = ca.mtimes(x.T, ca.mtimes(hessian, x)) / 2 + ca.dot(linear, x)
        parameters, multipliers, values, jacobians = [linear], [], [], []
        blocks = [ca.MX(n, n) for _ in range(count)]
        for item in self.attached:
            columns = [column[step] for step in item.steps]
            here = ca.horzcat(*[by_step[index] for index in columns])
            size, amount = item.feature.value.size1_in(1), len(columns)
            given = ca.MX.sym("parameters", size, amount)
            lam = ca.MX.sym("multipliers", item.feature.rows, amount)
            parameters.append(ca.vec(given))
            multipliers.append(ca.vec(lam))
            values.append(ca.vec(item.feature.value.map(amount)(here, given)))
            curvature = ca.horzsplit(item.feature.curvature.map(amount)(here, given, lam), n)
            jacobian = ca.horzsplit(item.feature.jacobian.map(amount)(here, given), n)
            for index, block, part in zip(columns, curvature, jacobian):
                blocks[index] = blocks[index] + block
                left = ca.MX(item.feature.rows, index * n)
                right = ca.MX(item.feature.rows, (count - index - 1) * n)
                jacobians.append(ca.horzcat(left, part, right))
        p = ca.MX.sym("p", sum(item.numel() for item in parameters))
        lam_g = ca.MX.sym("lam_g", sum(item.numel() for item in multipliers))
        g, jac = ca.vertcat(*values), ca.vertcat(*jacobians)
        lagrangian = ca.triu(factor * hessian + ca.diagcat(*blocks))
        # Gather the many symbols into the two vectors that nlpsol knows.
        raw = ca.Function(
            "raw",
            [x, *parameters_symbols(parameters), factor, *parameters_symbols(multipliers)],
            [cost, g, jac, lagrangian],
        )
        pieces = split_like(p, parameters)
        lam_pieces = split_like(lam_g, multipliers)
        cost_p, g_p, jac_p, hess_p = raw.call([x, *pieces, factor, *lam_pieces], True, False)
        options = {
            **_IPOPT,
            "jac_g": ca.Function("nlp_jac_g", [x, p], [g_p, jac_p], ["x", "p"], ["g", "jac_g_x"]),
            "hess_lag": ca.Function(
                "nlp_hess_l",
                [x, p, factor, lam_g],
                [hess_p],
                ["x", "p", "lam_f", "lam_g"],
                ["triu_hess_gamma_x_x"],
            ),
        }
        return ca.nlpsol("k_order", "ipopt", {"x": x, "p": p, "f": cost_p, "g": g_p}, options)

    def solve(self, x: Array, bounds: Sequence[Bounds], lower: Array, upper: Array) -> Solution:
        """Solves from a starting point.

        Args:
            x: shape (steps, n): the given configurations, and the starting point of the others.
            bounds: one for each attached feature.
            lower, upper: joint limits, broadcast to (steps, n) [rad].
        """
        begin = time.perf_counter()
        shape = (self.steps, self.dimension)
        low, high = np.broadcast_to(lower, shape), np.broadcast_to(upper, shape)
        given = x[self.fixed].ravel()
        linear = self._coupling @ given
        p = np.concatenate([linear, *[item.parameters.ravel() for item in bounds]])
        lower_g = np.concatenate([item.lower.ravel() for item in bounds])
        upper_g = np.concatenate([item.upper.ravel() for item in bounds])
        result = self._solver(
            x0=np.clip(x, low, high)[self.free].ravel(),
            p=p,
            lbx=low[self.free].ravel(),
            ubx=high[self.free].ravel(),
            lbg=lower_g,
            ubg=upper_g,
        )
        stats = self._solver.stats()
        solved = np.array(x, dtype=float)
        solved[self.free] = np.array(result["x"]).reshape(-1, self.dimension)
        values = np.array(result["g"]).ravel()
        excess = np.maximum(np.maximum(lower_g - values, values - upper_g), 0.0)
        excess = np.where(np.isfinite(excess), excess, np.inf)
        violations, begin_row = [], 0
        for item in bounds:
            rows = item.lower.size
            violations.append(excess[begin_row : begin_row + rows].reshape(item.lower.shape))
            begin_row += rows
        return Solution(
            x=solved,
            cost=float(result["f"]) + float(given @ self._constant @ given) / 2,
            violations=tuple(violations),
            status=str(stats["return_status"]),
            iterations=int(stats["iter_count"]),
            seconds=time.perf_counter() - begin,
        )


def parameters_symbols(vectors: Sequence[ca.MX]) -> list[ca.MX]:
    """The symbols behind vectors that are symbols, or reshaped ones."""
    return [ca.symvar(vector)[0] for vector in vectors]


def split_like(vector: ca.MX, parts: Sequence[ca.MX]) -> list[ca.MX]:
    """Cuts a vector into pieces of the shapes of the symbols behind ``parts``."""
    ends = np.cumsum([0, *[part.numel() for part in parts]])
    symbols = parameters_symbols(parts)
    return [
        ca.reshape(vector[int(a) : int(b)], symbol.size1(), symbol.size2())
        for a, b, symbol in zip(ends, ends[1:], symbols)
    ]
