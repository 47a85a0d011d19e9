# SPDX-License-Identifier: Apache-2.0
"""The path problem undivided: it costs less than its parts, and keeps to the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_scenes import random_heights, random_moves, scene
from numpy.typing import NDArray

from motion_node.bounds.costs import joined, least_through, path_costs
from motion_node.constraints import Clearances
from motion_node.nlp import DifferenceCost, KOrderProblem
from motion_node.phases import PhasePath
from motion_node.planner import Motion, MotionPlanner
from motion_node.robots import PANDA
from motion_node.settings import Settings

Array = NDArray[np.float64]

MOVES, STEPS = 2, 9
OPEN = np.array([0.04, 0.04])
CLEAR = Clearances(0.015, 0.0)


@dataclass(frozen=True)
class Both:
    """A motion phase by phase, and what the undivided problem makes of it."""

    planner: MotionPlanner
    motion: Motion
    together: list[PhasePath]


@pytest.fixture(scope="module")
def both(urdf: str) -> Both:
    rng = np.random.default_rng(8)
    graph = scene(random_heights(rng, 6), rng)
    moves = random_moves(graph, MOVES, rng)
    planner = MotionPlanner(urdf)
    motion = planner.solve(graph, moves, np.array(PANDA.home), OPEN)
    x = joined([path.q for path in motion.paths])
    together = planner.undivided(3).solve(motion.phases, x, CLEAR)
    assert together is not None
    return Both(planner, motion, together)


def cost(paths: list[PhasePath] | tuple[PhasePath, ...]) -> float:
    """As 5.1 has it, phase by phase: accelerations by central differences, and velocities."""
    acceleration = np.array(PANDA.acceleration)
    weights = (np.median(acceleration) / acceleration) ** 2 * STEPS**3 / 10
    total = 0.0
    for path in paths:
        resting = np.vstack([path.q[1], path.q, path.q[-2]])
        total += float((weights * np.diff(resting, 2, axis=0) ** 2).sum())
        total += float((3 * STEPS * np.diff(path.q, axis=0) ** 2).sum())
    return total


def test_costs_less_than_phase_by_phase(both: Both) -> None:
    whole = both.planner.undivided(3)
    assert whole.cost(both.together) == pytest.approx(cost(both.together))
    assert whole.cost(both.motion.paths) == pytest.approx(cost(both.motion.paths))
    assert cost(both.together) < cost(both.motion.paths)
    moved = [np.abs(a.q[-1] - b.q[-1]).max() for a, b in zip(both.together, both.motion.paths)]
    assert max(moved) > 1e-3  # it is the switches that make the difference


def test_keeps_to_switches_and_to_what_is_asked_along_ways(both: Both) -> None:
    planner = both.planner
    _, problem = planner.prepare(3)
    for path, following in zip(both.together, both.together[1:]):
        np.testing.assert_array_equal(path.q[-1], following.q[0])
        switch = path.phase.switch
        assert switch is not None
        point, yaw = planner.model.hand_at(path.q[-1])
        assert point == pytest.approx(switch.position_world, abs=2e-4)
        assert abs(np.sin(yaw - switch.yaw)) < 2e-4
    for path in both.together:
        demands = problem.demands(path.phase, [path.q[0], path.q[-1]], CLEAR)
        assert problem.missed(path.q, demands, path.phase) == []
        assert (path.q >= planner.model.lower).all()
        assert (path.q <= planner.model.upper).all()


def test_p2_bounds_it_from_below(both: Both) -> None:
    """Fewer constraints, and the least cost through what is kept: never more than the whole."""
    planner, phases = both.planner, both.motion.phases
    keyframes, path = planner.prepare(3)
    relaxed = keyframes.problem(len(phases))
    x = joined([own.q for own in both.together])
    ways = path.ways(phases, list(x[::STEPS]), CLEAR)
    asked = [path.asked(way) for way in ways]
    demands = keyframes.problems.demands(phases[:-1], CLEAR)
    solution = relaxed.solve(x[relaxed.steps], asked, demands)
    assert solution.feasible
    assert relaxed.cost(solution.x) < relaxed.cost(x[relaxed.steps]) + 1e-6 * cost(both.together)
    assert relaxed.cost(x[relaxed.steps]) < cost(both.together)


def test_is_a_choice_of_the_planner(both: Both, urdf: str) -> None:
    rng = np.random.default_rng(8)
    graph = scene(random_heights(rng, 6), rng)
    moves = random_moves(graph, MOVES, rng)
    planner = MotionPlanner(urdf, settings=Settings(joint=True))
    motion = planner.solve(graph, moves, np.array(PANDA.home), OPEN)
    assert cost(motion.paths) == pytest.approx(cost(both.together), rel=1e-3)


def test_derivatives_are_those_of_finite_differences(both: Both) -> None:
    """Switches and half steps beside them included."""
    problem: KOrderProblem = both.planner.undivided(3).problem(2 * MOVES + 1)._problem
    rng, made = np.random.default_rng(9), problem._made
    x = joined([path.q for path in both.together])
    z = x[problem.free].ravel() + rng.normal(0.0, 0.01, problem.free.size * 7)
    p = rng.uniform(0.1, 0.5, made.p.numel())
    _, jacobian = made.jacobian(z, p)
    for _ in range(5):
        way, h = rng.normal(size=len(z)), 1e-5
        way /= np.linalg.norm(way)
        after, before = (np.array(made.jacobian(z + s * way, p)[0]) for s in (h, -h))
        exact = np.array(jacobian @ way)
        np.testing.assert_allclose(exact, (after - before) / (2 * h), atol=1e-6)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), phases=st.integers(1, 3))
def test_the_least_cost_through_knots_is_that_of_the_best_path(seed: int, phases: int) -> None:
    rng = np.random.default_rng(seed)
    costs = path_costs(phases, STEPS, rng.uniform(1.0, 9.0, 2))
    steps = phases * STEPS + 1
    inner = rng.choice(np.arange(1, steps - 1), 2, replace=False)
    kept = sorted({0, steps - 1, *inner.tolist()})
    knots = rng.normal(size=(len(kept), 2))
    left = np.setdiff1d(np.arange(steps), kept)
    best = np.zeros((steps, 2))
    best[kept] = knots
    for joint in range(2):
        root = np.vstack([np.sqrt(c.weights[joint]) * c.differences for c in costs])
        target = -root[:, kept] @ knots[:, joint]
        best[left, joint] = np.linalg.lstsq(root[:, left], target, rcond=None)[0]
    assert _value(least_through(costs, kept), knots) == pytest.approx(_value(costs, best))


def _value(costs: list[DifferenceCost], x: Array) -> float:
    return sum(float((cost.weights * (cost.differences @ x) ** 2).sum()) for cost in costs)
