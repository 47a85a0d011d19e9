# SPDX-License-Identifier: Apache-2.0
"""What an arm does that was stopped by a fault: what it holds is put down, and it goes home."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from executive_bench import Bench
from simulated_arm import BESIDE, BLOCKS, HALF_BLOCK, OPEN, SQUEEZED, SWITCHES, two_moves
from tamp_runtime.motion_report import SOMETHING, ArmPlace, MotionReason, MotionState

from motion_node.errors import InfeasibleError
from motion_node.execution.plan import Plan
from motion_node.phases import PICK, PLACE
from motion_node.robots.joints import JointValues
from scene_graph import SceneGraph

TIDY = Plan("tidy", SceneGraph((), frozenset()), (), ())
ELSEWHERE = np.array([0.5, -0.3])
CARRYING = two_moves().intervals[2]
MIDDLE = (CARRYING.start + CARRYING.end) / 2


@pytest.fixture
def bench() -> Iterator[Bench]:
    yield Bench()


def put(bench: Bench, arm: np.ndarray, fingers: float) -> None:
    """The arm is there, and nobody has sent it."""
    bench.arm.joints = JointValues(arm.copy(), np.full(2, fingers))
    bench.arm.pass_time(1.0)


def assert_tidy(bench: Bench) -> None:
    assert bench.arm.at_home()
    np.testing.assert_allclose(bench.arm.joints.fingers, OPEN, atol=1e-3)
    assert bench.condition.is_tidy


def assert_put_down_where_it_was_to_go(bench: Bench, move: int) -> None:
    """The fingers opened there after they had been closed until then."""
    way = bench.arm.sent[-1][0]
    opening = next(i for i in way.intervals if i.gripping)
    there, _ = way.sample(np.array([opening.start, opening.end]))
    np.testing.assert_allclose(there.arm, [SWITCHES[2 * move + 1]] * 2, atol=1e-6)
    np.testing.assert_allclose(there.fingers[:, 0], [SQUEEZED, BESIDE], atol=1e-6)
    np.testing.assert_allclose(way.sample(0.0)[0].fingers, SQUEEZED, atol=1e-6)


def test_fault_2_a_block_in_hand_is_put_down_when_the_trajectory_ends_early(bench: Bench) -> None:
    bench.arm.cut_at = MIDDLE
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    cause, rest = end.message.split("; ", 1)
    assert cause.startswith(("the arm falls behind", "the arm has left"))
    assert rest.endswith("green_box was put down on stack2 and the arm is home")
    assert (end.arm, end.held, end.moves_done) == (ArmPlace.HOME, "", 1)
    assert bench.planner.put_downs == [0]
    assert_put_down_where_it_was_to_go(bench, 0)
    assert_tidy(bench)


def test_fault_2_an_arm_that_is_held_for_a_while_puts_its_block_down(bench: Bench) -> None:
    bench.when(PLACE, 1, lambda: setattr(bench.arm, "stuck", True))
    bench.arm.when(lambda: len(bench.arm.sent) > 1, lambda: setattr(bench.arm, "stuck", False))
    end = bench.carry_out()
    assert "blue_box was put down on stack2" in end.message
    assert end.moves_done == 2
    assert_tidy(bench)


def test_fault_2_frozen_joint_states_end_with_the_arm_home_once_they_go_on(bench: Bench) -> None:
    def freeze() -> None:
        bench.arm.frozen = True
        thaw = bench.arm.now() + 5.0
        bench.arm.when(lambda: bench.arm.now() > thaw, lambda: setattr(bench.arm, "frozen", False))

    bench.when(PLACE, 0, freeze)
    end = bench.carry_out()
    assert end.reason is MotionReason.TRACKING_LOST
    assert end.message.endswith("the arm is home")
    assert (end.arm, end.held) == (ArmPlace.HOME, "")
    assert_tidy(bench)


def test_fault_2_a_block_that_cannot_be_put_down_is_carried_home_and_named(bench: Bench) -> None:
    bench.arm.cut_at = MIDDLE
    bench.planner.errors["solve_put_down"] = InfeasibleError("path", "clearance to stack1")
    end = bench.carry_out()
    assert end.reason is MotionReason.TRACKING_LOST
    assert "the arm is home and holds green_box, which could not be put down" in end.message
    assert "stack1" in end.message
    assert (end.arm, end.held) == (ArmPlace.HOME, BLOCKS[0])
    assert bench.planner.rises == [BLOCKS[0]]


def test_fault_2_a_block_lost_while_it_is_put_down_is_named(bench: Bench) -> None:
    bench.arm.cut_at = MIDDLE
    bench.arm.when(lambda: bool(bench.planner.put_downs), lambda: setattr(bench.arm, "block", 0.0))
    end = bench.carry_out()
    assert end.message.endswith("green_box was lost on the way and the arm is home")
    assert end.moves_done == 0
    assert_tidy(bench)


def test_fault_2_a_plan_without_moves_brings_home_an_arm_that_was_left_somewhere(
    bench: Bench,
) -> None:
    put(bench, ELSEWHERE, OPEN)
    assert bench.condition.place is ArmPlace.RESTING
    end = bench.carry_out(TIDY)
    assert (end.plan_id, end.state, end.message) == (
        "tidy", MotionState.CANCELLED, "the arm is home",
    )  # fmt: skip
    assert {report.state for report in bench.reports[:-1]} == {MotionState.EXECUTING}
    assert bench.planner.rises == [""]
    assert_tidy(bench)


def test_fault_2_what_was_left_in_the_hand_is_put_down_on_request(bench: Bench) -> None:
    """The joint states went for good, the trajectory ended early, and they came again."""
    bench.arm.cut_at = MIDDLE
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "silent", True))
    end = bench.carry_out()
    assert end.reason is MotionReason.NO_JOINT_STATES
    assert "The arm goes on along its trajectory, which ends at home" in end.message
    assert (end.arm, end.held) == (ArmPlace.UNKNOWN, BLOCKS[0])
    bench.arm.silent = False
    end = bench.carry_out(TIDY)
    assert end.state is MotionState.CANCELLED
    assert end.message == "green_box was put down on stack2 and the arm is home"
    assert_tidy(bench)


@pytest.mark.parametrize(("share", "put_downs"), [(0.1, [1]), (0.5, [])])
def test_fault_2_a_block_of_which_the_name_is_not_certain_any_more_is_not_put_down(
    bench: Bench, share: float, put_downs: list[int]
) -> None:
    """Unseen, the arm went on to the second move, and was stopped with another block in hand.

    Where the ways of both blocks run side by side, it might be either.
    """
    later = two_moves().intervals[6]
    bench.arm.cut_at = later.start + share * (later.end - later.start)
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "silent", True))
    assert bench.carry_out().reason is MotionReason.NO_JOINT_STATES
    bench.arm.silent = False
    end = bench.carry_out(TIDY)
    assert bench.planner.put_downs == put_downs
    held = "" if put_downs else SOMETHING
    assert (end.state.name, end.held) == ("CANCELLED" if put_downs else "FAILED", held)
    assert end.arm is ArmPlace.HOME


def test_fault_2_something_in_the_hand_after_a_restart_is_carried_home(bench: Bench) -> None:
    put(bench, ELSEWHERE, HALF_BLOCK)
    assert bench.condition.held() == SOMETHING
    end = bench.carry_out(TIDY)
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.GRASP_LOST)
    assert "something that this node did not pick" in end.message
    assert "open the gripper" in end.message
    assert (end.arm, end.held) == (ArmPlace.HOME, SOMETHING)
    assert bench.planner.rises == [SOMETHING]
    assert not bench.planner.put_downs


def test_fingers_that_stand_half_open_around_nothing_are_found_out(bench: Bench) -> None:
    bench.arm.block = 0.0
    put(bench, ELSEWHERE, 0.02)
    assert bench.condition.held() == SOMETHING
    end = bench.carry_out(TIDY)
    assert (end.state, end.held, end.arm) == (MotionState.CANCELLED, "", ArmPlace.HOME)
    assert bench.planner.rises == [""]


def test_a_plan_is_carried_out_though_the_fingers_stood_half_open(bench: Bench) -> None:
    bench.arm.block = 0.0
    put(bench, np.zeros(2), 0.02)
    bench.arm.when(lambda: bool(bench.planner.asked), lambda: setattr(bench.arm, "block", 0.0225))
    assert bench.carry_out().state is MotionState.SUCCEEDED


def test_a_plan_that_finds_a_block_in_the_hand_puts_it_down_and_asks_to_look_again(
    bench: Bench,
) -> None:
    bench.arm.cut_at = MIDDLE
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "silent", True))
    bench.carry_out()
    bench.arm.silent = False
    bench.planner.asked.clear()
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    assert "the hand held green_box" in end.message
    assert "put down on stack2" in end.message
    assert end.moves_done == 0
    assert not bench.planner.asked
    assert_tidy(bench)


def test_an_arm_that_is_home_with_an_empty_hand_has_nothing_to_tidy(bench: Bench) -> None:
    assert bench.carry_out(TIDY).state is MotionState.CANCELLED
    assert not bench.arm.sent


def test_fault_4_fingers_that_never_close_are_noticed(bench: Bench) -> None:
    bench.arm.fingers_stuck_at = OPEN
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.GRASP_LOST)
    assert end.message == (
        "the fingers did not close on green_box: they stand 80 mm apart, the block is 45 mm wide; "
        "the arm is home"
    )
    assert (end.moves_done, end.held) == (0, "")
    assert_tidy(bench)


def test_fault_4_fingers_that_never_open_are_noticed_and_the_block_is_said_to_be_held(
    bench: Bench,
) -> None:
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "fingers_stuck_at", HALF_BLOCK), progress=0.2)
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.GRASP_LOST)
    assert end.message.startswith(
        "the fingers did not open: they stand 45 mm apart and still hold green_box"
    )
    assert "the arm is home and holds green_box" in end.message
    assert (end.arm, end.held, end.moves_done) == (ArmPlace.HOME, BLOCKS[0], 0)
    assert bench.planner.put_downs == [0, 0]


def test_fault_4_fingers_that_open_late_put_the_block_down_after_all(bench: Bench) -> None:
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "fingers_stuck_at", HALF_BLOCK), progress=0.2)
    bench.arm.when(
        lambda: bool(bench.planner.put_downs), lambda: setattr(bench.arm, "fingers_stuck_at", -1.0)
    )
    end = bench.carry_out()
    assert end.reason is MotionReason.GRASP_LOST
    assert end.message.endswith("green_box was put down on stack2 and the arm is home")
    assert end.moves_done == 1
    assert_tidy(bench)


@pytest.mark.parametrize("seconds", [4.0, 10.0, 14.0])
@pytest.mark.parametrize(("phase", "move"), [(PICK, 0), (PLACE, 0), (PLACE, 1)])
@pytest.mark.parametrize("what", ["silent", "sim"])
def test_fault_3_silence_that_passes_is_waited_out(
    bench: Bench, seconds: float, phase: str, move: int, what: str
) -> None:
    """Joint states are lost while the arm goes on, or the simulation stands still with them."""
    bench.when(phase, move, lambda: bench.arm.be_quiet(seconds, standing=what == "sim"))
    end = bench.carry_out()
    assert end.state is MotionState.SUCCEEDED, end.message
    messages = [report.message for report in bench.reports]
    awaited = [message for message in messages if "waiting for joint_states" in message]
    assert len(awaited) == 1
    doing = awaited[0].split("; waiting")[0]
    assert messages[messages.index(awaited[0]) + 1] == doing
    assert len(bench.arm.sent) == 1


def test_fault_3_silence_before_the_arm_sets_out_is_waited_out(bench: Bench) -> None:
    bench.arm.be_quiet(10.0, standing=True)
    bench.planner.while_solving = lambda: bench.arm.be_quiet(10.0, standing=True)
    end = bench.carry_out()
    assert end.state is MotionState.SUCCEEDED, end.message
    awaited = [r.state for r in bench.reports if "waiting for joint_states" in r.message]
    assert awaited == [MotionState.OPTIMISING, MotionState.EXECUTING]


def test_fault_3_a_clock_that_stands_still_for_a_while_is_waited_out(bench: Bench) -> None:
    def stop_clock() -> None:
        bench.arm.frozen_clock = True
        again = bench.arm.now() + 10.0
        go_on = lambda: setattr(bench.arm, "frozen_clock", False)  # noqa: E731
        bench.arm.when(lambda: bench.arm.now() > again, go_on)

    bench.when(PLACE, 0, stop_clock)
    assert bench.carry_out().state is MotionState.SUCCEEDED
    assert any("whose time goes on" in report.message for report in bench.reports)


def test_fault_13_joint_states_that_cannot_be_used_are_not_called_missing(bench: Bench) -> None:
    bench.arm.refuse("joint_states arrive without finite positions of panda_joint3")
    bench.arm.silent = True
    end = bench.carry_out()
    assert end.reason is MotionReason.NO_JOINT_STATES
    assert end.message.startswith(
        "joint_states arrive without finite positions of panda_joint3, for 15 s"
    )
