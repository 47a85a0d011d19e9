# SPDX-License-Identifier: Apache-2.0
"""Rows of g and h of equation 3.4 for one configuration: what they are, and what is asked of them.

Rows are symbolic in CasADi. Those of several constraints that act at the same steps are joined into
one function before they are compiled, so that what they share (the arm's kinematics above all) is
evaluated once a step, whoever asked for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_OPTIONS = {"cse": True}


@dataclass(frozen=True, eq=False)
class Rows:
    """A vector function of a configuration with its derivatives, compiled when asked for.

    Attributes:
        name: for messages of CasADi; letters, digits and single underscores.
        q: symbols of the configuration, shape (n, 1).
        parameters: symbols of what else the rows depend on, shape (p, 1); p may be 0.
        expression: the rows, shape (rows, 1).
    """

    name: str
    q: ca.SX
    parameters: ca.SX
    expression: ca.SX

    @property
    def count(self) -> int:
        """Number of rows."""
        return int(self.expression.numel())

    @property
    def parameter_count(self) -> int:
        """Number of parameters."""
        return int(self.parameters.numel())

    @cached_property
    def value(self) -> ca.Function:
        """(q, parameters) -> (rows,)."""
        outputs = [ca.densify(self.expression)]
        return ca.Function(self.name, [self.q, self.parameters], outputs, _OPTIONS)

    @cached_property
    def jacobian(self) -> ca.Function:
        """(q, parameters) -> (rows, n), dense."""
        outputs = [ca.densify(ca.jacobian(self.expression, self.q))]
        return ca.Function(f"{self.name}_jac", [self.q, self.parameters], outputs, _OPTIONS)

    @cached_property
    def curvature(self) -> ca.Function:
        """(q, parameters, multipliers) -> (n, n), the Hessian of multipliers . rows."""
        multipliers = ca.SX.sym("multipliers", self.count)
        hessian, _ = ca.hessian(ca.dot(multipliers, self.expression), self.q)
        inputs = [self.q, self.parameters, multipliers]
        return ca.Function(f"{self.name}_hess", inputs, [ca.densify(hessian)], _OPTIONS)


@dataclass(frozen=True)
class Demand:
    """What is asked of rows, at each of the steps at which they are evaluated.

    Attributes:
        parameters: shape (steps, parameters).
        lower, upper: shape (steps, rows); infinite where a row does not count.
    """

    parameters: Array
    lower: Array
    upper: Array

    @classmethod
    def constant(
        cls,
        steps: int,
        lower: float | Sequence[float],
        upper: float | Sequence[float],
        parameters: Sequence[float] | Array = (),
    ) -> Demand:
        """The same at each step.

        Args:
            lower, upper: one number a row, or one number if there is one row.
            parameters: shape (parameters,).
        """
        given, low, high = (np.array(row, float, ndmin=2) for row in (parameters, lower, upper))
        if steps == 1:
            return cls(given, low, high)
        return cls(*(np.repeat(row, steps, axis=0) for row in (given, low, high)))

    @classmethod
    def after_one_another(cls, demands: Sequence[Demand]) -> Demand:
        """Demands on the same rows, their steps in order."""
        return cls._joined(demands, 0)

    @classmethod
    def side_by_side(cls, demands: Sequence[Demand]) -> Demand:
        """Demands on different rows at the same steps, for :class:`JoinedRows`."""
        return cls._joined(demands, 1)

    @classmethod
    def _joined(cls, demands: Sequence[Demand], axis: int) -> Demand:
        if len(demands) == 1:
            return demands[0]
        return cls(
            np.concatenate([demand.parameters for demand in demands], axis),
            np.concatenate([demand.lower for demand in demands], axis),
            np.concatenate([demand.upper for demand in demands], axis),
        )

    def at(self, here: Sequence[int]) -> Demand:
        """What is asked at some of the steps."""
        return Demand(self.parameters[here], self.lower[here], self.upper[here])

    def excess(self, values: Array) -> Array:
        """By how much rows of these values (steps, rows) miss what is asked, same shape."""
        missed = np.maximum(np.maximum(self.lower - values, values - self.upper), 0.0)
        return np.asarray(np.where(np.isnan(values), np.inf, missed))


class JoinedRows:
    """The rows of several parts as one function.

    Args:
        parts: all of the same symbols ``q``; at least one.

    Attributes:
        rows: the parts' rows one after another, their parameters likewise.
    """

    def __init__(self, name: str, parts: Sequence[Rows]) -> None:
        self.rows = Rows(
            name,
            parts[0].q,
            ca.vertcat(*[part.parameters for part in parts]),
            ca.vertcat(*[part.expression for part in parts]),
        )
        self._ends = np.cumsum([part.count for part in parts])[:-1]

    def split(self, by_row: Array) -> list[Array]:
        """Each part's share of an array whose last axis is the rows."""
        return np.split(by_row, self._ends, axis=-1)
