# SPDX-License-Identifier: Apache-2.0
"""The k-order Markov problem of equation 3.4 as one non-linear program.

    min over x_{0:T}   sum_t f_t(x_{t-k:t})   s.t.   g_t(x_t) <= 0,  h_t(x_t) = 0

Costs are squares of finite differences of configurations, so their Hessian is constant, banded and
positive definite. Constraints are features of single configurations, evaluated over all steps at
once; equality and inequality differ only in their bounds, which are given anew for each solve. All
three bounds of 3.4 are such problems: P1 has one configuration, P2 the switches with k = 1, P3 the
path with k = 2.

Two solvers share the problem. Sequential quadratic programming linearises the constraints and
keeps the costs' own Hessian (Gauss-Newton: the constraints' curvature is left out), so each step is
a small convex quadratic program, solved by the active-set method DAQP. From the starting points of
this package it converges within some four steps in nearly all cases. Where it does not, IPOPT with
the exact Hessian decides; only its verdict makes a problem count as infeasible.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .features import Feature

Array = NDArray[np.float64]

#: Largest violation of a constraint that counts as feasible [m or rad].
TOLERANCE = 1e-4

#: Largest step of a joint at which sequential quadratic programming has converged [rad].
STEP_TOLERANCE = 2e-2
#: Steps it may take, and how far a joint may move in the first of them [rad].
MAX_STEPS = 20
TRUST = 0.5

_IPOPT: dict[str, Any] = {
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
        solver: which solver found it.
    """

    x: Array
    cost: float
    violations: tuple[Array, ...]
    solver: str
    iterations: int

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
        self._build()

    def _rows(self, steps: NDArray[np.int_]) -> NDArray[np.int_]:
        return (steps[:, None] * self.dimension + np.arange(self.dimension)).ravel()

    def _build(self) -> None:
        count, n = len(self.free), self.dimension
        column = {int(step): index for index, step in enumerate(self.free)}
        x = ca.MX.sym("x", count * n)
        factor = ca.MX.sym("factor")
        sizes = [len(item.steps) * item.feature.value.size1_in(1) for item in self.attached]
        amounts = [len(item.steps) * item.feature.rows for item in self.attached]
        p = ca.MX.sym("p", count * n + sum(sizes))
        lam_g = ca.MX.sym("lam_g", sum(amounts))
        linear, *parameters = ca.vertsplit(p, np.cumsum([0, count * n, *sizes]).tolist())
        multipliers = ca.vertsplit(lam_g, np.cumsum([0, *amounts]).tolist())
        by_step = ca.horzsplit(ca.reshape(x, n, count), 1)
        values, jacobians = [], []
        blocks = [ca.MX(n, n) for _ in range(count)]
        for item, flat, lam in zip(self.attached, parameters, multipliers):
            feature, amount = item.feature, len(item.steps)
            columns = [column[step] for step in item.steps]
            here = ca.horzcat(*[by_step[index] for index in columns])
            given = ca.reshape(flat, -1, amount)
            values.append(ca.vec(feature.value.map(amount)(here, given)))
            curvature = feature.curvature.map(amount)(
                here, given, ca.reshape(lam, feature.rows, amount)
            )
            slopes = ca.horzsplit(feature.jacobian.map(amount)(here, given), n)
            for index, block, slope in zip(columns, ca.horzsplit(curvature, n), slopes):
                blocks[index] = blocks[index] + block
                left = ca.MX(feature.rows, index * n)
                right = ca.MX(feature.rows, (count - index - 1) * n)
                jacobians.append(ca.horzcat(left, slope, right))
        g: ca.MX = ca.vertcat(*values)
        jacobian: ca.MX = ca.vertcat(*jacobians)
        self._hessian_sparse = hessian = ca.sparsify(ca.DM(self._hessian))
        cost = ca.mtimes(x.T, ca.mtimes(hessian, x)) / 2 + ca.dot(linear, x)
        self._expressions: dict[str, Any] = {"x": x, "p": p, "f": cost, "g": g}
        curved = ca.triu(factor * hessian + ca.diagcat(*blocks))
        self._curvature: tuple[list[ca.MX], list[ca.MX]] = ([x, p, factor, lam_g], [curved])
        self._jacobian = ca.Function(
            "nlp_jac_g", [x, p], [g, jacobian], ["x", "p"], ["g", "jac_g_x"]
        )
        self._quadratic = ca.conic(
            "quadratic",
            "daqp",
            {"h": hessian.sparsity(), "a": self._jacobian.sparsity_out(1)},
            {"error_on_fail": False},
        )

    @cached_property
    def _ipopt(self) -> ca.Function:
        curvature = ca.Function(
            "nlp_hess_l",
            self._curvature[0],
            self._curvature[1],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        )
        options: dict[str, Any] = {**_IPOPT, "jac_g": self._jacobian, "hess_lag": curvature}
        return ca.nlpsol("k_order", "ipopt", self._expressions, options)

    def solve(self, x: Array, bounds: Sequence[Bounds], lower: Array, upper: Array) -> Solution:
        """Solves from a starting point; the solution may be infeasible, and says so.

        Args:
            x: shape (steps, n): the given configurations, and the starting point of the others.
            bounds: one for each attached feature.
            lower, upper: joint limits, broadcast to (steps, n) [rad].
        """
        shape = (self.steps, self.dimension)
        given = x[self.fixed].ravel()
        numbers = _Numbers(
            start=np.clip(x, lower, upper)[self.free].ravel(),
            linear=self._coupling @ given,
            parameters=np.concatenate([item.parameters.ravel() for item in bounds]),
            lower_x=np.broadcast_to(lower, shape)[self.free].ravel(),
            upper_x=np.broadcast_to(upper, shape)[self.free].ravel(),
            lower_g=np.concatenate([item.lower.ravel() for item in bounds]),
            upper_g=np.concatenate([item.upper.ravel() for item in bounds]),
        )
        constant = float(given @ self._constant @ given) / 2
        solution = self._finish(x, bounds, numbers, constant, "sqp", *self._solve_sqp(numbers))
        if solution.feasible:
            return solution
        return self._finish(x, bounds, numbers, constant, "ipopt", *self._solve_ipopt(numbers))

    def _solve_sqp(self, numbers: _Numbers) -> tuple[Array, Array, int]:
        z, step, trust = numbers.start, np.inf, TRUST
        for iteration in range(MAX_STEPS + 1):
            g, jacobian = self._jacobian(z, numbers.p)
            values = np.array(g).ravel()
            done = step < STEP_TOLERANCE and numbers.excess(values).max() < TOLERANCE / 2
            if done or iteration == MAX_STEPS or not np.isfinite(values).all():
                break
            result = self._quadratic(
                h=self._hessian_sparse,
                g=self._hessian @ z + numbers.linear,
                a=jacobian,
                lba=numbers.lower_g - values,
                uba=numbers.upper_g - values,
                lbx=np.maximum(numbers.lower_x - z, -trust),
                ubx=np.minimum(numbers.upper_x - z, trust),
            )
            if not self._quadratic.stats()["success"]:
                break
            delta = np.array(result["x"]).ravel()
            # Without the constraints' curvature, steps can go to and fro; shorter ones settle.
            before, step = step, float(np.abs(delta).max())
            if step > before / 2:
                trust = step / 2
            z = z + delta
        return z, values, iteration

    def _solve_ipopt(self, numbers: _Numbers) -> tuple[Array, Array, int]:
        result = self._ipopt(
            x0=numbers.start,
            p=numbers.p,
            lbx=numbers.lower_x,
            ubx=numbers.upper_x,
            lbg=numbers.lower_g,
            ubg=numbers.upper_g,
        )
        iterations = int(self._ipopt.stats()["iter_count"])
        return np.array(result["x"]).ravel(), np.array(result["g"]).ravel(), iterations

    def _finish(
        self,
        x: Array,
        bounds: Sequence[Bounds],
        numbers: _Numbers,
        constant: float,
        solver: str,
        z: Array,
        values: Array,
        iterations: int,
    ) -> Solution:
        solved = np.array(x, dtype=float)
        solved[self.free] = z.reshape(-1, self.dimension)
        excess = numbers.excess(values)
        ends = np.cumsum([item.lower.size for item in bounds])[:-1]
        parts = np.split(excess, ends)
        return Solution(
            x=solved,
            cost=float(z @ self._hessian @ z / 2 + numbers.linear @ z) + constant,
            violations=tuple(part.reshape(item.lower.shape) for part, item in zip(parts, bounds)),
            solver=solver,
            iterations=iterations,
        )


@dataclass(frozen=True)
class _Numbers:
    """One instance of a problem: starting point, linear cost, parameters and bounds, all flat."""

    start: Array
    linear: Array
    parameters: Array
    lower_x: Array
    upper_x: Array
    lower_g: Array
    upper_g: Array

    @cached_property
    def p(self) -> Array:
        return np.concatenate([self.linear, self.parameters])

    def excess(self, values: Array) -> Array:
        """By how much constraints with these values are violated."""
        excess = np.maximum(np.maximum(self.lower_g - values, values - self.upper_g), 0.0)
        return np.asarray(np.where(np.isnan(values), np.inf, excess))
