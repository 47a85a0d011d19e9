# SPDX-License-Identifier: Apache-2.0
"""Takes plans and requests to stop from callbacks; a thread carries out one plan at a time."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Protocol

from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from scene_graph import SceneGraph

from ..errors import InvalidPlanError
from .plan import Plan


class CarriesOut(Protocol):
    """What carries one plan out; see :class:`motion_node.execution.executive.Executive`."""

    @property
    def report(self) -> MotionReport:
        """The newest report, progress included."""

    def carry_out(
        self, plan: Plan, stop: threading.Event, publish: Callable[[MotionReport], None]
    ) -> None:
        """Carries out a plan; when it returns, its end has been published."""


class TellsCondition(Protocol):
    """What tells how the arm is; see :class:`motion_node.execution.condition.Condition`."""

    @property
    def is_tidy(self) -> bool:
        """Whether the arm is at rest at home with an empty hand."""

    def told_in(self, report: MotionReport) -> MotionReport:
        """The report, with how the arm is now."""


class PlanWorker:
    """The one plan that is carried out, and the answers to everything else that is asked.

    Any thread may ask; nothing waits. What is published keeps to the order of what happens: there
    is no idle report while a plan runs, and none of a plan after its end but the end itself.

    Args:
        executive: used in the worker's own thread.
        condition: fills every report.
        publish: told every report; from the worker's thread and from those that ask.
        on_defect: told the plan's name in the handler of an exception that is a defect.
        conflict: why no plan may be taken up: somebody else does the same; empty: it may.
    """

    #: So many plans that have ended are remembered, with their ends.
    REMEMBERED = 64

    def __init__(
        self,
        executive: CarriesOut,
        condition: TellsCondition,
        publish: Callable[[MotionReport], None],
        on_defect: Callable[[str], None],
        conflict: Callable[[], str] = lambda: "",
    ) -> None:
        self._executive, self._on_defect, self._conflict = executive, on_defect, conflict
        self._condition, self._publish_filled = condition, publish
        # Reentrant: who is told of an end may ask for the next plan at once.
        self._lock = threading.RLock()
        self._running: str | None = None
        self._stop = threading.Event()
        self._ends: dict[str, MotionReport] = {}
        self._plans: queue.SimpleQueue[tuple[Plan, threading.Event] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self.work, name="motion", daemon=True)

    def start(self) -> None:
        """Starts the thread."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Ends the thread after the plan under way, but waits no longer than ``timeout`` [s]."""
        self._plans.put(None)
        if self._thread.is_alive():
            self._thread.join(timeout)

    def ask(self, plan_id: str, moves: int, read: Callable[[], Plan]) -> str:
        """A request to carry out a plan; returns what becomes of it, for the log.

        The same again does no harm: what runs goes on, and what has ended repeats its end.

        Args:
            moves: how many it has.
            read: makes the plan of what was heard; may raise InvalidPlanError.
        """
        with self._lock:
            if self._running == plan_id:
                return "is being carried out already"
            if plan_id in self._ends:
                return self._repeat(plan_id)
            if self._running is not None:
                sentence = f"plan {self._running!r} is being carried out; wait for it, or stop it"
                return self._refuse(plan_id, moves, MotionReason.BUSY, sentence)
            if conflict := self._conflict():
                return self._refuse(plan_id, moves, MotionReason.CONFLICT, conflict)
            try:
                plan = read()
            except InvalidPlanError as error:
                return self._refuse(plan_id, moves, MotionReason.INVALID_PLAN, str(error))
            self._take_up(plan_id, plan)
        return f"is taken up: {moves} moves"

    def _take_up(self, plan_id: str, plan: Plan) -> None:
        self._running, self._stop = plan_id, threading.Event()
        self._plans.put((plan, self._stop))

    def _refuse(self, plan_id: str, moves: int, reason: MotionReason, sentence: str) -> str:
        self._publish(
            MotionReport(plan_id, MotionState.FAILED, reason, sentence, moves_total=moves)
        )
        return f"is refused: {sentence}"

    def _repeat(self, plan_id: str) -> str:
        self._publish(self._ends[plan_id])
        return "has ended already"

    def stop(self, plan_id: str) -> str:
        """A request to stop a plan, or whatever runs if it names none; returns what becomes of it.

        While nothing runs, an arm that is not home, or holds something, is brought home under that
        name. Else a plan that has ended repeats its end; any other one is CANCELLED at once.
        """
        with self._lock:
            if self._running is not None and plan_id in ("", self._running):
                self._stop.set()
                return "is being stopped"
            if self._running is None and not self._condition.is_tidy:
                if conflict := self._conflict():
                    return self._refuse(plan_id, 0, MotionReason.CONFLICT, conflict)
                self._take_up(plan_id, Plan(plan_id, SceneGraph((), frozenset()), (), ()))
                return "is not being carried out; the arm is brought home"
            if plan_id in self._ends:
                return self._repeat(plan_id)
            sentence = "nothing to stop; the arm is home"
            if self._running is not None:
                sentence = f"this plan is not being carried out, but plan {self._running!r} is"
            self._publish(MotionReport(plan_id, MotionState.CANCELLED, message=sentence))
        return "is not being carried out"

    def beat(self) -> None:
        """Publishes once more what is known; to be called once a second."""
        with self._lock:
            if self._running is None:
                # So that late listeners, and a planner whose plan was lost, learn how things are.
                self._publish(MotionReport())
                return
            report = self._executive.report
            if report.plan_id == self._running and not report.state.ended:
                self._publish(report)

    def work(self) -> None:
        """Carries plans out until :meth:`close`; what the thread runs."""
        while (item := self._plans.get()) is not None:
            plan, stop = item
            try:
                self._executive.carry_out(plan, stop, self._report)
            except Exception:
                self._on_defect(plan.plan_id)

    def _report(self, report: MotionReport) -> None:
        """Publishes a report of the worker; at its end the next plan may come at once."""
        with self._lock:
            if report.state.ended:
                self._running = None
                self._ends.pop(report.plan_id, None)
                self._ends[report.plan_id] = report
                while len(self._ends) > self.REMEMBERED:
                    del self._ends[next(iter(self._ends))]
            self._publish(report)

    def _publish(self, report: MotionReport) -> None:
        self._publish_filled(self._condition.told_in(report))
