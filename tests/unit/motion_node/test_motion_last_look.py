# SPDX-License-Identifier: Apache-2.0
"""Fingers close on what was seen just before, and stand open before what was not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from executive_bench import Bench
from simulated_arm import BESIDE, BLOCKS, HALF_BLOCK, PLAN, SWITCHES
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from motion_node.execution.arm_state import ArmState
from motion_node.execution.last_look import (
    BEFORE_HAND,
    GIVES_UP,
    INSIDE,
    OLDEST,
    RECENT,
    LastLook,
    PlanSighting,
    Sight,
    Sightings,
)
from motion_node.robots.joints import JointValues

WATCHED = replace(PLAN, watched=True)


def seeing(bench: Bench, sees: Callable[[int], Sight | None], age: float = 0.15) -> None:
    """The planner tells each picture.

    Args:
        sees: what it shows of the block of a move; None: it never comes.
        age: of the newest picture that has been looked at [s].
    """

    def tell() -> None:
        bench.arm.when(lambda: True, tell)
        state, move = bench.arm.newest(), bench.executive.report.move
        if state is not None and (sight := sees(move)) is not None:
            bench.sightings.put(PlanSighting("a", state.stamp - age, move, sight))

    bench.arm.when(lambda: True, tell)


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_what_is_seen_all_the_time_costs_no_time(bench: Bench) -> None:
    seeing(bench, lambda _move: Sight.SEEN)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert len(bench.arm.sent) == 1


def test_a_plan_that_nobody_watches_waits_for_nothing(bench: Bench) -> None:
    assert bench.carry_out().state is MotionState.SUCCEEDED
    assert len(bench.arm.sent) == 1


@pytest.mark.parametrize("before", [None, Sight.DOUBTFUL])
@pytest.mark.parametrize("move", [0, 1])
def test_the_hand_stands_open_at_the_block_until_it_is_seen(
    bench: Bench, move: int, before: Sight | None
) -> None:
    sees: list[Sight | None] = [Sight.SEEN, Sight.SEEN]
    sees[move] = before
    seeing(bench, lambda now: sees[now])
    standing: list[MotionReport] = []

    def stands() -> bool:
        report = bench.executive.report
        here = report.message == f"looking whether {BLOCKS[move]} is where it is to be taken"
        standing.extend([report] if here else [])
        return len(standing) > 100

    fingers: list[float] = []

    def show() -> None:
        fingers.append(float(bench.arm.joints.fingers.min()))
        np.testing.assert_allclose(bench.arm.joints.arm, SWITCHES[2 * move], atol=1e-3)
        sees[move] = Sight.SEEN

    bench.arm.when(stands, show)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert fingers and fingers[0] > 0.99 * BESIDE
    assert (standing[-1].phase, standing[-1].move, standing[-1].moves_done) == ("pick", move, move)
    assert bench.arm.at_home()
    assert len(bench.arm.sent) == 3  # all of it, as far as the block, and the rest


@pytest.mark.parametrize("move", [0, 1])
def test_a_hand_that_hides_the_block_rises_to_look(bench: Bench, move: int) -> None:
    """It is seen as soon as the hand is 0.1 rad away."""

    def sees(now: int) -> Sight | None:
        if now != move:
            return Sight.SEEN
        away = float(np.abs(bench.arm.joints.arm - SWITCHES[2 * move]).max())
        near = Sight.HIDDEN if away < 0.1 else Sight.SEEN
        # Of what was seen on the way down nothing is known.
        return near if "looking whether" in bench.executive.report.message else None

    seeing(bench, sees)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    # All of it, as far as the block, up, down, and the rest.
    assert len(bench.arm.sent) == 5
    for sent, joints in bench.arm.sent[2:]:
        assert np.abs(sent.positions.arm[0] - joints.arm).max() < 1e-2
        np.testing.assert_allclose(sent.velocities.arm[[0, -1]], 0.0, atol=1e-9)


def test_where_looking_takes_long_an_older_picture_will_do(bench: Bench) -> None:
    seeing(bench, lambda _move: Sight.SEEN, age=0.9 * OLDEST)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert len(bench.arm.sent) == 5  # it stood twice


@pytest.mark.parametrize("sight", [None, Sight.DOUBTFUL, Sight.HIDDEN])
def test_what_is_not_seen_in_time_is_left_standing(bench: Bench, sight: Sight | None) -> None:
    seeing(bench, lambda move: Sight.SEEN if move == 0 else sight)
    end = bench.carry_out(WATCHED)
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.UNSEEN)
    assert end.message == (
        f"{BLOCKS[1]} was not seen for {GIVES_UP:g} s where it is to be taken; the arm is home"
    )
    assert (end.moves_done, end.held) == (1, "")
    assert bench.arm.at_home()


def test_a_stop_while_the_hand_stands_there_takes_nothing(bench: Bench) -> None:
    bench.arm.when(lambda: "looking whether" in bench.executive.report.message, bench.stop.set)
    end = bench.carry_out(WATCHED)
    assert (end.state, end.moves_done, end.held) == (MotionState.CANCELLED, 0, "")
    assert bench.arm.at_home()
    assert bench.arm.joints.fingers.min() > 0.99 * BESIDE


def test_fingers_that_have_begun_to_close_open_again(bench: Bench) -> None:
    """News of the arm stay out while it arrives: by then its fingers close."""

    def arrives() -> bool:
        at = np.abs(bench.arm.joints.arm - SWITCHES[0]).max()
        return bool(at < 0.1)

    bench.arm.when(arrives, lambda: bench.arm.be_quiet(0.16, standing=False))
    bench.arm.when(lambda: "looking whether" in bench.executive.report.message, bench.stop.set)
    end = bench.carry_out(WATCHED)
    assert (end.state, end.held) == (MotionState.CANCELLED, "")
    assert bench.arm.joints.fingers.min() > 0.99 * BESIDE


def test_doubt_that_comes_while_fingers_close_opens_them_again(bench: Bench) -> None:
    sight = [Sight.SEEN]
    seeing(bench, lambda _move: sight[0], age=0.0)

    def stands(opening: Callable[[float], bool]) -> Callable[[], bool]:
        def at_the_block() -> bool:
            away = float(np.abs(bench.arm.joints.arm - SWITCHES[0]).max())
            return away < 1e-3 and opening(float(bench.arm.joints.fingers.min()))

        return at_the_block

    def doubt() -> None:
        sight[0] = Sight.DOUBTFUL
        bench.arm.when(stands(lambda opening: opening > 0.999 * BESIDE), reassure)

    def reassure() -> None:
        sight[0] = Sight.SEEN

    bench.arm.when(stands(lambda opening: opening < 0.97 * BESIDE), doubt)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert sight == [Sight.SEEN]  # so they were open again
    assert len(bench.arm.sent) == 3  # all of it, the opening of the fingers, and the rest
    assert bench.arm.at_home()


def takes(bench: Bench, move: int) -> bool:
    """Whether a block was reported as lifted."""
    return any((item.phase, item.move) == ("place", move) for item in bench.reports)


@pytest.mark.parametrize("move", [0, 1])
def test_fingers_that_meet_nothing_open_before_they_lift(bench: Bench, move: int) -> None:
    """The block goes when the hand is over it, and no picture shows that."""
    seeing(bench, lambda now: Sight.SEEN if now != move else before[0])
    before: list[Sight] = [Sight.SEEN]

    def go() -> None:
        bench.arm.block, before[0] = 0.0, Sight.HIDDEN

    bench.arm.when(
        lambda: float(np.abs(bench.arm.joints.arm - SWITCHES[2 * move]).max()) < 0.05, go
    )
    end = bench.carry_out(WATCHED)
    assert (end.reason, end.held, end.moves_done) == (MotionReason.UNSEEN, "", move)
    assert not takes(bench, move)
    assert bench.arm.at_home()


def test_a_block_that_is_seen_after_fingers_met_nothing_is_taken(bench: Bench) -> None:
    """It was measured too wide. An older picture says nothing."""
    bench.arm.block = HALF_BLOCK - 2 * INSIDE
    seeing(bench, lambda _move: Sight.SEEN)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert takes(bench, 0)
    assert len(bench.arm.sent) == 5  # at both blocks the fingers opened, and closed again


def test_only_a_recent_picture_of_this_plan_and_move_counts() -> None:
    sightings = Sightings()
    assert sightings.age("a", 2, 10.0) == float("inf")
    sightings.put(PlanSighting("a", 10.0, 2))
    assert sightings.age("a", 2, 10.0 + RECENT) == pytest.approx(RECENT)
    assert sightings.age("a", 1, 10.0) == float("inf")
    assert sightings.age("b", 2, 10.0) == float("inf")
    sightings.put(PlanSighting("a", 10.1, 2, Sight.HIDDEN))
    assert sightings.age("a", 2, 10.2) == pytest.approx(0.2)  # seen as the hand came down
    sightings.put(PlanSighting("a", 10.3, 2, Sight.DOUBTFUL))
    assert sightings.age("a", 2, 10.4) == float("inf")
    sightings.put(PlanSighting("a", 10.5, 2))
    assert sightings.age("a", 2, 10.6) == pytest.approx(0.1)


@pytest.mark.parametrize(("hides", "waits"), [(False, False), (True, True)])
def test_an_older_picture_will_do_where_newer_ones_show_the_hand_before_the_block(
    hides: bool, waits: bool
) -> None:
    sightings = Sightings()
    look, q = LastLook(sightings, "a"), JointValues(np.zeros(2), np.zeros(2))
    sightings.put(PlanSighting("a", 10.0, 0))
    if hides:
        sightings.put(PlanSighting("a", 12.3, 0, Sight.HIDDEN))
    for now, allowed in ((10.0 + OLDEST + 0.1, waits), (10.0 + BEFORE_HAND + 0.1, False)):
        assert look.allows(0, ArmState(now, now, q, 0.0), stands=1.0) is allowed
