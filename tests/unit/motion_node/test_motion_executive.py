# SPDX-License-Identifier: Apache-2.0
"""What becomes of a plan: carried out, stopped in any phase, or given up for a reason."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from executive_bench import Bench
from simulated_arm import (
    BESIDE,
    BLOCKS,
    HALF_BLOCK,
    OPEN,
    PLAN,
    FakePlanner,
    two_moves,
)
from tamp_runtime.motion_report import ArmPlace, MotionReason, MotionReport, MotionState

from motion_node.errors import KEYFRAMES, CancelledError, InfeasibleError, InvalidPlanError
from motion_node.execution.settings import ExecutionSettings
from motion_node.phases import HOME, PICK, PLACE


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_a_plan_is_carried_out_and_reported(bench: Bench) -> None:
    end = bench.carry_out()
    x, y, z = (round(value, 9) for value in end.hand)
    assert replace(end, hand=(x, y, z)) == MotionReport(
        "a",
        MotionState.SUCCEEDED,
        message="every move was carried out and the arm is home",
        move=1,
        moves_done=2,
        moves_total=2,
        phase=HOME,
        progress=1.0,
        optimisation_seconds=0.25,
        duration=two_moves().duration,
        arm=ArmPlace.HOME,
        hand=(0.0, 0.0, 0.5),
    )
    assert bench.arm.at_home()
    assert len(bench.arm.sent) == 1
    assert bench.planner.asked == [(PLAN.graph, PLAN.moves, BLOCKS)]
    assert bench.reports[0].state is MotionState.OPTIMISING
    executing = [report for report in bench.reports if report.state is MotionState.EXECUTING]
    assert [(report.phase, report.object_name) for report in executing] == [
        ("", ""),
        (PICK, "green_box"),
        (PLACE, "green_box"),
        (PICK, "blue_box"),
        (PLACE, "blue_box"),
        (HOME, ""),
    ]
    assert [report.moves_done for report in executing] == [0, 0, 0, 1, 1, 2]
    progress = [report.progress for report in executing]
    assert progress == sorted(progress)


def test_why_a_plan_was_refused_is_said_with_what_would_help_and_nothing_moves(
    bench: Bench,
) -> None:
    bench.planner.errors["solve"] = InfeasibleError("pose", "clearance of hand to wall")
    bench.suggestion = "move obstacle wall 12 mm to the left"
    assert bench.carry_out().suggestion == "", "nobody has asked"
    end = bench.carry_out(replace(PLAN, plan_id="b", explain=True))
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.INFEASIBLE)
    assert end.suggestion == "move obstacle wall 12 mm to the left"
    assert not bench.arm.sent


def test_a_plan_that_is_only_asked_about_is_not_carried_out_even_if_it_could_be(
    bench: Bench,
) -> None:
    end = bench.carry_out(replace(PLAN, explain=True))
    assert end.state is MotionState.CANCELLED
    assert end.message == "the plan could be carried out; nothing was moved, as asked"
    assert not bench.arm.sent


@pytest.mark.parametrize(("interval", "done"), [(0, 0), (4, 1)])
def test_an_obstacle_in_the_way_stops_the_arm_at_once_and_is_told(
    bench: Bench, interval: int, done: int
) -> None:
    way = two_moves().intervals[interval]
    middle = (way.start + way.end) / 2
    bench.in_the_way = lambda at: "obstacle wall is in the way of the hand" if at > middle else ""
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.OBSTRUCTED)
    assert end.message == (
        "obstacle wall is in the way of the hand; the arm was stopped; the arm is home"
    )
    assert (end.held, end.moves_done) == ("", done)
    brake, _ = bench.arm.sent[1]
    assert brake.intervals[-1].phase == way.phase
    assert bench.planner.ways_home == [done]


@pytest.mark.parametrize("deaf", [False, True])
def test_an_arm_that_went_on_while_its_way_was_looked_at_is_stopped_where_it_is_by_then(
    bench: Bench, deaf: bool
) -> None:
    """Its controller refuses to brake from elsewhere, and may not have heard the first time."""
    arm, first = bench.arm, two_moves().intervals[0]

    def looks_long(at: float) -> str:
        if at < 0.2 * first.end:
            return ""
        arm.pass_time(0.1 if deaf else 0.3)
        arm.deaf, hears = deaf, arm.now() + 0.06
        arm.when(lambda: arm.now() > hears, lambda: setattr(arm, "deaf", False))
        return "obstacle wall is in the way of the hand"

    bench.in_the_way = looks_long
    end = bench.carry_out()
    assert end.message.endswith("the arm was stopped; the arm is home")
    (brake, joints), *_ = arm.sent[-2:]
    assert brake.intervals[-1].phase == first.phase
    assert np.abs(brake.positions.arm[0] - joints.arm).max() < 0.1
    assert len(arm.sent) == 3 + deaf  # the plan, the brake, again if nobody heard, the way home


def test_an_obstacle_in_the_way_of_a_block_stops_it_before_it_is_put_down(bench: Bench) -> None:
    way = two_moves().intervals[2]
    middle = (way.start + way.end) / 2
    bench.in_the_way = lambda at: "obstacle wall is in the way of the hand" if at > middle else ""
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.OBSTRUCTED)
    brake, joints = bench.arm.sent[1]
    assert brake.intervals[-1].phase == way.phase
    assert joints.fingers.min() < BESIDE, "it holds the block as it stops"
    assert bench.planner.put_downs == [0]
    assert end.held == ""


@pytest.mark.parametrize("after", [2.0, None])
def test_where_an_obstacle_bars_the_way_home_too_the_arm_waits_until_it_is_gone(
    bench: Bench, after: float | None
) -> None:
    """Gone after so long [s], or never: then it is told where the arm is."""
    way = two_moves().intervals[4]
    middle = (way.start + way.end) / 2
    bench.in_the_way = lambda at: "obstacle wall is in the way of the hand" if at > middle else ""
    for solve in ("solve_way_home", "solve_rise_home"):
        bench.planner.errors[solve] = InfeasibleError("path", "clearance of hand to wall")
    barred, free = bench.planner, FakePlanner()
    stopped: list[float] = []

    def now() -> FakePlanner:
        if len(bench.arm.sent) > 1 and not stopped:
            stopped.append(bench.arm.now())
        gone = after is not None and stopped and bench.arm.now() > stopped[0] + after
        return free if gone else barred

    bench.planners = iter(now, 0)
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.OBSTRUCTED)
    assert end.message.startswith("obstacle wall is in the way of the hand; the arm was stopped; ")
    assert bench.arm.at_home() is (after is not None)
    assert end.message.endswith("the arm is home") is (after is not None)


@pytest.mark.parametrize(
    ("phase", "move", "moves_done"),
    [(PICK, 0, 0), (PLACE, 0, 1), (PICK, 1, 1), (PLACE, 1, 2), (HOME, 1, 2)],
)
def test_a_stop_in_any_phase_ends_at_home_with_an_empty_hand(
    bench: Bench, phase: str, move: int, moves_done: int
) -> None:
    bench.when(phase, move, bench.stop.set)
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.CANCELLED, MotionReason.NONE)
    assert end.moves_done == moves_done
    held = ("green_box", "blue_box")[move] if phase == PLACE else ""
    done = f"{held} was put down on stack2 and " if held else ""
    assert end.message == f"stopped on request after {moves_done} of 2 moves; {done}the arm is home"
    assert bench.arm.at_home()
    np.testing.assert_allclose(bench.arm.joints.fingers, OPEN, atol=1e-3)
    assert len(bench.arm.sent) == 3  # the plan, the brake, the way home
    assert (bench.planner.put_downs, bench.planner.ways_home) == (
        ([move], []) if held else ([], [moves_done])
    )


def test_an_arm_with_a_block_in_hand_brakes_at_once_and_holds_it(bench: Bench) -> None:
    bench.when(PLACE, 0, bench.stop.set, progress=0.2)
    bench.carry_out()
    brake, joints = bench.arm.sent[1]
    np.testing.assert_allclose(joints.fingers, HALF_BLOCK, atol=1e-3)
    assert brake.duration == bench.settings.brake_seconds
    assert not brake.velocities.arm[-1].any()
    assert np.ptp(brake.positions.fingers, axis=0).max() == 0.0


@pytest.mark.parametrize("share", [0.0, 0.2, 0.4, 0.6])
@pytest.mark.parametrize(("grip", "moves_done"), [(2, 0), (4, 1), (6, 1), (8, 2)])
def test_a_stop_while_the_fingers_move_leaves_the_block_standing_and_the_hand_open(
    bench: Bench, grip: int, moves_done: int, share: float
) -> None:
    """Fingers that have closed around a block when the stop comes open again."""
    moving = two_moves().intervals[grip - 1]
    assert moving.gripping
    at = moving.start + share * (moving.end - moving.start)
    bench.arm.when(lambda: bench.follower.time >= at, bench.stop.set)
    end = bench.carry_out()
    assert end.message == f"stopped on request after {moves_done} of 2 moves; the arm is home"
    assert (end.state, end.held, end.moves_done) == (MotionState.CANCELLED, "", moves_done)
    assert bench.planner.ways_home == [moves_done]
    assert bench.planner.rises == [] == bench.planner.put_downs
    assert len(bench.arm.sent) == 3  # the plan, the brake, the way home
    assert bench.arm.sent[-1][1].fingers.min() > 0.99 * BESIDE
    assert bench.arm.at_home()


def test_a_stop_while_it_is_planned_moves_nothing(bench: Bench) -> None:
    bench.planner.while_solving = bench.stop.set
    bench.planner.errors["solve"] = CancelledError("cancelled while optimising")
    end = bench.carry_out()
    assert (end.state, end.message) == (MotionState.CANCELLED, "cancelled while optimising")
    assert not bench.arm.sent


def test_a_stop_before_the_arm_rests_moves_nothing(bench: Bench) -> None:
    bench.arm.trembling = 0.01
    bench.arm.when(lambda: bench.arm.now() > 1010.0, bench.stop.set)
    assert bench.carry_out().state is MotionState.CANCELLED
    assert not bench.planner.asked


def test_a_stop_before_there_is_a_planner_moves_nothing(bench: Bench) -> None:
    bench.planners = iter([None])
    bench.stop.set()
    assert bench.carry_out().state is MotionState.CANCELLED


def test_a_planner_that_comes_late_is_waited_for(bench: Bench) -> None:
    bench.planners = iter([None, bench.planner])
    assert bench.carry_out().state is MotionState.SUCCEEDED


def test_without_a_description_nothing_starts(bench: Bench) -> None:
    def none() -> Iterator[None]:
        while True:
            bench.arm.pass_time(100.0)
            yield None

    bench.planners = none()
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.NO_JOINT_STATES)
    assert "robot_description" in end.message


def test_without_joint_states_nothing_starts(bench: Bench) -> None:
    bench.arm.silent = True
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.NO_JOINT_STATES)
    assert "joint_states" in end.message
    assert not bench.planner.asked


def test_a_plan_waits_until_the_arm_rests(bench: Bench) -> None:
    """The trajectory of an earlier life of the node may still be under way."""
    bench.arm.send(two_moves())
    assert bench.carry_out().state is MotionState.SUCCEEDED
    (_, _), (second, _) = bench.arm.sent
    np.testing.assert_allclose(second.positions.arm[0], 0.0, atol=0.01)


def test_what_does_not_fit_the_scene_is_refused(bench: Bench) -> None:
    bench.planner.errors["solve"] = InvalidPlanError("no such block", -1, "red_box")
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.INVALID_PLAN)
    assert (end.message, end.object_name, end.move) == ("no such block", "red_box", 0)
    assert not bench.arm.sent


def test_an_infeasible_plan_names_bound_block_and_constraint(bench: Bench) -> None:
    bench.planner.errors["solve"] = InfeasibleError(
        KEYFRAMES, "reach", object_name="green_box", violation=0.5, move=2, phase=HOME
    )
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.INFEASIBLE)
    assert (end.bound, end.object_name, end.constraint) == (KEYFRAMES, "green_box", "reach")
    # The way home is the move after the last one, which messages do not count.
    assert (end.move, end.phase) == (1, HOME)


def test_joint_states_that_stop_end_the_execution(bench: Bench) -> None:
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "silent", True))
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.NO_JOINT_STATES)


def test_an_arm_that_stays_stuck_with_a_block_says_what_it_holds_and_where(bench: Bench) -> None:
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "stuck", True))
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    assert "falls behind" in end.message.split(";")[0]
    assert "the arm could not go home" in end.message
    assert end.message.endswith("m holding green_box")
    assert (end.moves_done, end.arm, end.held) == (0, ArmPlace.RESTING, BLOCKS[0])


def test_an_arm_that_obeys_again_goes_home_with_its_empty_hand(bench: Bench) -> None:
    bench.when(PICK, 0, lambda: setattr(bench.arm, "stuck", True), progress=0.03)
    bench.arm.when(lambda: len(bench.arm.sent) > 1, lambda: setattr(bench.arm, "stuck", False))
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.TRACKING_LOST)
    assert end.message.endswith("; the arm is home")
    assert bench.arm.at_home()


@pytest.mark.parametrize("move", [0, 1])
def test_fingers_that_close_on_nothing_send_the_arm_home(bench: Bench, move: int) -> None:
    bench.when(PICK, move, lambda: setattr(bench.arm, "block", 0.0))
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.GRASP_LOST)
    assert BLOCKS[move] in end.message
    assert end.moves_done == move
    assert bench.planner.ways_home == [move]
    assert bench.arm.at_home()


def test_a_way_home_that_is_blocked_is_said(bench: Bench) -> None:
    bench.arm.block = 0.0
    for way in ("solve_way_home", "solve_rise_home"):
        bench.planner.errors[way] = InfeasibleError("path", "clearance of hand to stack1")
    end = bench.carry_out()
    assert end.reason is MotionReason.GRASP_LOST
    assert "the arm could not go home" in end.message
    assert "stack1" in end.message
    assert (end.arm, end.held) == (ArmPlace.RESTING, "")


def test_where_the_known_way_home_is_blocked_the_arm_rises_first(bench: Bench) -> None:
    bench.arm.block = 0.0
    bench.planner.errors["solve_way_home"] = InfeasibleError("path", "clearance of hand to stack1")
    end = bench.carry_out()
    assert end.message.endswith("; the arm is home")
    assert bench.planner.rises == [""]


def test_a_defect_is_reported_and_raised(bench: Bench) -> None:
    bench.planner.errors["solve"] = RuntimeError("made for the test")
    with pytest.raises(RuntimeError, match="made for the test"):
        bench.carry_out()
    end = bench.executive.report
    assert bench.reports[-1] == end
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.INTERNAL_ERROR)
    assert "made for the test" in end.message


def test_one_plan_after_the_other_and_the_settings_of_each(bench: Bench) -> None:
    assert bench.carry_out().state is MotionState.SUCCEEDED
    bench.reports.clear()
    bench.arm.deaf = True
    bench.settings = ExecutionSettings(joint_state_timeout=1.0)
    assert bench.carry_out().reason is MotionReason.TRACKING_LOST
    assert bench.reports[0].progress == 0.0


def test_fault_6_nothing_sets_out_while_two_do_the_work_of_one(bench: Bench) -> None:
    bench.planner.while_solving = lambda: setattr(bench, "conflict", "there are two of motion_node")
    end = bench.carry_out()
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.CONFLICT)
    assert end.message == "there are two of motion_node"
    assert not bench.arm.sent


def test_a_node_that_ends_leaves_the_trajectory_to_the_arm(bench: Bench) -> None:
    bench.when(PLACE, 0, lambda: setattr(bench.arm, "closed", True))
    bench.executive.carry_out(bench.plan, bench.stop, bench.reports.append)
    assert not bench.reports[-1].state.ended
    assert len(bench.arm.sent) == 1
