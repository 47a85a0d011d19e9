# SPDX-License-Identifier: Apache-2.0
"""Elastic problems whose least changes are known in closed form."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from motion_node.nlp import (
    DEFAULT_SOLVER,
    SOLVERS,
    Attached,
    Demand,
    DifferenceCost,
    KOrderProblem,
    Rows,
)

UNIT = 1e-3


def problem(expression: ca.SX, q: ca.SX, parameters: ca.SX) -> KOrderProblem:
    """One free configuration of two joints between two that are given."""
    differences = np.eye(3)[1:] - np.eye(3)[:-1]
    rows = Rows("toy", q, parameters, expression)
    return KOrderProblem(
        2,
        3,
        fixed=(0, 2),
        costs=[DifferenceCost(differences, np.ones(2))],
        attached=[Attached(rows, (1,))],
        solver=SOLVERS[DEFAULT_SOLVER],
    )


def there(x: float, y: float) -> Demand:
    return Demand.constant(1, (0.0, 0.0), (0.0, 0.0), (x, y))


@pytest.mark.parametrize(
    ("point", "axis", "missing"), [((1.5, 0.2), 0, 0.5), ((0.2, -1.3), 1, 0.3)]
)
def test_a_point_outside_the_limits_comes_in_by_what_is_missing(
    point: tuple[float, float], axis: int, missing: float
) -> None:
    """Joints within one rad of 0 reach points within the square, and no others."""
    q, p = ca.SX.sym("q", 2), ca.SX.sym("p", 2)
    toy = problem(q - p, q, p)
    x, limits = np.zeros((3, 2)), (np.full(2, -1.0), np.full(2, 1.0))
    pulled = [[there(point[0] + UNIT, point[1])], [there(point[0], point[1] + UNIT)]]
    reach = (np.full(2, -2.0), np.full(2, 2.0))
    x[1] = np.clip(point, -1, 1)
    least = toy.least_changes(x, [there(*point)], UNIT, pulled, reach, limits)
    assert least is not None
    expected = np.zeros(2)
    expected[axis] = -np.sign(point[axis]) * missing
    np.testing.assert_allclose(least, expected, atol=1e-3)


def test_bounds_give_way_like_parameters() -> None:
    """A sum of joints that cannot be three is made two, by its bound."""
    q, p = ca.SX.sym("q", 2), ca.SX.sym("p", 0)
    toy = problem(q[0] + q[1], q, p)
    asked, pulled = [Demand.constant(1, 3.0, 3.0)], [[Demand.constant(1, 3 + UNIT, 3 + UNIT)]]
    reach, limits = (np.array([-2.0]), np.array([2.0])), (np.full(2, -1.0), np.full(2, 1.0))
    least = toy.least_changes(np.zeros((3, 2)), asked, UNIT, pulled, reach, limits)
    assert least is not None
    np.testing.assert_allclose(least, [-1.0], atol=1e-3)


def test_changes_that_may_not_go_far_enough_are_none() -> None:
    q, p = ca.SX.sym("q", 2), ca.SX.sym("p", 0)
    toy = problem(q[0] + q[1], q, p)
    asked, pulled = [Demand.constant(1, 3.0, 3.0)], [[Demand.constant(1, 3 + UNIT, 3 + UNIT)]]
    reach, limits = (np.array([-0.5]), np.array([0.5])), (np.full(2, -1.0), np.full(2, 1.0))
    assert toy.least_changes(np.zeros((3, 2)), asked, UNIT, pulled, reach, limits) is None
