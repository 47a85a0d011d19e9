# SPDX-License-Identifier: Apache-2.0
"""Arms of another structure: no part of the planner counts seven joints."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from collision_oracle import replay
from motion_scenes import scene

from motion_node.planner import Motion, MotionPlanner
from motion_node.robots import PANDA, Arm
from motion_node.robots.joints import JointValues
from scene_graph import Move

WELDED = 2


def six_joints(urdf: str) -> tuple[str, Arm]:
    """The Panda with its third joint welded, which leaves it no elbow to swing."""
    name = PANDA.arm_joints[WELDED]
    text = re.sub(rf'(<joint name="{name}" type=)"revolute"', r'\1"fixed"', urdf)
    assert text != urdf

    def rest(values: tuple[Any, ...]) -> tuple[Any, ...]:
        return values[:WELDED] + values[WELDED + 1 :]

    return text, replace(
        PANDA,
        name="six",
        arm_joints=rest(PANDA.arm_joints),
        home=rest(PANDA.home),
        acceleration=rest(PANDA.acceleration),
    )


def as_panda(motion: Motion) -> Motion:
    """The same motion with the welded joint at 0."""
    trajectory = motion.trajectory

    def with_welded(values: JointValues) -> JointValues:
        return JointValues(np.insert(values.arm, WELDED, 0.0, axis=1), values.fingers)

    positions, velocities = map(with_welded, (trajectory.positions, trajectory.velocities))
    return replace(
        motion, trajectory=replace(trajectory, positions=positions, velocities=velocities)
    )


def test_an_arm_of_six_joints_moves_blocks_and_touches_nothing(urdf: str) -> None:
    planner = MotionPlanner(*six_joints(urdf))
    graph, moves = scene((2, 1, 0)), [Move(0, 2), Move(1, 2)]
    motion = planner.solve(graph, moves, planner.model.home, np.array([0.04, 0.04]))
    assert motion.trajectory.positions.arm.shape[1] == 6
    result = replay(
        graph, moves, as_panda(motion), planner.settings.phases.place_gap, vertical=0.03
    )
    assert result.free.distance > 0.008, result.free


def test_only_an_arm_with_a_joint_to_spare_moves_without_moving_its_hand(
    urdf: str, planner: MotionPlanner
) -> None:
    rng = np.random.default_rng(3)
    for which in (planner, MotionPlanner(*six_joints(urdf))):
        q = which.model.home + rng.uniform(-0.3, 0.3, (4, which.model.dimension))
        directions = which.inverse.self_motion(q)
        spare = which.model.dimension > 6
        for one, direction in zip(q, directions):
            assert np.linalg.norm(direction) == pytest.approx(1.0 if spare else 0.0)
            before, after = (which.model.hand_at(x)[0] for x in (one, one + 1e-5 * direction))
            assert np.linalg.norm(after - before) < 1e-8
