# SPDX-License-Identifier: Apache-2.0
"""The monitor against arms that do as told, late, slowly, or not at all."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from motion_scenes import EDGE, scene
from tamp_runtime.motion_report import MotionReason

from motion_node.execution.arm_state import ArmState
from motion_node.execution.monitor import Monitor, MonitorSettings, Verdict
from motion_node.execution.objections import objection
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.robots.joints import JointValues
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move

HOME = JointValues(np.array(PANDA.home), np.array([0.04, 0.04]))


@pytest.fixture(scope="module")
def trajectory(planner: MotionPlanner) -> Trajectory:
    graph = scene((2, 1, 0), np.random.default_rng(1))
    return planner.solve(graph, [Move(0, 2), Move(1, 2)], HOME.arm, HOME.fingers).trajectory


def squeezed(positions: JointValues, half: float = EDGE / 2) -> JointValues:
    """Fingers cannot close farther than the block between them."""
    return JointValues(positions.arm, np.maximum(positions.fingers, half))


def pushed(positions: JointValues, joint: int, by: float) -> JointValues:
    """One joint of the arm is elsewhere [rad]."""
    arm = positions.arm.copy()
    arm[joint] += by
    return JointValues(arm, positions.fingers)


def watch(
    trajectory: Trajectory,
    arm: Callable[[float], JointValues],
    *,
    settings: MonitorSettings | None = None,
    speed: float = 1.0,
    rate: float = 60.0,
    until: float = 200.0,
) -> tuple[Verdict, float, Monitor, list[float]]:
    """Feeds joint states until a verdict other than GOING; returns it, and its time.

    ``arm`` gives the joints at a time after sending; ``speed`` is that of the driver's clock.
    """
    monitor = Monitor(
        trajectory, ArmState(1000.0, 0.0, arm(0.0), 1.0), settings or MonitorSettings()
    )
    errors = []
    time = 0.0
    while time < until:
        time += 1.0 / rate
        verdict = monitor.update(ArmState(1000.0 + time, time / speed, arm(time), 0.0))
        errors.append(monitor.time)
        if verdict is not Verdict.GOING:
            return verdict, time, monitor, errors
    return Verdict.GOING, time, monitor, errors


@pytest.mark.parametrize("delay", [0.0, 0.1, 0.7, 2.5])
@pytest.mark.parametrize("lag", [0.0, 0.05])
def test_it_finds_when_the_arm_started(trajectory: Trajectory, delay: float, lag: float) -> None:
    verdict, time, _, times = watch(
        trajectory, lambda t: squeezed(trajectory.sample(t - delay - lag)[0])
    )
    assert verdict is Verdict.ARRIVED
    assert time == pytest.approx(trajectory.duration + delay + lag, abs=0.25)
    true = np.clip(np.arange(1, len(times) + 1) / 60 - delay - lag, 0, trajectory.duration)
    # Where the arm stands still, the time cannot be seen; it is guessed well all the same.
    assert np.abs(np.array(times) - true).max() < 0.3


@pytest.mark.parametrize("speed", [0.1, 30.0])
def test_the_speed_of_a_simulation_does_not_matter(trajectory: Trajectory, speed: float) -> None:
    delay = 0.05 * speed
    verdict, _, _, _ = watch(
        trajectory, lambda t: squeezed(trajectory.sample(t - delay)[0]), speed=speed
    )
    assert verdict is Verdict.ARRIVED


def test_an_arm_that_does_not_start_is_noticed(trajectory: Trajectory) -> None:
    verdict, time, _, _ = watch(trajectory, lambda _t: HOME)
    assert verdict is Verdict.NOT_STARTED
    assert time == pytest.approx(MonitorSettings().start_seconds, abs=0.1)


def test_an_arm_that_gets_stuck_is_noticed(trajectory: Trajectory) -> None:
    stuck = 0.4 * trajectory.duration
    verdict, time, monitor, _ = watch(
        trajectory, lambda t: squeezed(trajectory.sample(min(t, stuck))[0])
    )
    assert verdict in (Verdict.BEHIND, Verdict.OFF_THE_PATH)
    assert stuck < time < stuck + 3.5
    assert monitor.time == pytest.approx(stuck, abs=1.0)


def test_an_arm_that_is_pushed_aside_is_noticed(trajectory: Trajectory) -> None:
    def arm(t: float) -> JointValues:
        return pushed(squeezed(trajectory.sample(t)[0]), 3, 0.4 if t > 4.0 else 0.0)

    verdict, time, _, _ = watch(trajectory, arm)
    assert verdict is Verdict.OFF_THE_PATH
    assert time == pytest.approx(4.3, abs=0.1)


def test_a_short_disturbance_is_tolerated(trajectory: Trajectory) -> None:
    def arm(t: float) -> JointValues:
        return pushed(squeezed(trajectory.sample(t)[0]), 3, 0.4 if 4.0 < t < 4.2 else 0.0)

    assert watch(trajectory, arm)[0] is Verdict.ARRIVED


def test_fingers_that_close_on_nothing_are_noticed(trajectory: Trajectory) -> None:
    verdict, _, monitor, _ = watch(trajectory, lambda t: trajectory.sample(t)[0])
    assert verdict is Verdict.GRASP_LOST
    interval = trajectory.interval_at(monitor.time)
    assert interval is trajectory.intervals[2]
    assert monitor.time < interval.start + 0.3


def test_a_block_that_slips_on_the_way_is_noticed(trajectory: Trajectory) -> None:
    travel = trajectory.intervals[2]
    slip = (travel.start + travel.end) / 2

    def arm(t: float) -> JointValues:
        joints = trajectory.sample(t)[0]
        return squeezed(joints) if t < slip else joints

    verdict, time, _, _ = watch(trajectory, arm)
    assert verdict is Verdict.GRASP_LOST
    assert time == pytest.approx(slip + 0.1, abs=0.08)


@pytest.mark.parametrize("error", [-0.006, 0.006])
def test_a_wrong_guess_of_the_blocks_size_is_no_lost_grasp(
    trajectory: Trajectory, error: float
) -> None:
    def arm(t: float) -> JointValues:
        return squeezed(trajectory.sample(t)[0], EDGE / 2 + error)

    assert watch(trajectory, arm)[0] is Verdict.ARRIVED


def test_an_arm_that_stops_short_of_the_end_is_noticed(trajectory: Trajectory) -> None:
    def arm(t: float) -> JointValues:
        short = 0.05 if t > trajectory.duration - 0.1 else 0.0
        return pushed(squeezed(trajectory.sample(t)[0]), 1, short)

    assert watch(trajectory, arm)[0] is Verdict.NOT_ARRIVED


def test_a_clock_that_goes_back_is_noticed(trajectory: Trajectory) -> None:
    monitor = Monitor(trajectory, ArmState(100.0, 0.0, HOME, 1.0), MonitorSettings())
    assert monitor.update(ArmState(100.1, 0.1, HOME, 1.0)) is Verdict.GOING
    assert monitor.update(ArmState(0.0, 0.2, HOME, 0.0)) is Verdict.CLOCK_WENT_BACK


def carrying(trajectory: Trajectory) -> float:
    """A time in the middle of the first way with a block."""
    way = trajectory.intervals[2]
    assert way.holding
    return (way.start + way.end) / 2


@pytest.mark.parametrize("start", [0.2, 2.0, 5.0, 8.0])
@pytest.mark.parametrize("seconds", [1.0, 5.0])
def test_fault_3_joint_states_that_were_lost_for_a_while_do_no_harm(
    trajectory: Trajectory, start: float, seconds: float
) -> None:
    """The arm went on meanwhile; news come in one leap."""
    monitor = Monitor(trajectory, ArmState(1000.0, 0.0, HOME, 1.0), MonitorSettings())
    for time in np.arange(0.0, trajectory.duration + 6.0, 1 / 60):
        if start < time < start + seconds:
            continue
        joints = squeezed(trajectory.sample(time - 0.05)[0])
        verdict = monitor.update(ArmState(1000.0 + time, time, joints, 0.0))
        if verdict is not Verdict.GOING:
            break
    assert verdict is Verdict.ARRIVED


def test_an_arm_that_may_have_come_and_gone_unseen_is_not_said_not_to_have_started(
    trajectory: Trajectory,
) -> None:
    monitor = Monitor(trajectory, ArmState(1000.0, 0.0, HOME, 1.0), MonitorSettings())
    verdict, time = Verdict.GOING, 60.0
    while verdict is Verdict.GOING:
        time += 1 / 60
        verdict = monitor.update(ArmState(1000.0 + time, time, HOME, time))
    assert verdict is Verdict.UNSEEN


@pytest.mark.parametrize("share", np.arange(0.07, 0.93, 0.03))
@pytest.mark.parametrize("delay", [0.0, 0.4])
def test_fault_3_an_arm_that_set_out_unseen_is_found_on_its_way(
    trajectory: Trajectory, share: float, delay: float
) -> None:
    heard_again = share * trajectory.duration

    def arm(t: float) -> JointValues:
        return squeezed(trajectory.sample(max(t - delay, 0.0))[0])

    monitor = Monitor(trajectory, ArmState(1000.0, 0.0, HOME, 0.0), MonitorSettings())
    verdict, time = Verdict.GOING, heard_again
    while verdict is Verdict.GOING:
        verdict = monitor.update(ArmState(1000.0 + time, time, arm(time), 0.0))
        if heard_again + 2.0 < time < trajectory.duration:
            assert monitor.time == pytest.approx(time - delay, abs=0.3)
        time += 1.0 / 60.0
    assert verdict is Verdict.ARRIVED


def test_silence_does_not_make_a_short_disturbance_long(trajectory: Trajectory) -> None:
    monitor = Monitor(trajectory, ArmState(1000.0, 0.0, HOME, 1.0), MonitorSettings())
    for time in np.arange(0.0, trajectory.duration - 0.1, 1 / 60):
        if 4.05 < time < 6.0:
            continue
        disturbed = 0.4 if 4.0 < time < 6.05 else 0.0
        joints = pushed(squeezed(trajectory.sample(time)[0]), 3, disturbed)
        assert monitor.update(ArmState(1000.0 + time, time, joints, 0.0)) is Verdict.GOING


def test_fault_4_fingers_that_do_not_open_on_the_way_to_a_block_are_noticed(
    trajectory: Trajectory,
) -> None:
    closed = np.zeros(2)
    verdict, time, monitor, _ = watch(
        trajectory, lambda t: JointValues(trajectory.sample(t)[0].arm, closed)
    )
    assert verdict is Verdict.NOT_OPENED
    assert time < trajectory.intervals[0].end
    state = ArmState(1000.0 + time, time, JointValues(HOME.arm, closed), 0.0)
    phase = trajectory.interval_at(monitor.time).phase
    error = objection(verdict, phase, monitor.block, state)
    assert error.reason is MotionReason.GRASP_LOST
    assert "the fingers do not open: they stand 0 mm apart" in str(error)
    assert phase.object_name in str(error)


def test_fault_13_joint_states_without_stamps_are_named_where_they_may_mislead(
    trajectory: Trajectory,
) -> None:
    for stamped in (True, False):
        state = ArmState(1000.0, 1000.0, HOME, 0.0, stamped)
        error = objection(Verdict.OFF_THE_PATH, trajectory.intervals[0].phase, None, state)
        assert ("no time stamps" in str(error)) is not stamped


def test_fault_4_fingers_that_do_not_close_are_noticed(trajectory: Trajectory) -> None:
    verdict, time, monitor, _ = watch(
        trajectory, lambda t: JointValues(trajectory.sample(t)[0].arm, HOME.fingers)
    )
    assert verdict is Verdict.NOT_CLOSED
    assert time < trajectory.interval_at(carrying(trajectory)).end
    assert monitor.block is not None
    assert monitor.block.object_name == "green_box"


def test_fault_4_fingers_that_do_not_open_are_noticed(trajectory: Trajectory) -> None:
    middle, half = carrying(trajectory), np.full(2, EDGE / 2)

    def arm(t: float) -> JointValues:
        joints = squeezed(trajectory.sample(t)[0])
        return JointValues(joints.arm, half) if t > middle else joints

    verdict, _, monitor, _ = watch(trajectory, arm)
    assert verdict is Verdict.NOT_OPENED
    assert monitor.trajectory.interval_at(monitor.time) is trajectory.intervals[4]
    assert monitor.block is not None
    assert (monitor.block.object_name, monitor.block.move) == ("green_box", 0)


def test_fingers_that_move_late_are_no_fault(trajectory: Trajectory) -> None:
    def arm(t: float) -> JointValues:
        fingers = trajectory.sample(t - 0.3)[0].fingers
        return squeezed(JointValues(trajectory.sample(t)[0].arm, fingers))

    assert watch(trajectory, arm)[0] is Verdict.ARRIVED
