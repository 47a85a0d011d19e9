# SPDX-License-Identifier: Apache-2.0
"""What passes is waited out, or looked at again and planned anew; what does not is named."""

from __future__ import annotations

from collections.abc import Iterator

from loop_bench import REACHED, LoopBench, carry_out, obey, restart, take_up_and_die
from tamp_runtime.motion_report import ArmPlace, MotionReport, MotionState

from planner_node.loop import Plan, Status


def come_back_after(bench: LoopBench, seconds: float, stacks_then: bool = False) -> None:
    """The motion node says nothing for a while."""
    back = bench.clock.seconds + seconds

    def live() -> None:
        if bench.clock.seconds >= back:
            bench.mute = False
            if stacks_then:
                bench.stacks = REACHED
        bench.live_on()

    bench.clock.on_wait = live


def test_fault_3_a_motion_node_that_was_restarted_is_planned_for_anew() -> None:
    bench = LoopBench(restart)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert "or it was restarted" in outcome.causes[0]
    assert bench.stops[0] == bench.plan_ids[0]


def test_fault_3_a_motion_node_that_falls_silent_and_comes_back_is_looked_at_again() -> None:
    def fall_silent(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        come_back_after(bench, 1.5 * bench.settings.motion_silence_timeout)
        yield from take_up_and_die(bench, plan)

    bench = LoopBench(fall_silent)
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 1)
    assert "reports nothing any more" in outcome.causes[0]


def test_fault_3_a_motion_node_that_stays_silent_is_given_up() -> None:
    bench = LoopBench(take_up_and_die)
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.MOTION_SILENT, "motion")
    assert "reports nothing any more" in outcome.message
    assert bench.clock.seconds < 1000.0 + 2 * bench.settings.motion_silence_timeout + 5.0


def test_fault_3_waiting_for_a_silent_motion_node_can_be_cancelled() -> None:
    bench = LoopBench(take_up_and_die)
    cancelled: list[float] = []

    def waiting(progress: object) -> bool:
        if "waiting until the motion node reports again" in getattr(progress, "message", ""):
            cancelled.append(bench.clock.seconds)
        return bool(cancelled)

    bench.cancel_at = waiting
    outcome = bench.achieve()
    assert outcome.status == Status.CANCELLED
    assert "reports nothing any more" in outcome.message
    assert bench.clock.seconds - cancelled[0] < 10.0


def test_fault_3_five_seconds_of_silence_are_nothing() -> None:
    def stand_still(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        yield MotionReport(state=MotionState.EXECUTING)
        come_back_after(bench, 5.0)
        bench.mute = True
        while bench.mute:
            yield MotionReport(plan_id="unheard")
        yield from obey(bench, plan)

    bench = LoopBench(stand_still)
    hear = bench.motion.receive
    bench.motion.receive = lambda report: None if bench.mute else hear(report)  # type: ignore[method-assign]
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 0)


def test_fault_5_a_plan_that_came_while_the_motion_node_started_is_carried_out() -> None:
    bench = LoopBench()
    bench.deaf = True

    def start_up() -> None:
        if bench.clock.seconds > 1003.0:
            bench.deaf = False
        bench.live_on()

    bench.clock.on_wait = start_up
    outcome = bench.achieve()
    assert (outcome.status, outcome.replans) == (Status.SUCCESS, 0)
    assert len(bench.plan_ids) == 1
    assert 2 <= len(bench.plans) <= 5
    assert bench.clock.seconds < 1010.0


def test_fault_13_a_plan_that_never_arrives_is_told_once_the_camera_sees_that_nothing_moved() -> (
    None
):
    bench = LoopBench()
    bench.deaf = True
    outcome = bench.achieve()
    assert (outcome.status, outcome.module) == (Status.MOTION_SILENT, "motion")
    assert "does symbolic_plan reach motion_node?" in outcome.message
    assert "the arm rests at home" in outcome.message
    assert outcome.motion.arm == ArmPlace.HOME


def test_fault_13_a_plan_that_was_carried_out_unheard_is_confirmed_by_the_camera() -> None:
    def unheard(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        for _ in carry_out(bench, plan.moves):
            pass
        return iter(())

    bench = LoopBench(unheard, *[lambda _bench, _plan: iter(())] * 50)
    outcome = bench.achieve()
    assert outcome.status == Status.SUCCESS
    assert "motion_status arrives, but says nothing of it" in outcome.causes[0]


def test_fault_13_without_any_motion_status_what_is_not_known_is_not_claimed() -> None:
    def unheard(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        bench.mute = True
        for _ in carry_out(bench, plan.moves):
            pass
        return iter(())

    outcome = LoopBench(unheard).achieve()
    assert outcome.status == Status.MOTION_SILENT
    assert "no motion_status arrives" in outcome.message
    assert "nobody knows whether" in outcome.message
    assert "does not take up" not in outcome.message
    assert "green_box red_box blue_box" in outcome.message  # seen last
