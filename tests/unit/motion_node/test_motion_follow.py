# SPDX-License-Identifier: Apache-2.0
"""The follower with an arm that obeys, and with arms that do not."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_arm import OPEN, SQUEEZED, SimulatedArm, two_moves
from tamp_runtime.motion_report import MotionReason

from motion_node.execution.errors import ExecutionError
from motion_node.execution.follow import Follower
from motion_node.execution.settings import ExecutionSettings
from motion_node.phases import HOME, PICK, PLACE
from motion_node.robots.joints import JointValues


@pytest.fixture
def arm() -> SimulatedArm:
    return SimulatedArm()


@pytest.fixture
def follower(arm: SimulatedArm) -> Follower:
    """At rest, with an arm that was heard of."""
    follower = Follower(arm, arm.send, ExecutionSettings())
    assert follower.wait_for_rest(lambda: False) is not None
    return follower


def test_an_arm_that_obeys_arrives(arm: SimulatedArm, follower: Follower) -> None:
    trajectory = two_moves()
    heard: list[float] = []
    assert follower.follow(trajectory, lambda _trajectory, at: heard.append(at))
    assert arm.at_home()
    assert heard[-1] == trajectory.duration
    assert np.diff(heard).min() > -0.1


def test_rest_takes_its_time(arm: SimulatedArm) -> None:
    trajectory = two_moves()
    arm.send(trajectory)
    state = Follower(arm, arm.send, ExecutionSettings()).wait_for_rest(lambda: False)
    assert state is not None
    assert state.resting >= ExecutionSettings().rest_seconds
    assert state.stamp > 50.0 + trajectory.duration
    assert arm.at_home()


def test_an_arm_that_shakes_is_one_whose_states_cannot_be_used(arm: SimulatedArm) -> None:
    arm.trembling = 0.01
    with pytest.raises(ExecutionError, match="the joints shake by") as caught:
        Follower(arm, arm.send, ExecutionSettings()).wait_for_rest(lambda: False)
    assert caught.value.reason is MotionReason.NO_JOINT_STATES


def test_an_arm_that_never_rests_is_reported(arm: SimulatedArm) -> None:
    def creep() -> bool:
        arm.joints = JointValues(arm.joints.arm + 0.003, arm.joints.fingers)
        return False

    arm.when(creep, lambda: None)
    with pytest.raises(ExecutionError, match="does not come to rest") as caught:
        Follower(arm, arm.send, ExecutionSettings()).wait_for_rest(lambda: False)
    assert caught.value.reason is MotionReason.TIMEOUT


def test_waiting_for_rest_can_be_stopped(arm: SimulatedArm) -> None:
    assert Follower(arm, arm.send, ExecutionSettings()).wait_for_rest(lambda: True) is None


def test_states_of_long_ago_do_not_count(arm: SimulatedArm, follower: Follower) -> None:
    arm.silent = True
    arm.pass_time(ExecutionSettings().joint_state_timeout + 1.0)
    with pytest.raises(ExecutionError, match="no joint_states") as caught:
        follower.wait_for_rest(lambda: False)
    assert caught.value.reason is MotionReason.NO_JOINT_STATES


def test_an_arm_that_moved_since_is_not_sent_out(arm: SimulatedArm, follower: Follower) -> None:
    start = np.array([0.2, 0.0])
    with pytest.raises(ExecutionError, match="has moved while"):
        follower.follow(two_moves(start))
    assert not arm.sent


def test_joint_states_that_stop_end_it(arm: SimulatedArm, follower: Follower) -> None:
    arm.when(lambda: follower.time > 2.0, lambda: setattr(arm, "silent", True))
    with pytest.raises(ExecutionError, match="no joint_states") as caught:
        follower.follow(two_moves())
    assert caught.value.reason is MotionReason.NO_JOINT_STATES
    assert not caught.value.recoverable
    assert "goes on along its trajectory, which ends at home" in str(caught.value)


def test_a_clock_that_stands_still_ends_it(arm: SimulatedArm, follower: Follower) -> None:
    arm.when(lambda: follower.time > 1.0, lambda: setattr(arm, "frozen_clock", True))
    with pytest.raises(ExecutionError, match="time has stood still") as caught:
        follower.follow(two_moves())
    assert caught.value.reason is MotionReason.TIMEOUT


def test_an_execution_that_takes_for_ever_ends(arm: SimulatedArm, follower: Follower) -> None:
    arm.slowness = 100.0
    with pytest.raises(ExecutionError, match="takes longer than") as caught:
        follower.follow(two_moves())
    assert caught.value.reason is MotionReason.TIMEOUT


def test_an_arm_that_refuses_is_reported(arm: SimulatedArm, follower: Follower) -> None:
    arm.deaf = True
    with pytest.raises(ExecutionError, match="does not start") as caught:
        follower.follow(two_moves())
    assert caught.value.reason is MotionReason.TRACKING_LOST
    assert caught.value.recoverable


def test_a_trajectory_that_comes_late_is_waited_for(arm: SimulatedArm, follower: Follower) -> None:
    told: list[str] = []
    follower.on_waiting = told.append
    arm.lag = 6.0
    assert follower.follow(two_moves())
    assert len(arm.sent) == 1
    assert told == ["the arm has not set out yet", ""]


def test_an_arm_that_is_stuck_is_held_where_it_is_and_presses_on(
    arm: SimulatedArm, follower: Follower
) -> None:
    carrying = two_moves().intervals[2]
    middle = (carrying.start + carrying.end) / 2
    arm.when(lambda: follower.time > middle, lambda: setattr(arm, "stuck", True))
    with pytest.raises(ExecutionError, match="place of green_box") as caught:
        follower.follow(two_moves())
    assert caught.value.recoverable
    assert (follower.grip.held, follower.grip.move) == ("green_box", 0)
    hold, where = arm.sent[-1]
    np.testing.assert_allclose(hold.positions.arm, [where.arm, where.arm])
    np.testing.assert_allclose(hold.positions.fingers, SQUEEZED)
    assert not hold.velocities.arm.any()


def test_a_stuck_empty_hand_can_be_sent_home(arm: SimulatedArm, follower: Follower) -> None:
    arm.when(lambda: follower.time > 0.3, lambda: setattr(arm, "stuck", True))
    with pytest.raises(ExecutionError, match="pick of green_box") as caught:
        follower.follow(two_moves())
    assert caught.value.recoverable


def test_a_lost_block_is_named(arm: SimulatedArm, follower: Follower) -> None:
    arm.block = 0.0
    with pytest.raises(ExecutionError, match="green_box") as caught:
        follower.follow(two_moves())
    assert caught.value.reason is MotionReason.GRASP_LOST
    assert caught.value.recoverable


def test_it_returns_when_stopped_and_brakes_on_the_path(
    arm: SimulatedArm, follower: Follower
) -> None:
    trajectory = two_moves()
    assert not follower.follow(trajectory, stopped=lambda: follower.time > 0.4)
    assert follower.interval.phase.kind == PICK
    state = follower.brake()
    brake, where = arm.sent[-1]
    assert brake.duration == pytest.approx(ExecutionSettings().brake_seconds)
    # It starts a little ahead of where the arm was, and ends on the path.
    assert np.abs(brake.positions.arm[0] - where.arm).max() < 0.1
    path = trajectory.sample(np.linspace(0.0, trajectory.intervals[0].end, 500))[0].arm
    assert np.abs(path - state.positions.arm).max(axis=1).min() < 0.01
    np.testing.assert_allclose(state.positions.arm, brake.positions.arm[-1], atol=1e-3)


def test_an_arm_that_does_not_brake_is_reported(arm: SimulatedArm, follower: Follower) -> None:
    follower.follow(two_moves(), stopped=lambda: follower.time > 0.4)
    arm.trembling = 0.01
    with pytest.raises(ExecutionError, match="does not stop") as caught:
        follower.brake()
    assert caught.value.reason is MotionReason.TRACKING_LOST


def test_the_hand_is_empty_until_a_block_is_held_and_once_it_is_let_go(
    arm: SimulatedArm, follower: Follower
) -> None:
    seen: list[tuple[str, bool, bool]] = []

    def note(_trajectory: object, _time: float) -> None:
        interval = follower.interval
        entry = (interval.phase.kind, interval.gripping, follower.empty_handed)
        if not seen or seen[-1] != entry:
            seen.append(entry)

    follower.follow(two_moves(), note)
    once = [
        (PICK, False, True),
        (PICK, True, True),
        (PLACE, False, False),
        (PLACE, True, False),
        (PLACE, True, True),
    ]
    assert seen == [*once, *once, (HOME, False, True)]
    np.testing.assert_allclose(arm.joints.fingers, OPEN)


@pytest.mark.parametrize("block", [0.0, 0.02])
def test_fingers_that_are_told_late_to_close_are_not_taken_for_held_apart(
    arm: SimulatedArm, follower: Follower, block: float
) -> None:
    arm.joints = JointValues(arm.joints.arm, np.full(2, 0.02))
    arm.block, arm.lag = block, 1.5
    arm.pass_time(0.1)
    state = follower.wait_for_rest(lambda: False)
    assert state is not None
    assert follower.feel(state) == (block > 0.0)
