# SPDX-License-Identifier: Apache-2.0
"""The k-order Markov problem of equation 3.4 as one non-linear program.

    min over x_{0:T}   sum_t f_t(x_{t-k:t})   s.t.   g_t(x_t) <= 0,  h_t(x_t) = 0

Costs are squares of finite differences of configurations, so their Hessian is constant, banded and
positive definite. Constraints are rows of single configurations, evaluated over all steps at
once; equality and inequality differ only in their bounds, which are given anew for each solve. All
three bounds of 3.4 are such problems: P1 has one configuration, P2 the switches with k = 1, P3 the
path with k = 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, floor

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .compiled import MachineCode, loaded
from .elastic import Elastic, Slopes
from .program import TOLERANCE, Instance, Program
from .rows import Demand, Rows
from .solver import SolverFactory, quickest

Array = NDArray[np.float64]

#: So small beside others, an entry of the Hessian comes from rounding: the Hessian is banded.
ROUNDING = 1e-12


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
    """Rows and the steps at which they are evaluated; half a step is the mean of two free ones."""

    rows: Rows
    steps: tuple[float, ...]


@dataclass(frozen=True)
class Solution:
    """What came out of a solve.

    Attributes:
        x: configurations, fixed ones included, shape (steps, n).
        violations: for each attached part, shape (len(steps), rows) [m or rad].
        solver: which solver found it.
        iterations: how many it took.
    """

    x: Array
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


class _Pattern:
    """Where the slopes of attached parts belong in the Jacobian of all of them.

    They are put there in one go: code that joins matrices part by part grows with their number,
    and takes a compiler ten seconds where many phases are solved at once.

    Args:
        dimension: n, number of joints.
        count: of free configurations.
    """

    def __init__(self, dimension: int, count: int) -> None:
        self._dimension, self._count = dimension, count
        self._rows, self._columns = [np.zeros(0, int)], [np.zeros(0, int)]
        self._sources, self._shares = [np.zeros(0, int)], [np.zeros(0)]
        self._height = self._given = 0

    def add(self, slope: ca.Sparsity, columns: Sequence[Sequence[int]]) -> None:
        """Slopes of one structure, given one after another, and the configurations of each."""
        row, column = (np.array(places, int) for places in slope.get_triplet())
        for own in columns:
            for configuration in own:
                self._rows.append(self._height + row)
                self._columns.append(configuration * self._dimension + column)
                self._sources.append(self._given + np.arange(len(row)))
                self._shares.append(np.full(len(row), 1.0 / len(own)))
            self._height += slope.size1()
            self._given += len(row)

    def filled(self, slopes: ca.MX) -> ca.MX:
        """The Jacobian, from what is not zero of all slopes."""
        rows, columns = np.concatenate(self._rows), np.concatenate(self._columns)
        order = np.lexsort((rows, columns))
        width = self._count * self._dimension
        begins = np.searchsorted(columns[order], np.arange(width + 1))
        sparsity = ca.Sparsity(self._height, width, begins.tolist(), rows[order].tolist())
        shares = ca.DM(np.concatenate(self._shares)[order])
        return ca.MX(sparsity, slopes.nz[np.concatenate(self._sources)[order].tolist()] * shares)


class KOrderProblem:
    """A problem of fixed structure: built once, solved for many parameters.

    Args:
        dimension: n, number of joints.
        steps: number of configurations, fixed ones included.
        fixed: indices of the configurations that are given.
        costs: the cost terms.
        attached: the constraints.
        solver: makes what solves it.
    """

    def __init__(
        self,
        dimension: int,
        steps: int,
        fixed: Sequence[int],
        costs: Sequence[DifferenceCost],
        attached: Sequence[Attached],
        solver: SolverFactory,
    ) -> None:
        self.dimension, self.steps = dimension, steps
        self.free = np.array([step for step in range(steps) if step not in set(fixed)])
        self.fixed = np.array(sorted(set(fixed)), dtype=int)
        self.attached = tuple(attached)
        self._costs = tuple(costs)
        full = np.zeros((steps * dimension, steps * dimension))
        for cost in costs:
            gram = cost.differences.T @ cost.differences
            full += 2.0 * np.kron(gram, np.diag(cost.weights))
        full[np.abs(full) < ROUNDING * np.abs(full).max()] = 0.0
        free, fixed_rows = self._unknowns(self.free), self._unknowns(self.fixed)
        self._hessian = full[np.ix_(free, free)]
        self._coupling = full[np.ix_(free, fixed_rows)]
        self._made, self._make_solver = self._program(), solver
        self._coming: MachineCode | None = MachineCode(self._made.jacobian)
        if not self._take_machine_code():
            self._solver = solver(self._made)
        self._elastic: dict[int, Elastic] = {}

    def _unknowns(self, steps: NDArray[np.int_]) -> NDArray[np.int_]:
        return (steps[:, None] * self.dimension + np.arange(self.dimension)).ravel()

    def _program(self) -> Program:
        count, n = len(self.free), self.dimension
        column = {int(step): index for index, step in enumerate(self.free)}
        z = ca.MX.sym("z", count * n)
        sizes = [len(item.steps) * item.rows.parameter_count for item in self.attached]
        amounts = [len(item.steps) * item.rows.count for item in self.attached]
        p = ca.MX.sym("p", count * n + sum(sizes))
        linear, *flat = ca.vertsplit(p, np.cumsum([0, count * n, *sizes]).tolist())
        values: list[ca.MX] = [ca.MX(0, 1)]
        slopes: list[ca.MX] = [ca.MX(0, 1)]
        pattern = _Pattern(n, count)
        maps: list[tuple[Attached, list[list[int]], ca.MX, ca.MX]] = []
        for item, parameters in zip(self.attached, flat):
            rows, amount = item.rows, len(item.steps)
            columns = [
                [column[index] for index in sorted({floor(step), ceil(step)})]
                for step in item.steps
            ]
            first, last = (
                z.nz[self._unknowns(np.array([own[end] for own in columns])).tolist()]
                for end in (0, -1)
            )
            here = ca.reshape((first + last) / 2, n, amount)
            given = ca.reshape(parameters, rows.parameter_count, amount)
            maps.append((item, columns, here, given))
            values.append(ca.vec(rows.value.map(amount)(here, given)))
            slopes.append(ca.vec(rows.jacobian.map(amount)(here, given)).nz[:])
            pattern.add(rows.jacobian.sparsity_out(0), columns)
        g: ca.MX = ca.vertcat(*values)
        hessian = ca.sparsify(ca.DM(self._hessian))
        cost = ca.mtimes(z.T, ca.mtimes(hessian, z)) / 2 + ca.dot(linear, z)

        def make_curvature() -> ca.Function:
            factor = ca.MX.sym("factor")
            lam_g = ca.MX.sym("lam_g", sum(amounts))
            multipliers = ca.vertsplit(lam_g, np.cumsum([0, *amounts]).tolist())
            total = factor * hessian
            for (item, columns, here, given), lam in zip(maps, multipliers):
                amount = len(item.steps)
                weights = ca.reshape(lam, item.rows.count, amount)
                curvature = item.rows.curvature.map(amount)(here, given, weights)
                # (d here / d z)' diag(curvature) (d here / d z)
                mean = np.zeros((amount, count))
                for row, own in enumerate(columns):
                    mean[row, own] = 1.0 / len(own)
                spread = ca.sparsify(ca.DM(np.kron(mean, np.eye(n))))
                blocks = ca.diagcat(*ca.horzsplit(curvature, n))
                total += ca.mtimes(spread.T, ca.mtimes(blocks, spread))
            return ca.Function(
                "nlp_hess_l",
                [z, p, factor, lam_g],
                [ca.triu(total)],
                ["x", "p", "lam_f", "lam_g"],
                ["triu_hess_gamma_x_x"],
            )

        jacobian = ca.Function(
            "nlp_jac_g", [z, p], [g, pattern.filled(ca.vertcat(*slopes))],
            ["x", "p"], ["g", "jac_g_x"],
        )  # fmt: skip
        return Program(z, p, cost, g, self._hessian, n, jacobian, None, make_curvature)

    def _take_machine_code(self) -> bool:
        """Goes over to machine code when there is some that was not there before."""
        if self._coming is None or not self._coming.ready.is_set():
            return False
        library, self._coming = self._coming.library, None
        if library is None:
            return False
        jacobian = loaded(self._made.jacobian, library)
        self._made = replace(self._made, jacobian=jacobian, library=library)
        self._solver = self._make_solver(self._made)
        return True

    def solve(
        self,
        x: Array,
        demands: Sequence[Demand],
        lower: Array,
        upper: Array,
        thorough: bool = True,
    ) -> Solution:
        """Solves from a starting point; the solution may be infeasible, and says so.

        Args:
            x: shape (steps, n): the given configurations, and the starting point of the others.
            demands: one for each attached part.
            lower, upper: joint limits, shape (n,) or (steps, n) [rad].
            thorough: whether, of several solvers in turn, those behind the first one are asked.
        """
        self._take_machine_code()
        instance = self._instance(x, demands, lower, upper)
        solver = self._solver if thorough else quickest(self._solver)
        found = solver.solve(instance)
        solved = np.array(x, dtype=float)
        solved[self.free] = found.z.reshape(-1, self.dimension)
        excess, violations, end = instance.excess(found.values), list[Array](), 0
        for demand in demands:
            begin, end = end, end + demand.lower.size
            violations.append(excess[begin:end].reshape(demand.lower.shape))
        return Solution(
            x=solved,
            violations=tuple(violations),
            solver=found.solver,
            iterations=found.iterations,
        )

    def cost(self, x: Array) -> float:
        """Of configurations (steps, n), whether they keep to the constraints or not."""
        return sum(
            float((cost.weights * (cost.differences @ x) ** 2).sum()) for cost in self._costs
        )

    def _instance(
        self, x: Array, demands: Sequence[Demand], lower: Array, upper: Array
    ) -> Instance:
        def of_the_free(limits: Array) -> Array:
            if limits.ndim > 1:
                return limits[self.free].ravel()
            found = np.empty((len(self.free), self.dimension))
            found[:] = limits
            return found.ravel()

        least, most = of_the_free(lower), of_the_free(upper)
        return Instance(
            start=np.minimum(np.maximum(x[self.free].ravel(), least), most),
            linear=self._coupling @ x[self.fixed].ravel(),
            parameters=_flat([demand.parameters for demand in demands]),
            lower_z=least,
            upper_z=most,
            lower_g=_flat([demand.lower for demand in demands]),
            upper_g=_flat([demand.upper for demand in demands]),
        )

    def least_changes(
        self,
        x: Array,
        demands: Sequence[Demand],
        unit: float,
        changed: Sequence[Sequence[Demand]],
        reach: tuple[Array, Array],
        limits: tuple[Array, Array],
    ) -> Array | None:
        """The smallest changes of what is asked with which there is a solution.

        Args:
            x: as for :meth:`solve`.
            changed: the demands after each change by ``unit`` alone.
            reach: how far each change may go down and up, in the unit's unit, shape (changes,).
            limits: of the joints, as for :meth:`solve`.

        Returns:
            The changes, shape (changes,); None if no solution was found with any.
        """
        if len(changed) not in self._elastic:
            self._elastic[len(changed)] = Elastic(self._made, len(changed))
        instance = self._instance(x, demands, *limits)
        others = [self._instance(x, own, *limits) for own in changed]
        finite = np.isfinite(instance.lower_g)
        bound = np.where(finite, instance.lower_g, instance.upper_g)
        bounds = [np.where(finite, own.lower_g, own.upper_g) for own in others]
        fixed = ~np.isfinite(bound)
        slopes = Slopes(
            np.column_stack([(o.parameters - instance.parameters) / unit for o in others]),
            np.column_stack([np.where(fixed, 0.0, _less(o, bound)) / unit for o in bounds]),
            *reach,
        )
        return self._elastic[len(changed)].solve(instance, slopes)


def _less(value: Array, other: Array) -> Array:
    """The difference; that of infinite ones is 0."""
    with np.errstate(invalid="ignore"):
        return np.nan_to_num(value - other, nan=0.0)


def _flat(arrays: Sequence[Array]) -> Array:
    return np.concatenate([np.zeros(0), *[array.ravel() for array in arrays]])
