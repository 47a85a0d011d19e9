# SPDX-License-Identifier: Apache-2.0
"""Sequential quadratic programming in C finds what that in Python finds, on another QP solver."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from motion_scenes import random_heights, random_moves, scene

from motion_node.nlp import Found, Instance, Program
from motion_node.nlp.compiled import loaded, machine_code
from motion_node.nlp.sqp import Sqp, SqpInC, make_sqp
from motion_node.planner import MotionPlanner
from motion_node.settings import Settings

OPEN = np.array([0.04, 0.04])
SIZE, EQUATIONS, INEQUALITIES = 6, 2, 6
ROWS = EQUATIONS + INEQUALITIES


def linear_program(joints: int) -> Program:
    """Rows A z, whose sparse entries are parameters: its solution is that of one QP.

    The first equation is one of the first configuration alone.
    """
    rng = np.random.default_rng(3)
    z = ca.MX.sym("z", SIZE)
    p = ca.MX.sym("p", SIZE + ROWS * SIZE)
    pattern = rng.random((ROWS, SIZE)) < 0.7
    pattern[0] = np.arange(SIZE) < joints
    matrix = ca.sparsify(ca.DM(pattern)) * ca.reshape(p[SIZE:], ROWS, SIZE)
    g = ca.mtimes(matrix, z)
    root = rng.normal(size=(SIZE // joints, SIZE // joints))
    hessian = np.kron(root @ root.T, np.diag(rng.uniform(0.5, 2.0, joints))) + 0.1 * np.eye(SIZE)
    cost = ca.mtimes(z.T, ca.mtimes(ca.DM(hessian), z)) / 2 + ca.dot(p[:SIZE], z)
    function = ca.Function("nlp_jac_g", [z, p], [g, matrix], ["x", "p"], ["g", "jac_g_x"])
    library = machine_code(function)
    function = loaded(function, library)
    return Program(z, p, cost, g, hessian, joints, function, library, lambda: function)


@pytest.fixture(scope="module", params=[1, 2, 3], ids=lambda joints: f"{joints} joints")
def both(request: pytest.FixtureRequest) -> tuple[SqpInC, Sqp]:
    program = linear_program(request.param)
    quick = make_sqp(program)
    assert isinstance(quick, SqpInC)  # a compiler is there wherever the workspace can be built
    return quick, Sqp(program)


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), tight=st.floats(0.0, 1.0))
@example(seed=2239, tight=0.0)  # contradicts itself, and nearly enough a row depends on others
def test_quadratic_programs_have_one_solution(
    both: tuple[SqpInC, Sqp], seed: int, tight: float
) -> None:
    rng = np.random.default_rng(seed)
    values = rng.normal(size=ROWS)
    room = np.append(np.zeros(EQUATIONS), rng.exponential(1.0 - tight, INEQUALITIES))
    lower, upper = values - room, values + room
    upper[rng.random(ROWS) < 0.4] = np.inf
    lower[:EQUATIONS] = upper[:EQUATIONS] = values[:EQUATIONS]
    instance = Instance(
        np.zeros(SIZE),
        rng.normal(size=SIZE),
        rng.normal(size=ROWS * SIZE),
        rng.uniform(-2.0, -0.1, SIZE),
        rng.uniform(0.1, 2.0, SIZE),
        lower,
        upper,
    )
    mine, its = (solver.solve(instance) for solver in both)
    assert instance.feasible(mine.values) == instance.feasible(its.values)
    if instance.feasible(its.values):
        assert_same(mine, its)


def test_contradictions_and_numbers_that_are_none_end_it(both: tuple[SqpInC, Sqp]) -> None:
    fine = Instance(
        np.zeros(SIZE), np.zeros(SIZE), np.ones(ROWS * SIZE),
        np.full(SIZE, -1.0), np.ones(SIZE), np.full(ROWS, -1.0), np.ones(ROWS),
    )  # fmt: skip
    far = replace(fine, lower_g=np.full(ROWS, 99.0), upper_g=np.full(ROWS, np.inf))
    wrong = replace(fine, parameters=np.full(ROWS * SIZE, np.nan))
    for instance in (far, wrong):
        for solver in both:
            found = solver.solve(instance)
            assert found.iterations == 0
            assert not instance.feasible(found.values)
            np.testing.assert_array_equal(found.z, instance.start)


def test_motions_are_the_same(urdf: str, monkeypatch: pytest.MonkeyPatch) -> None:
    planner = MotionPlanner(urdf, settings=Settings(solver="sqp"))
    _, path = planner.prepare(3)
    problem = path._problem
    slow, solve = Sqp(problem._made), problem._solver.solve
    pairs = list[tuple[Found, Found]]()

    def compared(instance: Instance) -> Found:
        pairs.append((solve(instance), slow.solve(instance)))
        return pairs[-1][0]

    monkeypatch.setattr(problem._solver, "solve", compared)
    rng = np.random.default_rng(4)
    graph = scene(random_heights(rng, 6), rng)
    planner.solve(graph, random_moves(graph, 6, rng), planner.model.home, OPEN)
    assert len(pairs) >= 13
    for mine, its in pairs:
        assert_same(mine, its)


def assert_same(mine: Found, its: Found) -> None:
    assert mine.iterations == its.iterations
    np.testing.assert_allclose(mine.z, its.z, atol=1e-5)
    np.testing.assert_allclose(mine.values, its.values, atol=1e-5)
