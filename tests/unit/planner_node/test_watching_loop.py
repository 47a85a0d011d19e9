# SPDX-License-Identifier: Apache-2.0
"""The closed loop that watches while the arm moves, or looks after each move."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pytest
from loop_bench import GOAL, REACHED, Behaviour, LoopBench, run_until_stopped
from posed_scenes import Point, centre, frame
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from planner_node.loop import Outcome, Plan, Status
from planner_node.loop.plan_watch import Sight
from scene_graph import GraphStatus, Stacks, apply_move

Happening = Callable[["WatchBench"], None]
#: Reports a phase; one each 50 ms.
REPORTS = 20


class WatchBench(LoopBench):
    """Blocks have poses, and the arm is in the view while it moves.

    Attributes:
        moved: blocks that are not where their stack says: in the hand, elsewhere, or gone.
        fallen: blocks that lie somewhere; perception says so of the first.
    """

    stacks: Stacks

    def __init__(self, *behaviours: Behaviour, **settings: Any) -> None:
        super().__init__(*(behaviours or (phase_by_phase(),)), **settings)
        self.moved: dict[str, Point | None] = {}
        self.fallen: dict[str, Point] = {}

    def look(self) -> None:
        moves = self._running is not None
        status, message = GraphStatus.CONFIDENT, ""
        if self.fallen:
            status, message = GraphStatus.UNSTABLE, f"the {next(iter(self.fallen))[:-4]} block lies"
        if moves:
            status, message = GraphStatus.OCCLUDED, "the arm hides all"
        now = self.clock.ros_now()
        seen = frame(self.stacks, now, self.moved, status, visible=0.9, fallen=self.fallen)
        self.scenes.receive(replace(seen, message=message))

    def exchange(self, one: str, other: str) -> None:
        names = {one: other, other: one}
        before = self.stacks
        self.stacks = tuple(tuple(names.get(name, name) for name in stack) for stack in before)

    def take_away(self, name: str) -> None:
        self.stacks = tuple(tuple(n for n in stack if n != name) for stack in self.stacks)


def phase_by_phase(
    at: tuple[int, str] | None = None,
    happening: Happening = lambda _bench: None,
    end: Callable[[Plan, int], MotionReport] | None = None,
) -> Behaviour:
    """Carries a plan out; a held block is put down before it stops.

    Args:
        at: move and phase in the middle of which something happens.
        end: how it ends when it is stopped.
    """

    def behaviour(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        assert isinstance(bench, WatchBench)
        yield MotionReport(state=MotionState.OPTIMISING)
        total = len(plan.moves)
        for number, move in enumerate(plan.moves):
            name = bench.stacks[move.source][-1]
            for phase in ("pick", "place"):
                for report in range(REPORTS):
                    if (number, phase) == at and report == REPORTS // 2:
                        happening(bench)
                    if plan.plan_id in bench.stops and phase == "pick":
                        yield (end or stopped)(plan, number)
                        return
                    if phase == "place":
                        bench.moved[name] = (0.5, -0.2 + 0.02 * report, 0.3)
                    yield MotionReport(
                        state=MotionState.EXECUTING, move=number, moves_done=number,
                        moves_total=total, phase=phase, object_name=name,
                    )  # fmt: skip
            bench.stacks = apply_move(bench.stacks, move)
            bench.moved.pop(name)
        yield MotionReport(state=MotionState.SUCCEEDED, moves_done=total, moves_total=total)

    return behaviour


def stopped(plan: Plan, done: int) -> MotionReport:
    return MotionReport(
        state=MotionState.CANCELLED, moves_done=done, moves_total=len(plan.moves),
        message="stopped on request",
    )  # fmt: skip


def swapped(bench: WatchBench) -> None:
    bench.exchange("green_box", "blue_box")


def achieve(bench: WatchBench, goal: str = GOAL) -> Outcome:
    outcome = bench.achieve(goal)
    assert bench.motion.newest.arm.name == "HOME"
    return outcome


@pytest.mark.parametrize("verify", ["end", "each_move", "watch"])
def test_a_task_that_nobody_disturbs_is_not_stopped(verify: str) -> None:
    bench = WatchBench(*[phase_by_phase() for _ in range(3)], verify=verify)
    outcome = achieve(bench)
    assert (outcome.status, outcome.replans, outcome.causes) == (Status.SUCCESS, 0, ())
    assert outcome.message == (
        "the camera confirms 'red_box on green_box, blue_box on red_box': "
        "[- | green_box red_box blue_box | -]"
    )
    assert (outcome.moves_planned, outcome.moves_executed) == (3, 3)
    assert bench.stacks == REACHED
    assert bench.stops == []
    assert all(plan.watched == (verify == "watch") for plan in bench.plans)
    told = {sight.move for _, sight in bench.sights if sight.sight is Sight.SEEN}
    assert told == ({0, 1, 2} if verify == "watch" else set())


def test_blocks_that_change_places_stop_the_motion_and_are_planned_for_anew() -> None:
    bench = WatchBench(phase_by_phase((1, "pick"), swapped), phase_by_phase(), verify="watch")
    outcome = achieve(bench)
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert bench.stops == [bench.plans[0].plan_id]
    assert outcome.moves_executed == 1 + len(bench.plans[1].moves)
    told = outcome.causes[0]
    assert sorted(told.split("; ")) == [
        "blue_box was expected on stack2 and is seen on stack1 since move 2 of 3",
        "green_box was expected on stack1 and is seen on stack2 since move 2 of 3",
    ]
    assert outcome.message.endswith(f"| green_box red_box blue_box]; {told}")
    assert f"stopping: {told}" in bench.messages()


def test_without_watching_the_same_is_noticed_at_the_end_only() -> None:
    bench = WatchBench(phase_by_phase((1, "pick"), swapped), phase_by_phase(), verify="end")
    outcome = achieve(bench)
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert bench.stops == []
    assert outcome.moves_executed == 3 + len(bench.plans[1].moves)


def test_a_block_that_is_in_the_hand_is_put_down_first() -> None:
    bench = WatchBench(phase_by_phase((0, "place"), swap_below), phase_by_phase(), verify="watch")
    outcome = achieve(bench, "green_box on red_box")
    assert outcome.status == Status.SUCCESS
    assert outcome.causes[0].startswith(("green_box was expected", "red_box was expected"))
    assert outcome.causes[0].endswith("since move 1 of 2")
    assert len(bench.plans[1].scene.names) == 3


def swap_below(bench: WatchBench) -> None:
    bench.exchange("green_box", "red_box")


def test_a_block_that_is_gone_is_refused_by_its_name() -> None:
    def gone(bench: WatchBench) -> None:
        bench.take_away("green_box")

    bench = WatchBench(phase_by_phase((0, "pick"), gone), verify="watch")
    outcome = achieve(bench)
    assert (outcome.status, outcome.module) == (Status.UNKNOWN_OBJECT, "perception")
    assert outcome.message.startswith("green_box cannot be seen any more")
    assert outcome.causes[0] == (
        "green_box was expected on stack1 and is not seen any more since move 1 of 3"
    )
    assert outcome.causes[0] in outcome.message


def test_a_block_that_fell_is_noticed_and_refused_by_what_happened() -> None:
    def topple(bench: WatchBench) -> None:
        bench.take_away("green_box")
        bench.fallen["green_box"] = (0.56, 0.05, 0.02)

    bench = WatchBench(phase_by_phase((0, "pick"), topple), verify="watch")
    outcome = achieve(bench)
    assert (outcome.status, outcome.module) == (Status.NOT_CONFIDENT, "perception")
    assert outcome.message.startswith("the green block lies")
    assert outcome.causes[0] == (
        "green_box was expected on stack1 and is seen 78 mm beside where it was to be since move 1 "
        "of 3"
    )
    assert outcome.causes[0] in outcome.message
    assert outcome.moves_executed <= 1


def test_a_block_that_moved_a_little_is_taken_from_where_it_is() -> None:
    def nudged(bench: WatchBench) -> None:
        x, y, z = centre(1, 0)
        bench.moved["green_box"] = (x + 0.02, y, z)

    bench = WatchBench(phase_by_phase((0, "pick"), nudged), phase_by_phase(), verify="watch")
    outcome = achieve(bench)
    assert (outcome.status, outcome.replans, bench.stops) == (Status.SUCCESS, 0, [])
    assert "green_box was moved by 20 mm, and the way corrected" in outcome.message
    told = [item for _, sight in bench.sights for item in sight.moved]
    assert {item.name for item in told} == {"green_box"}
    assert told[-1].position_world == pytest.approx((0.52, 0.0, 0.0225))


def test_replans_for_what_is_seen_are_bounded() -> None:
    behaviours = [phase_by_phase((0, "pick"), swapped) for _ in range(3)]
    bench = WatchBench(*behaviours, verify="watch", max_replans=2)
    outcome = achieve(bench, "red_box on green_box, blue_box on red_box")
    assert (outcome.status, outcome.replans) == (Status.TOO_MANY_REPLANS, 2)
    assert "was expected on" in outcome.message


def test_a_motion_that_fails_while_it_is_stopped_is_judged_as_ever() -> None:
    def lost(plan: Plan, done: int) -> MotionReport:
        return MotionReport(
            state=MotionState.FAILED, reason=MotionReason.INTERNAL_ERROR, message="a defect",
            moves_done=done, moves_total=len(plan.moves),
        )  # fmt: skip

    bench = WatchBench(phase_by_phase((0, "pick"), swapped, lost), verify="watch")
    outcome = achieve(bench)
    assert (outcome.status, outcome.module) == (Status.MOTION_FAILED, "motion")
    assert "was expected on" in outcome.causes[0]
    assert outcome.causes[1] == "a defect"


def test_who_cancels_while_it_is_stopped_gets_that_answer() -> None:
    bench = WatchBench(phase_by_phase((0, "place"), swap_below), verify="watch")
    bench.cancel_at = lambda progress: progress.message.startswith("stopping: ")
    outcome = achieve(bench)
    assert outcome.status == Status.CANCELLED
    assert "was expected on" in outcome.causes[0]


def test_a_cancel_is_a_cancel_also_where_it_watches() -> None:
    bench = WatchBench(run_until_stopped, verify="watch")
    bench.cancel_at = lambda _: bool(bench.plans)
    outcome = achieve(bench)
    assert (outcome.status, outcome.causes) == (Status.CANCELLED, ())


def test_after_each_move_the_arm_looks_and_goes_on() -> None:
    bench = WatchBench(*[phase_by_phase() for _ in range(3)], verify="each_move")
    achieve(bench)
    assert [len(plan.moves) for plan in bench.plans] == [1, 1, 1]
    starts = [plan.scene.stamp for plan in bench.plans]
    assert starts == sorted(set(starts))


def test_after_each_move_what_changed_is_planned_for_anew() -> None:
    bench = WatchBench(
        phase_by_phase(), phase_by_phase((0, "place"), swap_below), verify="each_move"
    )
    for _ in range(5):
        bench._behaviours.append(phase_by_phase())
    outcome = achieve(bench)
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert "but the camera sees" in outcome.causes[0]
