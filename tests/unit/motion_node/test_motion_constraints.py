# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: ARG002
"""Constraints are parts: each is right on its own, may be left out, and others may be added."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import pytest
from motion_scenes import scene

from motion_node.blocks import read_scene
from motion_node.bounds.way import Way
from motion_node.constraints import (
    AlongPath,
    AtSwitch,
    Clearances,
    Constraint,
    Upright,
    default_constraints,
)
from motion_node.errors import PATH, POSE, InfeasibleError
from motion_node.expand import expand
from motion_node.nlp import Demand
from motion_node.phases import Phase
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.robots.model import ArmModel
from motion_node.settings import PathSettings
from scene_graph import Move

OPEN = np.array([0.04, 0.04])
CLEAR = Clearances(0.015, 0.0)
DEFAULTS = default_constraints(PANDA)


class Wall(Constraint):
    """The tool centre point stays on this side of a plane; as a user would write it.

    Args:
        axis: of the world, 0 to 2.
        limit: largest coordinate [m].
    """

    name = "wall"

    def __init__(self, axis: int, limit: float) -> None:
        self._axis, self._limit = axis, limit

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        return model.tool_center[self._axis]

    def row_names(self, phase: Phase) -> Sequence[str]:
        return ("hand behind the wall",)

    def at_switch(self, moment: AtSwitch) -> Demand:
        return Demand.constant(1, -np.inf, self._limit)

    def along_path(self, way: AlongPath) -> Demand:
        return Demand.constant(way.steps, -np.inf, self._limit)


class StiffHand(Upright):
    """It does not lean on its way either."""

    def along_path(self, way: AlongPath) -> Demand:
        return Demand.constant(way.steps, (0.0, 0.0), (0.0, 0.0))


def with_constraints(urdf: str, constraints: Sequence[Constraint]) -> MotionPlanner:
    return MotionPlanner(urdf, constraints=constraints)


def phases_of(planner: MotionPlanner, heights: tuple[int, ...], *moves: Move) -> list[Phase]:
    settings = planner.settings
    stacks = read_scene(scene(heights))
    return expand(stacks, moves, PANDA.gripper, settings.phases, settings.squeeze)


def a_way(planner: MotionPlanner, phase: Phase, start: np.ndarray | None = None) -> Way:
    home = planner.model.home
    begin = home if start is None else start
    return Way(planner.model, planner.settings.path, phase, begin, home, CLEAR)


@pytest.mark.parametrize("constraint", DEFAULTS, ids=lambda c: c.name)
def test_derivatives_match_finite_differences(
    planner: MotionPlanner, constraint: Constraint
) -> None:
    rng = np.random.default_rng(1)
    phase = phases_of(planner, (3, 1, 2), Move(0, 1))[1]
    rows = constraint.rows(planner.model, 3)
    if constraint.at_switches:
        demand = constraint.at_switch(AtSwitch(PANDA, phase, CLEAR))
    else:
        demand = constraint.along_path(a_way(planner, phase).along)
    parameters, step = demand.parameters[-1], 1e-6
    for _ in range(5):
        q = planner.model.home + rng.uniform(-0.4, 0.4, planner.model.dimension)
        multipliers = rng.normal(size=rows.count)
        jacobian = np.array(rows.jacobian(q, parameters))
        curvature = np.array(rows.curvature(q, parameters, multipliers))
        for joint in range(planner.model.dimension):
            aside = step * np.eye(planner.model.dimension)[joint]
            ends = (q + aside, q - aside)
            values = [np.array(rows.value(x, parameters)).ravel() for x in ends]
            slopes = [multipliers @ np.array(rows.jacobian(x, parameters)) for x in ends]
            difference = (values[0] - values[1]) / (2 * step)
            np.testing.assert_allclose(jacobian[:, joint], difference, atol=1e-6)
            difference = (slopes[0] - slopes[1]) / (2 * step)
            np.testing.assert_allclose(curvature[:, joint], difference, atol=2e-3, rtol=1e-4)


@pytest.mark.parametrize("constraint", DEFAULTS, ids=lambda c: c.name)
def test_each_row_has_a_name_and_is_asked_for(
    planner: MotionPlanner, constraint: Constraint
) -> None:
    phase = phases_of(planner, (3, 1, 2), Move(0, 1))[1]
    rows = constraint.rows(planner.model, 3)
    assert len(constraint.row_names(phase)) == rows.count
    steps = constraint.path_steps(PathSettings())
    demands = []
    if constraint.at_switches:
        demands.append((1, constraint.at_switch(AtSwitch(PANDA, phase, CLEAR))))
    if steps:
        demands.append((len(steps), constraint.along_path(a_way(planner, phase).along)))
    assert demands
    for count, demand in demands:
        assert demand.lower.shape == demand.upper.shape == (count, rows.count)
        assert demand.parameters.shape == (count, rows.parameter_count)
        assert (demand.lower <= demand.upper).all()


def test_what_the_hand_holds_is_named(planner: MotionPlanner) -> None:
    pick, place, _ = phases_of(planner, (1, 0, 0), Move(0, 1))
    names = {phase.kind: [c.row_names(phase) for c in DEFAULTS] for phase in (pick, place)}
    assert "clearance of hand to stack1" in names["pick"][1]
    assert "clearance of hand with red_box to stack1" in names["place"][1]


def test_a_start_that_violates_a_constraint_may_leave_but_not_get_worse(
    planner: MotionPlanner,
) -> None:
    home_phase = phases_of(planner, (3, 1, 2))[-1]
    leaning = planner.model.home.copy()
    leaning[5] += 0.3
    way = a_way(planner, home_phase, leaning).along
    for constraint in DEFAULTS[:2]:
        demand = constraint.along_path(way)
        bad = np.full(demand.lower.shape[1], -0.3)
        relaxed = constraint.relaxed(demand, bad, way)
        assert relaxed.lower[0] == pytest.approx(bad, abs=2e-3)
        assert (relaxed.lower[-1] == demand.lower[-1]).all()


def test_an_added_constraint_that_is_met_anyway_changes_nothing(
    urdf: str, planner: MotionPlanner
) -> None:
    graph, moves = scene((2, 1, 1), np.random.default_rng(1)), [Move(0, 1), Move(1, 2)]
    added = with_constraints(urdf, [*DEFAULTS, Wall(2, 2.0)])
    plain = planner.solve(graph, moves, planner.model.home, OPEN)
    other = added.solve(graph, moves, planner.model.home, OPEN)
    assert other.trajectory.duration == pytest.approx(plain.trajectory.duration, abs=1e-6)


def test_an_added_constraint_is_kept(urdf: str, planner: MotionPlanner) -> None:
    graph, moves = scene((2, 4, 1)), [Move(0, 2)]

    def farthest(which: MotionPlanner) -> float:
        motion = which.solve(graph, moves, which.model.home, OPEN)
        return max(float(which.model.hand_at(q)[0][0]) for path in motion.paths for q in path.q)

    limit = 0.502
    assert farthest(planner) > limit + 0.005
    assert farthest(with_constraints(urdf, [*DEFAULTS, Wall(0, limit)])) < limit + 1e-4


@pytest.mark.parametrize(("axis", "limit", "bound"), [(1, 0.1, POSE), (2, 0.05, PATH)])
def test_an_added_constraint_that_cannot_be_kept_names_itself(
    urdf: str, axis: int, limit: float, bound: str
) -> None:
    """A wall before the place; a ceiling above the switches, below the end of the lift."""
    planner = with_constraints(urdf, [*DEFAULTS, Wall(axis, limit)])
    with pytest.raises(InfeasibleError) as caught:
        planner.solve(scene((1, 1, 0)), [Move(0, 2)], planner.model.home, OPEN)
    assert caught.value.bound == bound
    assert caught.value.constraint == "hand behind the wall"


def test_a_constraint_may_be_replaced(urdf: str, planner: MotionPlanner) -> None:
    stiff = with_constraints(urdf, [StiffHand(), *DEFAULTS[1:]])

    def most_lean(which: MotionPlanner) -> float:
        motion = which.solve(scene((2, 4, 1)), [Move(0, 2)], which.model.home, OPEN)
        value = DEFAULTS[0].rows(which.model, 3).value
        return max(
            float(np.abs(np.array(value(q, []))).max()) for path in motion.paths for q in path.q
        )

    assert most_lean(planner) > 0.02
    assert most_lean(stiff) < 1.1e-3  # its limit is 1e-3


@pytest.mark.parametrize("index", range(1, len(DEFAULTS)), ids=[c.name for c in DEFAULTS[1:]])
def test_each_constraint_may_be_left_out(urdf: str, index: int) -> None:
    rest = [c for k, c in enumerate(DEFAULTS) if k != index]
    planner = with_constraints(urdf, rest)
    motion = planner.solve(scene((2, 1, 0)), [Move(0, 2)], planner.model.home, OPEN)
    assert motion.trajectory.duration > 1.0


def test_without_clearances_the_hand_takes_the_shorter_way(
    urdf: str, planner: MotionPlanner
) -> None:
    careless = with_constraints(urdf, [c for c in DEFAULTS if "clearance" not in c.name])
    graph, moves = scene((1, 5, 0)), [Move(0, 2)]
    home = planner.model.home
    kept = planner.solve(graph, moves, home, OPEN).trajectory.duration
    assert careless.solve(graph, moves, home, OPEN).trajectory.duration < kept - 0.05


def test_without_any_constraint_the_arm_stays_at_home(urdf: str) -> None:
    free = with_constraints(urdf, [])
    motion = free.solve(scene((1, 1, 0)), [Move(0, 2)], free.model.home, OPEN)
    for path in motion.paths:
        assert path.q == pytest.approx(np.tile(free.model.home, (len(path.q), 1)), abs=1e-6)


class WrongCount(Wall):
    """Asks for more rows than it has."""

    name = "wrong_count"

    def at_switch(self, moment: AtSwitch) -> Demand:
        return Demand.constant(1, (0.0, 0.0), (1.0, 1.0))


def test_a_constraint_that_asks_for_rows_it_does_not_have_is_named(urdf: str) -> None:
    planner = with_constraints(urdf, [WrongCount(2, 1.0)])
    with pytest.raises(ValueError, match="wrong_count has 1 rows"):
        planner.solve(scene((1, 0, 0)), [Move(0, 1)], planner.model.home, OPEN)
