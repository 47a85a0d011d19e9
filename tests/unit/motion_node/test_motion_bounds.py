# SPDX-License-Identifier: Apache-2.0
"""The three bounds of 3.4: what is infeasible is named, and what is feasible is exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import BASES, random_heights, random_moves, scene

from motion_node.blocks import read_scene
from motion_node.constraints import Clearances
from motion_node.errors import KEYFRAMES, PATH, POSE, CancelledError, InfeasibleError
from motion_node.expand import expand
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.settings import PathSettings, Settings
from scene_graph import Move

HOME = np.array(PANDA.home)
OPEN = np.array([0.04, 0.04])


def test_a_place_out_of_reach_is_a_matter_of_the_pose(planner: MotionPlanner) -> None:
    graph = scene((1, 0, 0), places=[(0.5, -0.15), (0.5, 0.0), (1.1, 0.15)])
    with pytest.raises(InfeasibleError) as caught:
        planner.solve(graph, [Move(0, 1), Move(1, 2)], HOME, OPEN)
    error = caught.value
    assert (error.bound, error.object_name, error.move, error.phase) == (
        POSE, "red_box", 1, "place",
    )  # fmt: skip
    assert "reach of the hand" in error.constraint
    assert "stack2" in error.constraint
    assert error.violation > 0.05
    assert "red_box" in str(error)


def test_blocks_beside_their_places_are_named_where_there_is_no_solution(
    planner: MotionPlanner,
) -> None:
    graph = scene((1, 1, 0), places=[(0.5, -0.15), (0.5, 0.0), (1.1, 0.15)])
    with pytest.raises(InfeasibleError) as caught:
        planner.solve(graph, [Move(0, 2)], HOME, OPEN)
    assert "beside" not in str(caught.value)
    moved = [
        replace(item, position_world=tuple(np.add(item.position_world, (0.0, 0.04, 0.0))))
        for item in graph.objects
    ]
    with pytest.raises(InfeasibleError, match=r"has no solution.* stands 40 mm beside stack0"):
        planner.solve(replace(graph, objects=tuple(moved)), [Move(0, 2)], HOME, OPEN)


def test_a_block_too_wide_for_the_fingers_is_a_matter_of_the_pose(
    planner: MotionPlanner,
) -> None:
    graph = scene((1, 0, 0), edge=0.075)
    with pytest.raises(InfeasibleError) as caught:
        planner.solve(graph, [Move(0, 1)], HOME, OPEN)
    assert (caught.value.bound, caught.value.object_name) == (POSE, "red_box")
    assert "width of red_box" in caught.value.constraint
    assert caught.value.violation == pytest.approx(0.005, abs=1e-6)


def test_a_stack_too_near_to_its_neighbour_names_both(planner: MotionPlanner) -> None:
    graph = scene((1, 5, 0), places=[(0.5, -0.055), (0.5, 0.0), (0.5, 0.15)])
    with pytest.raises(InfeasibleError) as caught:
        planner.solve(graph, [Move(0, 2)], HOME, OPEN)
    error = caught.value
    assert (error.bound, error.object_name, error.phase) == (POSE, "red_box", "pick")
    assert error.constraint.startswith(("clearance of", "reach of the hand", "tilt"))


def test_a_lift_out_of_reach_is_a_matter_of_the_path(urdf: str) -> None:
    """Feasible switches, but no vertical line that is long enough."""
    lifting = MotionPlanner(urdf, settings=Settings(path=PathSettings(lift=1.0)))
    with pytest.raises(InfeasibleError) as caught:
        lifting.solve(scene((1, 0, 0)), [Move(0, 1)], HOME, OPEN)
    assert caught.value.bound == PATH
    assert caught.value.object_name == "red_box"
    assert caught.value.constraint in ("lift", "vertical line", "direction of the fingers") or (
        caught.value.constraint.startswith("tilt")
    )


def test_bounds_have_the_names_of_the_message() -> None:
    assert (POSE, KEYFRAMES, PATH) == ("pose", "keyframes", "path")


def test_keyframes_reach_their_switches(planner: MotionPlanner) -> None:
    rng = np.random.default_rng(5)
    keyframes, _ = planner.prepare(3)
    for _ in range(5):
        graph = scene(random_heights(rng, 6), rng)
        phases = expand(
            read_scene(graph),
            random_moves(graph, 4, rng),
            PANDA.gripper,
            planner.settings.phases,
            0.006,
        )
        ways = keyframes.solve(HOME, phases, Clearances(0.015, 0.0))
        for phase, way in zip(phases[:-1], ways):
            q = way.goal_q
            point, yaw = planner.model.hand_at(q)
            assert phase.switch is not None
            assert point == pytest.approx(phase.switch.position_world, abs=2e-4)
            assert abs(np.sin(yaw - phase.switch.yaw)) < 2e-4
            assert (q >= planner.model.lower).all()
            assert (q <= planner.model.upper).all()


def test_dividing_the_path_problem_by_phases_loses_nothing(planner: MotionPlanner) -> None:
    """With zero velocity at given switches, the undivided problem has the same solution."""
    rng = np.random.default_rng(6)
    graph = scene((2, 1, 1), rng)
    phases = expand(
        read_scene(graph),
        random_moves(graph, 2, rng),
        PANDA.gripper,
        planner.settings.phases,
        0.006,
    )
    keyframes, divided = planner.prepare(3)
    clear = Clearances(0.015, 0.0)
    ends = [HOME, *(way.goal_q for way in keyframes.solve(HOME, phases, clear))]
    undivided = planner.path_problem(3, phases=len(phases))
    together = undivided.solve(phases, ends, clear)
    apart = [
        divided.solve([phase], [start, goal], clear)[0]
        for phase, start, goal in zip(phases, ends, ends[1:])
    ]
    for one, other in zip(together, apart):
        np.testing.assert_allclose(one.q, other.q, atol=0.02)


def test_optimising_stops_on_request(planner: MotionPlanner) -> None:
    answers = iter([False, False, True])
    with pytest.raises(CancelledError):
        planner.solve(
            scene((2, 1, 1)), [Move(0, 1)], HOME, OPEN, cancelled=lambda: next(answers, True)
        )


@pytest.mark.parametrize(
    "bases",
    [
        [(0.45, -0.12), (0.45, 0.0), (0.45, 0.12)],
        [(0.55, -0.2), (0.55, 0.0), (0.55, 0.2)],
        [(0.5, -0.225), (0.5, -0.075), (0.5, 0.075), (0.5, 0.225)],
        [(0.4, 0.1), (0.55, 0.3)],
    ],
)
def test_places_may_be_elsewhere(planner: MotionPlanner, bases: list[tuple[float, float]]) -> None:
    graph = scene((2, 1, 1, 1)[: len(bases)], np.random.default_rng(7), places=bases)
    motion = planner.solve(graph, [Move(0, 1), Move(1, 0)], HOME, OPEN)
    assert motion.trajectory.duration > 4.0


def test_the_table_may_be_at_another_height(planner: MotionPlanner) -> None:
    graph = scene((2, 1, 1))
    raised = replace(
        graph,
        objects=tuple(
            replace(o, position_world=tuple(np.add(o.position_world, (0, 0, 0.1))))
            for o in graph.objects
        ),
        places=tuple(
            replace(b, position_world=tuple(np.add(b.position_world, (0, 0, 0.1))))
            for b in graph.places
        ),
    )
    motion = planner.solve(raised, [Move(0, 1)], HOME, OPEN)
    assert motion.floor == pytest.approx(0.1)
    place = motion.phases[1].switch
    assert place is not None
    assert place.position_world[2] == pytest.approx(0.1 + 0.0675 + 0.002)


def test_the_scenes_bases_are_the_defaults_of_these_tests() -> None:
    assert [b.position_world[:2] for b in scene((1, 1, 1)).places] == list(BASES)
