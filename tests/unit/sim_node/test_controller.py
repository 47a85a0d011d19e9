# SPDX-License-Identifier: Apache-2.0
"""The simulated arm follows a trajectory within its torques, and does not move for a bad one."""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from sim_node.controller import ArmController
from sim_node.simulated_arms import PANDA
from sim_node.trajectory import TrajectoryError
from sim_node.world import World

HOME = PANDA.home_positions
JOINTS = PANDA.joints
IS_ARM = np.isin(JOINTS, PANDA.arm_joints)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


def reach(world: World, arm: ArmController, seconds: float) -> float:
    """Runs, and returns the largest tracking error of the arm's joints [rad]."""
    worst = 0.0
    for _ in range(round(seconds / world.timestep)):
        arm.update()
        target = arm.target()[0]
        world.step()
        worst = max(worst, float(np.abs(world.joint_state()[0] - target)[IS_ARM].max()))
    return worst


def test_it_follows_a_smooth_trajectory_closely_and_stays_at_its_end(world: World) -> None:
    world.reset((("red_box",), (), ()))
    arm = ArmController(world)
    goal = HOME + [0.5, 0.3, -0.3, -0.2, 0.2, 0.3, 0.4, -0.02, -0.02]
    arm.follow(JOINTS, np.array([0.0, 1.5]), np.array([HOME, goal]), np.zeros((2, 9)))
    assert arm.moving
    assert reach(world, arm, 2.0) < 0.02
    assert not arm.moving
    assert world.joint_state()[0] == pytest.approx(goal, abs=5e-3)


def test_a_refused_trajectory_moves_nothing(world: World) -> None:
    world.reset((("red_box",), (), ()))
    arm = ArmController(world)
    far = np.array([HOME + [0.5, *[0.0] * 8], HOME])
    with pytest.raises(TrajectoryError, match="would jump"):
        arm.follow(JOINTS, np.array([0.0, 1.0]), far, None)
    reach(world, arm, 0.5)
    assert world.joint_state()[0] == pytest.approx(HOME, abs=2e-3)


def test_stop_holds_the_arm_where_it_is(world: World) -> None:
    world.reset((("red_box",), (), ()))
    arm = ArmController(world)
    goal = HOME + [0.8, 0, 0, 0, 0, 0, 0, 0, 0]
    arm.follow(JOINTS, np.array([0.0, 2.0]), np.array([HOME, goal]), np.zeros((2, 9)))
    reach(world, arm, 1.0)
    arm.stop()
    held = world.joint_state()[0]
    reach(world, arm, 1.0)
    assert not arm.moving
    assert abs(world.joint_state()[0][0] - held[0]) < 0.02


def test_a_trajectory_begins_at_its_step_and_not_before(world: World) -> None:
    world.reset((("red_box",), (), ()))
    arm = ArmController(world)
    goal = HOME + [0.2, *[0.0] * 8]
    begins = world.steps + 120
    arm.follow(JOINTS, np.array([0.0, 1.0]), np.array([HOME, goal]), None, begins)
    reach(world, arm, 0.5)
    assert world.joint_state()[0] == pytest.approx(HOME, abs=2e-3)
    reach(world, arm, 1.5)
    assert world.joint_state()[0] == pytest.approx(goal, abs=5e-3)
    with pytest.raises(TrajectoryError, match=r"it ended 1\.5 s ago"):
        arm.follow(JOINTS, np.array([0.0, 0.5]), np.array([goal, goal]), None, begins - 120)
    assert not arm.moving


def test_a_trajectory_that_has_begun_is_joined_in_its_midst_if_the_arm_is_there(
    world: World,
) -> None:
    world.reset((("red_box",), (), ()))
    arm = ArmController(world)
    goal = HOME + [0.5, *[0.0] * 8]
    times, way, began = np.array([0.0, 2.0]), np.array([HOME, goal]), world.steps
    arm.follow(JOINTS, times, way, np.zeros((2, 9)))
    reach(world, arm, 1.0)
    # The rest of the same way, cut where the arm was half a second ago; so late it comes.
    before, rate = CubicHermiteSpline(times, way, np.zeros((2, 9))), np.zeros((2, 9))
    rate[0] = before(0.5, 1)
    rest = np.array([before(0.5), goal])
    begins = began + round(0.5 / world.timestep)
    with pytest.raises(TrajectoryError, match="joint1 would jump"):
        arm.follow(JOINTS, np.array([0.0, 1.5]), rest, rate)
    arm.follow(JOINTS, np.array([0.0, 1.5]), rest, rate, begins)
    assert arm.target()[0] == pytest.approx(before(1.0), abs=0.01)
    assert reach(world, arm, 1.5) < 0.02
    assert world.joint_state()[0] == pytest.approx(goal, abs=5e-3)

    with pytest.raises(TrajectoryError, match=r"to start 1 s ago, and .*joint1 would jump"):
        late = world.steps - round(1.0 / world.timestep)
        arm.follow(JOINTS, np.array([0.0, 2.0]), way[::-1], None, late)
    assert not arm.moving
