# SPDX-License-Identifier: Apache-2.0
"""The simulator's two controllers do what ros2_control's would, each with its own joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from sim_node.simulated_arms import PANDA
from sim_node.stock_controller import StockController, TwoControllers
from sim_node.trajectory import TrajectoryError
from sim_node.world import World

Array = NDArray[np.float64]

HOME = np.array(PANDA.home)
ARM, FINGERS = PANDA.arm_joints, PANDA.finger_joints
THERE = np.array([0.4, 0, 0, 0, 0, 0, 0.2])


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


@pytest.fixture
def controllers(world: World) -> TwoControllers:
    world.reset((("red_box",), (), ()))
    return TwoControllers(world)


def run(world: World, controllers: TwoControllers, seconds: float) -> Array:
    for _ in range(round(seconds / world.timestep)):
        controllers.update()
        world.step()
    return world.joint_state()[0]


def send(
    controller: StockController,
    positions: Sequence[Array],
    times: Sequence[float] = (0.0, 1.0),
    begins: int | None = None,
    names: Sequence[str] | None = None,
    end_velocity: float = 0.0,
) -> None:
    rates = np.zeros((len(times), len(positions[0])))
    rates[-1] = end_velocity
    controller.follow(
        names or controller.joints, np.array(times), np.array(positions), rates, begins
    )


def test_each_moves_its_own_joints_and_leaves_the_others(
    world: World, controllers: TwoControllers
) -> None:
    send(controllers.gripper, [np.full(2, 0.04), np.full(2, 0.01)])
    joints = run(world, controllers, 1.5)
    assert joints == pytest.approx([*HOME, 0.01, 0.01], abs=5e-3)
    send(controllers.arm, [HOME, HOME + THERE])
    assert controllers.arm.moving
    assert not controllers.gripper.moving
    joints = run(world, controllers, 1.5)
    assert joints == pytest.approx([*(HOME + THERE), 0.01, 0.01], abs=5e-3)


def test_with_the_same_start_they_are_in_step(world: World, controllers: TwoControllers) -> None:
    begins = world.steps + 60
    send(controllers.arm, [HOME, HOME + THERE], begins=begins)
    run(world, controllers, 0.1)
    send(controllers.gripper, [np.full(2, 0.04), np.full(2, 0.0)], begins=begins)
    steps = begins + round(0.5 / world.timestep) - world.steps
    joints = run(world, controllers, steps * world.timestep)
    assert joints[0] == pytest.approx(0.2, abs=0.02)  # half the way of both, in the middle
    assert joints[-1] == pytest.approx(0.02, abs=0.002)


def test_a_late_one_is_joined_in_its_middle(world: World, controllers: TwoControllers) -> None:
    half = round(0.5 / world.timestep)
    send(controllers.gripper, [np.full(2, 0.04), np.full(2, 0.0)], begins=world.steps - half)
    assert controllers.gripper.target()[0] == pytest.approx([0.02, 0.02])


def test_one_that_starts_later_is_gone_towards_from_the_present_state(
    world: World, controllers: TwoControllers
) -> None:
    later = world.steps + round(1.0 / world.timestep)
    send(controllers.gripper, [np.full(2, 0.02), np.full(2, 0.02)], begins=later)
    assert controllers.gripper.target()[0] == pytest.approx([0.04, 0.04], abs=1e-3)
    assert run(world, controllers, 1.2)[-2:] == pytest.approx([0.02, 0.02], abs=2e-3)


def test_a_second_one_replaces_the_first_at_once(world: World, controllers: TwoControllers) -> None:
    send(controllers.arm, [HOME, HOME + THERE])
    now = run(world, controllers, 0.5)[:7]
    send(controllers.arm, [now, now], times=(0.0, 0.3))
    assert run(world, controllers, 1.0)[:7] == pytest.approx(now, abs=0.02)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"names": (*ARM[:-1], "nobody")}, "unknown joints: nobody"),
        ({"names": (*ARM[:-1], FINGERS[0])}, f"unknown joints: {FINGERS[0]}"),
        ({"end_velocity": 0.1}, "ends while .* moves"),
        ({"times": (0.0, 0.0)}, "does not grow"),
        ({"positions": [HOME + THERE, HOME]}, "would jump by 0.4"),
        ({"positions": [HOME, HOME + 9 * THERE]}, "outside"),
        ({"times": (0.0, 0.01)}, "faster than its limit"),
    ],
)
def test_what_it_refuses_moves_nothing(
    world: World, controllers: TwoControllers, changes: dict, sentence: str
) -> None:
    with pytest.raises(TrajectoryError, match=sentence):
        send(controllers.arm, **{"positions": [HOME, HOME + THERE], **changes})
    assert not controllers.arm.moving
    assert run(world, controllers, 0.3)[:7] == pytest.approx(HOME, abs=3e-3)


def test_a_message_for_all_joints_is_for_neither(controllers: TwoControllers) -> None:
    everything = PANDA.home_positions
    for controller in (controllers.arm, controllers.gripper):
        with pytest.raises(TrajectoryError, match="allow_partial_joints_goal"):
            send(controller, [everything, everything], names=PANDA.joints)


def test_some_of_the_joints_are_refused(controllers: TwoControllers) -> None:
    with pytest.raises(TrajectoryError, match="allow_partial_joints_goal"):
        send(controllers.gripper, [np.array([0.04]), np.array([0.0])], names=FINGERS[:1])


def test_one_that_is_over_is_refused(world: World, controllers: TwoControllers) -> None:
    begins = world.steps - round(3.0 / world.timestep)
    with pytest.raises(TrajectoryError, match="it ended 2 s ago"):
        send(controllers.gripper, [np.full(2, 0.04), np.full(2, 0.0)], begins=begins)


def test_a_late_one_that_would_jump_is_refused_by_the_arm(
    world: World, controllers: TwoControllers
) -> None:
    begins = world.steps - round(0.8 / world.timestep)
    with pytest.raises(TrajectoryError, match=r"0\.8 s ago, and panda_joint1 would jump"):
        send(controllers.arm, [HOME, HOME + THERE], begins=begins)


def test_one_without_points_stops_nothing(controllers: TwoControllers) -> None:
    send(controllers.arm, [HOME, HOME + THERE])
    with pytest.raises(TrajectoryError, match="no points"):
        controllers.arm.stop()
    assert controllers.arm.moving


def test_a_reset_forgets_everything(controllers: TwoControllers) -> None:
    send(controllers.arm, [HOME, HOME + THERE])
    controllers.reset()
    assert not controllers.arm.moving
    assert controllers.target()[0] == pytest.approx(PANDA.home_positions)
