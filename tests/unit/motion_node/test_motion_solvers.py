# SPDX-License-Identifier: Apache-2.0
"""Solvers behind one interface: they agree, and a chain asks the next where one fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import random_heights, random_moves, scene

from motion_node.errors import POSE, InfeasibleError
from motion_node.nlp import SOLVERS, Found, Instance, Program, chain
from motion_node.planner import MotionPlanner
from motion_node.settings import Settings
from scene_graph import Move

OPEN = np.array([0.04, 0.04])


def with_solver(urdf: str, name: str) -> MotionPlanner:
    return MotionPlanner(urdf, settings=Settings(solver=name))


def test_solvers_agree(urdf: str) -> None:
    rng = np.random.default_rng(4)
    graph = scene(random_heights(rng, 5), rng)
    moves = random_moves(graph, 2, rng)
    durations = {}
    for name in SOLVERS:
        planner = with_solver(urdf, name)
        motion = planner.solve(graph, moves, planner.model.home, OPEN)
        durations[name] = motion.trajectory.duration
    least, most = min(durations.values()), max(durations.values())
    assert most < 1.02 * least, durations


@pytest.mark.parametrize("name", SOLVERS)
def test_every_solver_finds_what_is_out_of_reach_infeasible(urdf: str, name: str) -> None:
    planner = with_solver(urdf, name)
    graph = scene((1, 0, 0), places=[(0.5, -0.15), (0.5, 0.0), (1.1, 0.15)])
    with pytest.raises(InfeasibleError) as caught:
        planner.solve(graph, [Move(0, 2)], planner.model.home, OPEN)
    assert (caught.value.bound, caught.value.phase) == (POSE, "place")


@pytest.mark.parametrize("away", [0.03, 0.05])
def test_a_block_that_stands_beside_its_place_is_put_back(
    planner: MotionPlanner, away: float
) -> None:
    """Once it is lifted nothing stands where it stood, over which it reaches in its place."""
    graph = scene((1, 0, 0, 1), places=[(0.5, -0.15), (0.5, 0.0), (0.5, 0.15), (0.5 + away, 0.0)])
    places = tuple(replace(place, aside=place.index == 3) for place in graph.places)
    graph = replace(graph, places=places)
    motion = planner.solve(graph, [Move(3, 1)], planner.model.home, OPEN)
    assert [phase.object_name for phase in motion.phases] == ["green_box", "green_box", ""]


def test_an_unknown_solver_is_refused_by_name(urdf: str) -> None:
    with pytest.raises(ValueError, match="no solver 'snopt'; there is sqp_then_ipopt, sqp, ipopt"):
        with_solver(urdf, "snopt")


class Fixed:
    """Finds the same point for every instance, and counts how often it was asked."""

    def __init__(self, name: str, value: float) -> None:
        self.name, self.value, self.asked = name, value, 0

    def made_for(self, _program: Program) -> Fixed:
        return self

    def solve(self, instance: Instance) -> Found:
        self.asked += 1
        return Found(instance.start, np.array([self.value]), self.name, 1)


@pytest.mark.parametrize(
    ("values", "winner", "asked"),
    [((0.5, 0.5), "a", (1, 0)), ((2.0, 0.5), "b", (1, 1)), ((2.0, 3.0), "b", (1, 1))],
)
def test_a_chain_stops_at_the_first_feasible_point(
    values: tuple[float, float], winner: str, asked: tuple[int, int]
) -> None:
    solvers = [Fixed(name, value) for name, value in zip("ab", values)]
    empty, one = np.zeros(0), np.ones(1)
    instance = Instance(empty, empty, empty, empty, empty, 0 * one, one)
    program: Program = None  # type: ignore[assignment]  # nothing here looks at it
    found = chain(*(solver.made_for for solver in solvers))(program).solve(instance)
    assert found.solver == winner
    assert tuple(solver.asked for solver in solvers) == asked
