# SPDX-License-Identifier: Apache-2.0
"""Handing plans to the motion node and following what becomes of them."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

from tamp_runtime.motion_report import MotionReport, MotionState

from ..errors import MotionBusyError, MotionSilentError
from ..settings import Settings
from .clock import Clock
from .plan import Plan
from .scene_watch import POLL_SECONDS

RUNNING: Final = (MotionState.OPTIMISING, MotionState.EXECUTING)

#: A plan that nobody subscribes to is given up after this long, which discovery never takes [s].
DISCOVERY_SECONDS: Final = 5.0
#: A motion node needs longer than this to restart; an idle report that follows a report on the
#: plan sooner was on its way before [s].
RESTART_SECONDS: Final = 0.5


class PlanTopic(Protocol):
    """The way to the motion node."""

    def publish(self, plan: Plan) -> None:
        """Asks the motion node to carry out a plan."""

    def publish_stop(self, plan: Plan) -> None:
        """Asks the motion node to stop: the same plan without moves."""

    def subscribers(self) -> int:
        """How many hear it."""


@dataclass
class _Execution:
    """One plan of ours, from its publication until the motion node reports its end."""

    plan_id: str
    published: float
    heard: float | None = None
    report: MotionReport | None = None
    outcome: MotionReport | None = None
    updates: int = 0
    lost: bool = False


@dataclass
class _Foreign:
    """The newest report on a plan of somebody else, such as this node before a restart."""

    report: MotionReport
    heard: float


class MotionLink:
    """The motion node as the planner sees it; all methods may be called from any thread.

    Silence is measured in wall time, see :class:`Clock`.
    """

    def __init__(
        self,
        settings: Settings,
        plans: PlanTopic,
        now: Callable[[], int],
        clock: Clock | None = None,
    ) -> None:
        """``now`` is the ROS time [ns]."""
        self._settings = settings
        self._plans = plans
        self._now = now
        self._clock = clock or Clock()
        self._changed = threading.Condition()
        self._execution: _Execution | None = None
        self._foreign: _Foreign | None = None
        self._last_end = 0

    @property
    def last_end(self) -> int:
        """When the last motion ended, in ROS time [ns]; 0 if none has."""
        with self._changed:
            return self._last_end

    def receive(self, report: MotionReport) -> None:
        """Takes what the motion node reports, on whatever plan."""
        with self._changed:
            heard = self._clock.now()
            if report.state.ended:
                # A stamp in the future is of another clock, and would make every image look old.
                now = self._now()
                self._last_end = min(report.stamp or now, now)
            execution = self._execution
            ours = execution is not None and report.plan_id == execution.plan_id
            if report.state in RUNNING:
                self._foreign = None if ours else _Foreign(report, heard)
            elif self._foreign and report.plan_id in ("", self._foreign.report.plan_id):
                self._foreign = None
            if execution is None or execution.outcome is not None:
                pass
            elif report.state == MotionState.IDLE or (report.state in RUNNING and not ours):
                # One motion node does one thing: if it is idle or carries out another plan after
                # it had taken up ours, then ours is lost.
                if execution.heard is not None and heard > execution.heard + RESTART_SECONDS:
                    execution.lost = True
            elif ours:
                execution.heard = heard
                execution.report = report
                execution.updates += 1
                if report.state.ended:
                    execution.outcome = report
            self._changed.notify_all()

    def check_free(self) -> None:
        """Raises MotionBusyError while a plan is being carried out, whoever asked for it."""
        with self._changed:
            self._give_up_if_silent()
            execution, foreign = self._execution, self._foreign
            if execution and execution.outcome is None:
                raise MotionBusyError(
                    f"plan {execution.plan_id} is being carried out "
                    f"({self._state(execution.report)}); wait until it ends",
                    execution.plan_id,
                )
            silence = self._settings.motion_silence_timeout
            if foreign and self._clock.now() < foreign.heard + silence:
                raise MotionBusyError(
                    f"the motion node carries out plan {foreign.report.plan_id}, which this "
                    f"planner does not follow ({self._state(foreign.report)}); wait until it ends",
                    foreign.report.plan_id,
                )

    def start(self, plan: Plan) -> None:
        """Publishes a plan and follows it from now on."""
        with self._changed:
            self._execution = _Execution(plan.plan_id, self._clock.now())
        self._plans.publish(plan)

    def stop(self, plan: Plan) -> None:
        """Asks the motion node to stop; what becomes of the plan is followed on."""
        self._plans.publish_stop(plan)

    def follow(
        self, on_report: Callable[[MotionReport], None], stopped: Callable[[], bool]
    ) -> MotionReport | None:
        """Waits for the end of the started plan, and returns the report of it.

        Args:
            on_report: called with each new report; one that is overtaken may be left out.
            stopped: polled; when it returns True, None is returned at once.

        Raises:
            MotionSilentError: no answer, or none any more.
        """
        execution = self._execution
        assert execution is not None, "follow needs a started plan"
        told = 0
        while True:
            with self._changed:
                if execution.updates == told:
                    self._clock.wait(self._changed, POLL_SECONDS)
                news = execution.report if execution.updates > told else None
                told = execution.updates
                outcome = execution.outcome
                silence = self._give_up_if_silent()
            if news is not None:
                on_report(news)
            if outcome:
                return outcome
            if silence:
                raise MotionSilentError(silence, execution.plan_id, execution.report is not None)
            if stopped():
                return None

    def _give_up_if_silent(self) -> str:
        """A sentence if the motion node is silent about the plan, otherwise an empty string.

        What it reports on the plan later counts like a report on anybody's plan.
        """
        execution = self._execution
        if execution is None or execution.outcome is not None:
            return ""
        silence = self._silence(execution)
        if silence:
            self._execution = None
        return silence

    def _silence(self, execution: _Execution) -> str:
        if execution.lost:
            return (
                f"the motion node has lost plan {execution.plan_id}; was it restarted? "
                "Look at the scene and ask again"
            )
        if execution.heard is None:
            limit, since = self._settings.motion_accept_timeout, execution.published
            sentence = "the motion node does not take up the plan"
            if self._plans.subscribers() == 0:
                limit = min(limit, DISCOVERY_SECONDS)
                sentence = "nobody subscribes to symbolic_plan"
        else:
            limit, since = self._settings.motion_silence_timeout, execution.heard
            sentence = "the motion node reports nothing any more"
        if self._clock.now() - since < limit:
            return ""
        return f"{sentence} (waited {limit:g} s); is motion_node running?"

    @staticmethod
    def _state(report: MotionReport | None) -> str:
        return "not taken up yet" if report is None else report.state.name
