# SPDX-License-Identifier: Apache-2.0
"""Optimised motions, judged by pybullet's collision distances and by the limits."""

from __future__ import annotations

import numpy as np
import pytest
from collision_oracle import CollisionOracle, replay, switches
from motion_scenes import EDGE, random_heights, random_moves, scene
from numpy.typing import NDArray

from motion_node.bounds.costs import path_costs
from motion_node.constraints import Clearances
from motion_node.phases import HOME, PICK, PLACE
from motion_node.planner import Motion, MotionPlanner
from motion_node.robots import PANDA
from scene_graph import Move, SceneGraph, apply_move

HOME_Q = np.array(PANDA.home)
OPEN = np.array([0.04, 0.04])
#: Meshes keep this distance from what they must not touch [m]; the palm comes nearest, to the
#: block that the fingers hold.
FREE = 0.008


def judge(
    planner: MotionPlanner,
    graph: SceneGraph,
    moves: list[Move],
    start: NDArray[np.float64] = HOME_Q,
) -> Motion:
    motion = planner.solve(graph, moves, start, OPEN)
    result = replay(graph, moves, motion, planner.settings.phases.place_gap, vertical=0.03)
    assert result.free.distance > FREE, result.free
    assert result.support.distance > -0.001, result.support
    stacks = graph.stacks()
    for move in moves:
        stacks = apply_move(stacks, move)
    moved = {phase.object_name for phase in motion.phases}
    for stack, base in zip(stacks, graph.places):
        for level, name in enumerate(stack):
            position = result.positions[name]
            assert position[2] == pytest.approx((level + 0.5) * EDGE, abs=2e-3), name
            off = np.abs(position[:2] - base.position_world[:2]).max()
            assert off < (1e-3 if name in moved else 6e-3), name
    return motion


def assert_at_home(motion: Motion) -> None:
    end = motion.trajectory.positions[-1]
    np.testing.assert_allclose(end.arm, HOME_Q)
    np.testing.assert_allclose(end.fingers, OPEN)


@pytest.mark.parametrize("seed", range(8))
def test_random_plans_touch_nothing(planner: MotionPlanner, seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = scene(random_heights(rng, int(rng.integers(3, 8))), rng)
    judge(planner, graph, random_moves(graph, int(rng.integers(1, 5)), rng))


@pytest.mark.parametrize(
    ("heights", "moves"),
    [
        ((3, 1, 3), [(1, 0), (2, 1)]),
        ((6, 1, 0), [(1, 2), (0, 1)]),
        ((0, 6, 1), [(2, 0), (0, 2)]),
        ((1, 5, 1), [(0, 2), (2, 0)]),
        ((7, 0, 0), [(0, 1), (0, 2)]),
        ((1, 0, 6), [(0, 1), (1, 2)]),
    ],
)
def test_low_blocks_beside_tall_towers(
    planner: MotionPlanner, heights: tuple[int, ...], moves: list[tuple[int, int]]
) -> None:
    judge(planner, scene(heights, np.random.default_rng(0)), [Move(*m) for m in moves])


@pytest.mark.parametrize(
    ("heights", "move"), [((0, 6, 0), (1, 0)), ((1, 5, 0), (0, 1)), ((0, 5, 1), (2, 0))]
)
def test_no_way_lies_in_a_dear_valley(
    planner: MotionPlanner, heights: tuple[int, ...], move: tuple[int, int]
) -> None:
    """The same ways begun sooner or later, solved from there, do not cost much less."""
    motion = planner.solve(scene(heights), [Move(*move)], HOME_Q, OPEN)
    _, problem = planner.prepare(3)
    clear = Clearances(planner.settings.path.margin, motion.floor)
    costs = path_costs(1, planner.settings.path.steps, np.array(PANDA.acceleration))

    def cost(q: NDArray[np.float64]) -> float:
        return sum(float((c.weights * (c.differences @ q) ** 2).sum()) for c in costs)

    ours, best = 0.0, 0.0
    for path in motion.paths:
        share = np.linspace(0.0, 1.0, len(path.q))
        found = [cost(path.q)]
        for power in (0.5, 0.7, 1.4, 2.0):
            start = np.column_stack([np.interp(share**power, share, own) for own in path.q.T])
            ends = [path.q[0], path.q[-1]]
            found.append(cost(problem.solve([path.phase], ends, clear, [start])[0].q))
        ours, best = ours + found[0], best + min(found)
    assert ours < 1.01 * best


def test_blocks_may_be_turned(planner: MotionPlanner) -> None:
    rng = np.random.default_rng(12)
    judge(planner, scene((2, 2, 2), rng, yaw=0.5, offset=0.002), [Move(0, 1), Move(2, 0)])


@pytest.mark.parametrize("height", [0.0, 0.035, 0.06])
def test_an_arm_that_starts_over_a_stack_rises_first(planner: MotionPlanner, height: float) -> None:
    """Above the top block: around it, just over it, and well over it."""
    graph = scene((2, 2, 0))
    near = HOME_Q.copy()
    near[0], near[6] = -0.3, -1.1
    above = np.array([0.5, -0.15, 1.5 * EDGE + height])
    start = planner.inverse.solve(above, np.zeros(1), near)[0]
    motion = judge(planner, graph, [Move(1, 2)], start)
    points = [
        planner.model.hand_at(q)[0]
        for q in motion.trajectory.sample(np.linspace(0, 0.3, 10))[0].arm
    ]
    assert all(np.hypot(*(point[:2] - above[:2])) < 0.01 or point[2] > above[2] for point in points)


def test_limits_hold_everywhere(planner: MotionPlanner) -> None:
    rng = np.random.default_rng(20)
    graph = scene((3, 2, 1), rng)
    trajectory = planner.solve(graph, random_moves(graph, 4, rng), HOME_Q, OPEN).trajectory
    times = np.arange(0.0, trajectory.duration, 0.001)
    positions, velocities = trajectory.sample(times)
    arm, speed = positions.arm, np.abs(velocities.arm)
    assert (arm >= planner.model.kinematics.lower).all()
    assert (arm <= planner.model.kinematics.upper).all()
    timing = planner.timing
    assert (speed <= timing.velocity_scale * planner.limits.velocity * 1.001).all()
    acceleration = np.abs(np.diff(velocities.arm, axis=0)) / 0.001
    allowed = timing.acceleration_scale * planner.limits.acceleration
    assert (acceleration <= allowed * 1.01).all()
    fingers = positions.fingers
    assert fingers.min() >= 0.0
    assert fingers.max() <= 0.04 + 1e-9
    assert np.abs(velocities.fingers).max() <= 0.2
    # Positions agree with velocities, so there are no jumps.
    for values, rates in ((arm, velocities.arm), (fingers, velocities.fingers)):
        np.testing.assert_allclose(np.diff(values, axis=0) / 0.001, rates[:-1], atol=0.03)


def test_at_switches_the_hand_stands_still_straight_down_at_the_grasp(
    planner: MotionPlanner,
) -> None:
    rng = np.random.default_rng(21)
    graph = scene((2, 2, 2), rng)
    motion = planner.solve(graph, random_moves(graph, 3, rng), HOME_Q, OPEN)
    gripping = [interval for interval in motion.trajectory.intervals if interval.gripping]
    assert [i.phase.kind for i in gripping] == [PICK, PLACE] * 3
    for interval in gripping:
        for time in np.linspace(interval.start, interval.end, 5):
            positions, velocities = motion.trajectory.sample(time)
            assert np.abs(velocities.arm).max() < 1e-6
            point, yaw = planner.model.hand_at(positions.arm)
            switch = interval.phase.switch
            assert switch is not None
            assert point == pytest.approx(switch.position_world, abs=2e-4)
            assert abs(np.sin(yaw - switch.yaw)) < 2e-4
        both = motion.trajectory.sample(np.array([interval.start, interval.end]))[0]
        ends = both.fingers[:, 0]
        phase = interval.phase
        assert phase.grasp is not None
        half = phase.grasp.width / 2
        beside, pressing = half + planner.timing.finger_room, (half + phase.grip) / 2
        assert ends[1] == pytest.approx(pressing if phase.kind == PICK else beside)
        assert (ends[1] < ends[0]) == (interval.phase.kind == PICK)


def test_the_hand_comes_from_above_and_leaves_upwards(planner: MotionPlanner) -> None:
    rng = np.random.default_rng(22)
    graph = scene((1, 3, 2), rng)
    motion = planner.solve(graph, random_moves(graph, 3, rng), HOME_Q, OPEN)
    for interval in motion.trajectory.intervals:
        if interval.gripping:
            continue
        times = np.linspace(interval.start, interval.end, 60)
        points = np.array(
            [planner.model.hand_at(q)[0] for q in motion.trajectory.sample(times)[0].arm]
        )
        for switch in (interval.phase.start, interval.phase.switch):
            if switch is None:
                continue
            for height, most in ((0.01, 0.003), (0.02, 0.006)):
                near = points[points[:, 2] < switch.position_world[2] + height]
                aside = np.hypot(*(near[:, :2] - switch.position_world[:2]).T)
                low = aside[aside < 0.05]
                assert low.size
                assert low.max() < most


def test_the_motion_ends_at_home_with_open_fingers(planner: MotionPlanner) -> None:
    motion = planner.solve(scene((2, 0, 1)), [Move(0, 1)], HOME_Q, OPEN)
    assert motion.trajectory.intervals[-1].phase.kind == HOME
    assert_at_home(motion)
    assert not motion.trajectory.velocities.arm[-1].any()
    assert not motion.trajectory.velocities.fingers[-1].any()


def test_fingers_that_are_closed_open_before_the_arm_moves(planner: MotionPlanner) -> None:
    motion = planner.solve(scene((2, 0, 1)), [Move(0, 1)], HOME_Q, np.zeros(2))
    first = motion.trajectory.intervals[0]
    assert first.gripping
    positions = motion.trajectory.sample(np.array([0.0, first.end]))[0]
    np.testing.assert_allclose(positions.arm, [HOME_Q, HOME_Q])
    np.testing.assert_allclose(positions.fingers, [np.zeros(2), OPEN])


@pytest.mark.parametrize("seed", range(4))
def test_an_empty_hand_that_is_stopped_anywhere_goes_home_and_touches_nothing(
    planner: MotionPlanner, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    graph = scene(random_heights(rng, 6), rng)
    moves = random_moves(graph, 3, rng)
    motion = planner.solve(graph, moves, HOME_Q, OPEN)
    empty = [i for i in motion.trajectory.intervals if not i.phase.tool.held and not i.gripping]
    for interval in empty[:-1]:
        time = rng.uniform(interval.start, interval.end)
        brake = motion.trajectory.brake(time, 0.0, 0.4)
        rest = brake.positions[-1]
        home = planner.solve_way_home(motion, interval.phase.move, rest.arm, rest.fingers)
        oracle = CollisionOracle(graph)
        switches(oracle, moves, motion, planner.settings.phases.place_gap, until=time)
        for trajectory in (brake, home.trajectory):
            for at in np.arange(0.0, trajectory.duration, 0.04):
                oracle.take_up(trajectory.sample(at)[0])
                nearest, _ = oracle.nearest(float(at))
                assert nearest.distance > FREE, (time, nearest)
        oracle.close()
        assert_at_home(home)


def test_the_way_home_from_a_grasp_touches_nothing(planner: MotionPlanner) -> None:
    graph = scene((3, 1, 3))
    moves = [Move(1, 0)]
    motion = planner.solve(graph, moves, HOME_Q, OPEN)
    pick = motion.trajectory.intervals[0]
    arm = motion.trajectory.sample(pick.end)[0].arm
    home = planner.solve_way_home(motion, 0, arm, np.array([0.03, 0.03]))
    result = replay(graph, [], home, 0.0, vertical=0.03)
    assert result.free.distance > FREE, result.free
    np.testing.assert_allclose(home.trajectory.positions.arm[-1], PANDA.home)
