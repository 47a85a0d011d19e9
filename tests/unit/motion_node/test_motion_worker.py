# SPDX-License-Identifier: Apache-2.0
"""One plan at a time, and what is said to everything else that is asked."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

import pytest
from simulated_arm import PLAN
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from motion_node.errors import InvalidPlanError
from motion_node.execution.plan import Plan
from motion_node.execution.worker import PlanWorker

IDLE = MotionReport()
RUNNING = MotionReport("a", MotionState.EXECUTING, moves_total=2)
DONE = MotionReport("a", MotionState.SUCCEEDED, moves_done=2, moves_total=2)


class FakeExecutive:
    """Reports that the plan runs, does what the test wants, and reports its end."""

    def __init__(self) -> None:
        self.report = IDLE
        self.meanwhile: Callable[[threading.Event], object] = lambda _stop: None
        self.error: Exception | None = None
        self.carried_out: list[Plan] = []

    def carry_out(
        self, plan: Plan, stop: threading.Event, publish: Callable[[MotionReport], None]
    ) -> None:
        self.carried_out.append(plan)
        for report in (RUNNING, DONE):
            self.report = report = replace(report, plan_id=plan.plan_id)
            publish(report)
            if not report.state.ended:
                self.meanwhile(stop)
        if self.error:
            raise self.error


class FakeCondition:
    """An arm that is home, unless told otherwise; ``hand`` is what it writes into reports."""

    def __init__(self) -> None:
        self.is_tidy = True
        self.hand = (0.0, 0.0, 0.0)

    def told_in(self, report: MotionReport) -> MotionReport:
        return replace(report, hand=self.hand)


class Bench:
    """A worker whose thread is the test's own."""

    def __init__(self) -> None:
        self.executive = FakeExecutive()
        self.published: list[MotionReport] = []
        self.defects: list[str] = []
        self.condition, self.conflict = FakeCondition(), ""
        self.worker = PlanWorker(
            self.executive,
            self.condition,
            self.published.append,
            self.defects.append,
            lambda: self.conflict,
        )

    def ask(self, plan_id: str = "a") -> str:
        return self.worker.ask(plan_id, 2, lambda: replace(PLAN, plan_id=plan_id))

    def run(self) -> None:
        """Carries out what was taken up."""
        self.worker.close(0.0)
        self.worker.work()


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_a_plan_is_carried_out(bench: Bench) -> None:
    assert bench.ask() == "is taken up: 2 moves"
    bench.run()
    assert bench.executive.carried_out == [PLAN]
    assert bench.published == [RUNNING, DONE]


def test_another_plan_is_refused_meanwhile(bench: Bench) -> None:
    bench.ask()
    bench.executive.meanwhile = lambda _stop: bench.ask("b")
    bench.run()
    _, refusal, _ = bench.published
    assert (refusal.plan_id, refusal.state) == ("b", MotionState.FAILED)
    assert (refusal.reason, refusal.moves_total) == (MotionReason.BUSY, 2)
    assert "'a'" in refusal.message
    assert len(bench.executive.carried_out) == 1


def test_the_same_again_is_no_other_plan(bench: Bench) -> None:
    bench.ask()
    assert bench.ask() == "is being carried out already"
    bench.run()
    assert bench.executive.carried_out == [PLAN]
    assert bench.published == [RUNNING, DONE]


def test_the_next_plan_may_come_with_the_end_of_the_last(bench: Bench) -> None:
    answers: list[str] = []
    worker = PlanWorker(
        bench.executive,
        bench.condition,
        lambda report: answers.append(bench.ask("b")) if report == DONE and not answers else None,
        bench.defects.append,
    )
    bench.worker = worker
    bench.ask()
    bench.run()
    assert answers == ["is taken up: 2 moves"]


def test_what_cannot_be_read_is_refused_and_the_next_is_taken_up(bench: Bench) -> None:
    def broken() -> Plan:
        raise InvalidPlanError("names repeat")

    assert bench.worker.ask("bad", 1, broken) == "is refused: names repeat"
    (refusal,) = bench.published
    assert (refusal.plan_id, refusal.reason) == ("bad", MotionReason.INVALID_PLAN)
    assert bench.ask() == "is taken up: 2 moves"


@pytest.mark.parametrize("name", ["a", ""])
def test_what_runs_is_stopped_by_its_name_or_by_none(bench: Bench, name: str) -> None:
    stopped: list[bool] = []

    def stop(event: threading.Event) -> None:
        bench.worker.stop(name)
        stopped.append(event.is_set())

    bench.ask()
    bench.executive.meanwhile = stop
    bench.run()
    assert stopped == [True]


def test_a_stop_reaches_a_plan_that_waits_for_its_turn(bench: Bench) -> None:
    stopped: list[bool] = []
    bench.executive.meanwhile = lambda event: stopped.append(event.is_set())
    bench.ask()
    assert bench.worker.stop("a") == "is being stopped"
    bench.run()
    assert stopped == [True]


def test_another_plan_is_not_concerned_by_a_stop(bench: Bench) -> None:
    stopped: list[bool] = []

    def stop_another(event: threading.Event) -> None:
        bench.worker.stop("b")
        stopped.append(event.is_set())

    bench.ask()
    bench.executive.meanwhile = stop_another
    bench.run()
    assert stopped == [False]
    _, answer, _ = bench.published
    assert (answer.plan_id, answer.state) == ("b", MotionState.CANCELLED)


def test_a_stop_is_forgotten_with_its_plan(bench: Bench) -> None:
    stopped: list[bool] = []
    bench.executive.meanwhile = lambda event: stopped.append(event.is_set())
    bench.ask()
    bench.worker.stop("a")
    bench.run()
    bench.ask("b")
    bench.run()
    assert stopped == [True, False]


def test_what_has_ended_repeats_its_end(bench: Bench) -> None:
    bench.ask()
    bench.run()
    assert bench.worker.stop("a") == "has ended already"
    assert bench.published[-1] == DONE
    assert len(bench.published) == 3


def test_fault_5_it_says_that_it_is_idle_before_and_after_plans_but_never_in_one(
    bench: Bench,
) -> None:
    bench.worker.beat()
    assert bench.published == [IDLE]
    bench.ask()
    bench.worker.beat()  # of this plan nothing is known yet
    assert bench.published == [IDLE]
    bench.run()
    bench.worker.beat()
    bench.worker.beat()
    assert bench.published == [IDLE, RUNNING, DONE, IDLE, IDLE]


def test_fault_5_a_plan_that_is_sent_again_is_carried_out_once(bench: Bench) -> None:
    for plan_id in ("a", "b"):
        bench.ask(plan_id)
        bench.run()
    bench.published.clear()
    assert bench.ask("a") == "has ended already"
    bench.run()
    assert bench.published == [DONE]
    assert len(bench.executive.carried_out) == 2


def test_what_was_refused_may_be_asked_again(bench: Bench) -> None:
    bench.conflict = "there are two of motion_node"
    bench.ask()
    bench.conflict = ""
    assert bench.ask() == "is taken up: 2 moves"


def test_fault_6_plans_are_refused_while_two_do_the_work_of_one(bench: Bench) -> None:
    bench.conflict = "there are two of motion_node"
    bench.ask()
    bench.condition.is_tidy = False
    bench.worker.stop("b")
    bench.run()
    assert [(r.plan_id, r.reason, r.message) for r in bench.published] == [
        ("a", MotionReason.CONFLICT, bench.conflict),
        ("b", MotionReason.CONFLICT, bench.conflict),
    ]
    assert not bench.executive.carried_out


def test_every_report_says_how_the_arm_is(bench: Bench) -> None:
    bench.condition.hand = (0.1, 0.2, 0.3)

    def meanwhile(_stop: threading.Event) -> None:
        bench.ask("b")
        bench.worker.beat()

    bench.executive.meanwhile = meanwhile
    bench.worker.beat()
    bench.ask()
    bench.run()
    bench.worker.stop("a")
    bench.worker.stop("c")
    assert len(bench.published) == 7
    assert {report.hand for report in bench.published} == {(0.1, 0.2, 0.3)}


@pytest.mark.parametrize("plan_id", ["a", "b", ""])
def test_fault_2_a_stop_of_nothing_brings_home_an_arm_that_is_not(
    bench: Bench, plan_id: str
) -> None:
    bench.ask("a")
    bench.run()
    bench.condition.is_tidy = False
    assert bench.worker.stop(plan_id) == "is not being carried out; the arm is brought home"
    bench.run()
    tidying = bench.executive.carried_out[-1]
    assert (tidying.plan_id, tidying.moves) == (plan_id, ())
    assert bench.published[-1].plan_id == plan_id


def test_a_stop_of_nothing_is_answered_at_once_where_the_arm_is_home(bench: Bench) -> None:
    bench.worker.stop("b")
    (answer,) = bench.published
    assert (answer.plan_id, answer.state) == ("b", MotionState.CANCELLED)
    assert answer.message == "nothing to stop; the arm is home"


def test_it_repeats_the_progress_of_what_runs(bench: Bench) -> None:
    bench.ask()
    bench.worker.beat()  # of this plan nothing is known yet
    bench.executive.meanwhile = lambda _stop: bench.worker.beat()
    bench.run()
    assert bench.published == [RUNNING, RUNNING, DONE]


def test_a_defect_is_told_and_the_next_plan_is_carried_out(bench: Bench) -> None:
    bench.executive.error = RuntimeError("made for the test")
    bench.ask()
    bench.run()
    assert bench.defects == ["a"]
    bench.executive.error = None
    bench.ask("b")
    bench.run()
    assert len(bench.executive.carried_out) == 2


def test_its_thread_carries_out_and_ends(bench: Bench) -> None:
    bench.worker.start()
    bench.ask()
    bench.worker.close(timeout=60.0)
    assert bench.published == [RUNNING, DONE]
