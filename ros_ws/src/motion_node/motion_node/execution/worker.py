# SPDX-License-Identifier: Apache-2.0
"""Takes plans and requests to stop from callbacks; a thread carries out one plan at a time."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Protocol

from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from ..errors import InvalidPlanError
from .executive import Plan


class CarriesOut(Protocol):
    """What carries one plan out; see :class:`motion_node.execution.executive.Executive`."""

    @property
    def report(self) -> MotionReport:
        """The newest report, progress included."""

    def carry_out(
        self, plan: Plan, stop: threading.Event, publish: Callable[[MotionReport], None]
    ) -> None:
        """Carries out a plan; when it returns, its end has been published."""


class PlanWorker:
    """The one plan that is carried out, and the answers to everything else that is asked.

    Any thread may ask; nothing waits.

    Args:
        executive: used in the worker's own thread.
        publish: told every report; from the worker's thread and from those that ask.
        on_defect: told the plan's name in the handler of an exception that is a defect.
    """

    def __init__(
        self,
        executive: CarriesOut,
        publish: Callable[[MotionReport], None],
        on_defect: Callable[[str], None],
    ) -> None:
        self._executive, self._publish, self._on_defect = executive, publish, on_defect
        self._lock = threading.Lock()
        self._running: str | None = None
        self._stop = threading.Event()
        self._had_plan = False
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

        Args:
            moves: how many it has.
            read: makes the plan of what was heard; may raise InvalidPlanError.
        """
        with self._lock:
            running = self._running
            if running is None:
                self._running, self._had_plan = plan_id, True
                self._stop = threading.Event()
        if running == plan_id:
            return "is being carried out already"
        if running is not None:
            sentence = f"plan {running!r} is being carried out; wait for it, or stop it"
            return self._refuse(plan_id, moves, MotionReason.BUSY, sentence)
        try:
            plan = read()
        except InvalidPlanError as error:
            with self._lock:
                self._running = None
            return self._refuse(plan_id, moves, MotionReason.INVALID_PLAN, str(error))
        self._plans.put((plan, self._stop))
        return f"is taken up: {moves} moves"

    def _refuse(self, plan_id: str, moves: int, reason: MotionReason, sentence: str) -> str:
        self._publish(
            MotionReport(plan_id, MotionState.FAILED, reason, sentence, moves_total=moves)
        )
        return f"is refused: {sentence}"

    def stop(self, plan_id: str) -> str:
        """A request to stop a plan, or whatever runs if it names none; returns what becomes of it.

        A plan that has ended repeats its end; any other one is CANCELLED at once.
        """
        with self._lock:
            running, stop = self._running, self._stop
        if running is not None and plan_id in ("", running):
            stop.set()
            return "is being stopped"
        last = self._executive.report
        if last.plan_id == plan_id and last.state.ended:
            self._publish(last)
            return "has ended already"
        sentence = "this plan is not being carried out"
        self._publish(MotionReport(plan_id, MotionState.CANCELLED, message=sentence))
        return "is not being carried out"

    def beat(self) -> None:
        """Publishes once more what is known; to be called again and again."""
        with self._lock:
            running, had_plan = self._running, self._had_plan
        if running is not None:
            report = self._executive.report
            if report.plan_id == running and not report.state.ended:
                self._publish(report)
        elif not had_plan:
            # So that a planner whose plan was lost with an earlier life of this node learns of it.
            self._publish(MotionReport())

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
        if report.state.ended:
            with self._lock:
                self._running = None
        self._publish(report)
