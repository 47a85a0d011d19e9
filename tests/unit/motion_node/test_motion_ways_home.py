# SPDX-License-Identifier: Apache-2.0
"""Ways home from anywhere, with a block in the hand or none, judged by collision distances."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from collision_oracle import CollisionOracle, switches
from motion_scenes import EDGE, random_heights, random_moves, scene

from motion_node.errors import InfeasibleError
from motion_node.phases import PLACE
from motion_node.planner import Motion, MotionPlanner
from motion_node.robots import PANDA
from motion_node.robots.joints import JointValues
from motion_node.timing.trajectory import Interval, Trajectory
from scene_graph import Move, SceneGraph

HOME_Q = np.array(PANDA.home)
OPEN = np.array([0.04, 0.04])
#: The arm, and what it carries, keep this distance from what they must not touch [m].
FREE = 0.006


class Plan:
    """A plan of three moves and its motion."""

    def __init__(self, planner: MotionPlanner, seed: int) -> None:
        self.planner, self.rng = planner, np.random.default_rng(seed)
        self.graph: SceneGraph = scene(random_heights(self.rng, 6), self.rng)
        self.moves: list[Move] = random_moves(self.graph, 3, self.rng)
        self.motion: Motion = planner.solve(self.graph, self.moves, HOME_Q, OPEN)

    def ways(self, holding: bool) -> Iterator[tuple[Interval, float]]:
        """A time on each way with, or without, a block."""
        for interval in self.motion.trajectory.intervals:
            if interval.holding == holding and not interval.gripping:
                share = self.rng.uniform(0.02, 0.98)
                yield interval, interval.start + share * (interval.end - interval.start)

    def assert_free(self, until: float, way: Trajectory) -> None:
        """Of a way that begins where the plan's trajectory is at a time."""
        oracle = CollisionOracle(self.graph)
        gap = self.planner.settings.phases.place_gap
        switches(oracle, self.moves, self.motion, gap, until)
        here = self.motion.trajectory.sample(until)[0]
        start = JointValues(here.arm, np.full(2, EDGE / 2) if oracle.held else here.fingers)
        oracle.take_up(start)
        for at in np.arange(0.0, way.duration, 0.04):
            interval, joints = way.interval_at(at), way.sample(at)[0]
            if interval.gripping:
                if oracle.held and at > interval.end - 0.05:
                    oracle.release(oracle.held[0], self.moves[interval.phase.move], gap)
                continue
            if oracle.held:
                joints = JointValues(joints.arm, np.full(2, EDGE / 2))
            oracle.take_up(joints)
            robot, carried = oracle.nearest(float(at))
            assert robot.distance > FREE, (until, robot)
            switch = interval.phase.switch
            x, y, z = oracle.hand_pose()[0]
            standing = z < (switch.position_world[2] + 0.14 if switch else 0.0) and (
                np.hypot(*np.subtract((x, y), switch.position_world[:2])) < 0.01
                if switch
                else False
            )
            # It may have been taken from, or be put down on, what it touches.
            if oracle.held and not standing and at > 0.3:
                assert carried.distance > FREE / 2, (until, carried)
        end = way.positions[-1]
        np.testing.assert_allclose(end.arm, HOME_Q, atol=1e-6)
        oracle.close()


@pytest.mark.parametrize("seed", range(3))
def test_fault_2_a_block_is_put_down_from_anywhere_on_its_way(
    planner: MotionPlanner, seed: int
) -> None:
    plan = Plan(planner, seed)
    for interval, time in plan.ways(holding=True):
        move = interval.phase.move
        arm = plan.motion.trajectory.sample(time)[0].arm
        down = planner.solve_put_down(plan.motion, move, arm).trajectory
        plan.assert_free(time, down)
        opening = next(i for i in down.intervals if i.gripping)
        there, _ = down.sample(np.array([opening.start, opening.end]))
        switch = next(
            p.switch for p in plan.motion.phases if (p.kind, p.move) == (PLACE, move) and p.switch
        )
        assert planner.model.hand_at(there.arm[0])[0] == pytest.approx(
            switch.position_world, abs=1e-3
        )
        pressing = interval.phase.tool.finger
        np.testing.assert_allclose(down.sample(np.linspace(0, opening.start))[0].fingers, pressing)
        np.testing.assert_allclose(there.fingers[1], EDGE / 2 + planner.timing.finger_room)
        np.testing.assert_allclose(down.positions.fingers[-1], OPEN)


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_fault_2_an_arm_rises_above_what_it_does_not_know(
    planner: MotionPlanner, seed: int, known: bool
) -> None:
    plan = Plan(planner, seed)
    motion = plan.motion if known else None
    for holding in (True, False):
        for interval, time in plan.ways(holding):
            here = plan.motion.trajectory.sample(time)[0]
            held = interval.phase.tool.held
            fingers = np.full(2, EDGE / 2) if held else here.fingers
            way = planner.solve_rise_home(motion, here.arm, fingers, held).trajectory
            plan.assert_free(time, way)
            last = way.positions[-1].fingers
            np.testing.assert_allclose(last, way.positions[0].fingers if held else OPEN, atol=1e-4)
            assert (last < EDGE / 2).all() == bool(held)


def test_a_block_that_the_plan_does_not_place_cannot_be_put_down(planner: MotionPlanner) -> None:
    plan = Plan(planner, 0)
    with pytest.raises(InfeasibleError, match="a place for the block"):
        planner.solve_put_down(plan.motion, 7, HOME_Q)
