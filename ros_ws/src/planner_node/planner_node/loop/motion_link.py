# SPDX-License-Identifier: Apache-2.0
"""Handing plans to the motion node and following what becomes of them."""

from __future__ import annotations

import threading
import uuid
from collections.abc import Callable
from dataclasses import replace
from typing import Final, Protocol

from tamp_runtime.motion_report import ArmPlace, MotionReport, MotionState

from ..errors import MotionBusyError, MotionSilentError
from ..settings import Settings
from .clock import Clock
from .execution import OVERTAKEN_NANOSECONDS, STALE_SECONDS, Execution, Foreign, state_of
from .plan import Plan
from .plan_watch import PlanSight
from .report import NO_REPORT
from .scene_watch import POLL_SECONDS

RUNNING: Final = (MotionState.OPTIMISING, MotionState.EXECUTING)

#: What was not taken up is published again after this long [s].
RESEND_SECONDS: Final = 1.0
#: A stop may have been lost, too; it is published again while the plan goes on [s].
STOP_AGAIN_SECONDS: Final = 3.0


class PlanTopic(Protocol):
    """The way to the motion node."""

    def publish(self, plan: Plan) -> None:
        """Asks the motion node to carry out a plan."""

    def publish_stop(self, plan_id: str) -> None:
        """Asks the motion node to stop a plan and go home: its name without moves."""

    def publish_sight(self, plan_id: str, sight: PlanSight) -> None:
        """Tells the motion node what is seen of a plan that is watched."""

    def subscribers(self) -> int:
        """How many hear it."""


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
        self._execution: Execution | None = None
        self._foreign: Foreign | None = None
        self._newest = NO_REPORT
        self._heard: float | None = None
        self._reports = 0
        self._last_end = 0
        self._knows_arm = False

    @property
    def last_end(self) -> int:
        """When the last motion ended, in ROS time [ns]; 0 if none has."""
        with self._changed:
            return self._last_end

    @property
    def knows_arm(self) -> bool:
        """Whether the motion node has ever said where the arm is; older ones never do."""
        with self._changed:
            return self._knows_arm

    @property
    def reports(self) -> int:
        """How many have been received, beats included."""
        with self._changed:
            return self._reports

    @property
    def silence(self) -> float | None:
        """For how long the motion node has said nothing at all [s]; None if it never has."""
        with self._changed:
            return None if self._heard is None else self._clock.now() - self._heard

    @property
    def newest(self) -> MotionReport:
        """What was heard last, beats included; the arm is UNKNOWN where that is long ago."""
        with self._changed:
            if self._heard is None or self._clock.now() - self._heard <= STALE_SECONDS:
                return self._newest
            return replace(self._newest, arm=ArmPlace.UNKNOWN)

    @property
    def foreign(self) -> str:
        """The plan under way that this planner does not follow; empty if there is none."""
        with self._changed:
            foreign = self._running_foreign()
            return foreign.report.plan_id if foreign else ""

    def last_on(self, report: MotionReport) -> MotionReport:
        """What was said on a plan, with where the arm is now and what it holds."""
        newest = self.newest
        if not report.plan_id:
            return newest
        stamp = max(report.stamp, newest.stamp)
        return replace(report, arm=newest.arm, held=newest.held, hand=newest.hand, stamp=stamp)

    def receive(self, report: MotionReport) -> None:
        """Takes what the motion node reports, on whatever plan."""
        with self._changed:
            heard = self._clock.now()
            self._heard = heard
            # One that was overtaken says how the arm was, unless the clock started anew.
            if not 0 < self._newest.stamp - report.stamp < OVERTAKEN_NANOSECONDS:
                self._newest = report
            self._reports += 1
            self._knows_arm = self._knows_arm or report.arm != ArmPlace.UNKNOWN
            if report.state.ended:
                # A stamp in the future is of another clock, and would make every image look old.
                now = self._now()
                self._last_end = min(report.stamp or now, now)
            execution = self._execution
            ours = execution is not None and report.plan_id == execution.plan_id
            if report.state in RUNNING:
                self._foreign = None if ours else Foreign(report, heard)
            elif self._foreign and report.plan_id in ("", self._foreign.report.plan_id):
                self._foreign = None
            resend = None
            if execution is not None and execution.outcome is None:
                if ours:
                    execution.take(report, heard)
                elif report.state == MotionState.IDLE or report.state in RUNNING:
                    execution.miss(heard)
                    resend = self._resend(execution, report, heard)
            self._changed.notify_all()
        if resend is not None:
            resend()

    def _resend(
        self, execution: Execution, report: MotionReport, heard: float
    ) -> Callable[[], None] | None:
        """How to publish again what an idle motion node has not taken up; None if it is not due.

        A motion node that just starts ignores what was published before, and a message can be lost.
        """
        if report.state != MotionState.IDLE or execution.heard is not None or execution.stopping:
            return None
        if heard < execution.sent + RESEND_SECONDS or self._silence_about(execution):
            return None
        execution.sent, execution.times_sent = heard, execution.times_sent + 1
        return execution.send

    def check_free(self) -> None:
        """Raises MotionBusyError while a plan is being carried out, whoever asked for it."""
        self.check_own()
        with self._changed:
            if foreign := self._running_foreign():
                report = foreign.report
                raise MotionBusyError(
                    f"the motion node carries out plan {report.plan_id}, which this planner does "
                    f"not follow ({state_of(report)}); wait until it ends, or stop it: "
                    "ros2 run planner_node stop",
                    report.plan_id,
                )

    def check_own(self) -> None:
        """Raises MotionBusyError while a plan of this planner is being carried out."""
        with self._changed:
            self._give_up_if_silent()
            execution = self._execution
            if execution is None or execution.outcome is not None:
                return
            if execution.stopping is not None:
                problem = "is being stopped; wait until the arm rests"
            else:
                problem = (
                    f"is being carried out ({state_of(execution.report)}); wait until it ends, or "
                    "stop it: ros2 run planner_node stop"
                )
            raise MotionBusyError(f"plan {execution.plan_id} {problem}", execution.plan_id)

    def start(self, plan: Plan) -> None:
        """Publishes a plan and follows it from now on."""
        self._begin(plan.plan_id, lambda: self._plans.publish(plan))

    def go_home(self) -> None:
        """Asks for the way home: the stop of a plan that nobody carries out; followed like one."""
        plan_id = f"home-{uuid.uuid4().hex[:12]}"
        self._begin(plan_id, lambda: self._plans.publish_stop(plan_id))

    def _begin(self, plan_id: str, send: Callable[[], None]) -> None:
        with self._changed:
            self._execution = Execution(plan_id, self._clock.now(), send)
        send()

    def stop(self, plan_id: str) -> None:
        """Asks the motion node to stop; what becomes of a plan that is followed is followed on."""
        with self._changed:
            if self._execution and self._execution.plan_id == plan_id:
                self._execution.stopping = self._clock.now()
        self._plans.publish_stop(plan_id)

    def tell_sight(self, sight: PlanSight) -> None:
        """Tells what is seen of the plan that is followed."""
        with self._changed:
            plan_id = self._execution.plan_id if self._execution else ""
        if plan_id:
            self._plans.publish_sight(plan_id, sight)

    def forget(self) -> None:
        """Follows nothing any more; if it goes on, it counts like a plan of somebody else."""
        with self._changed:
            self._execution = None

    def wake(self) -> None:
        """Has those who wait here look again at once what they wait for: there is other news."""
        with self._changed:
            self._changed.notify_all()

    def wait(self, until: Callable[[], bool], seconds: float, stopped: Callable[[], bool]) -> bool:
        """Waits for something that the motion node reports; False: ``stopped``, or in vain."""
        deadline = self._clock.now() + seconds
        while not until():
            if stopped() or self._clock.now() >= deadline:
                return False
            with self._changed:
                self._clock.wait(self._changed, POLL_SECONDS)
        return True

    def follow(
        self, on_report: Callable[[MotionReport], None], stopped: Callable[[], bool]
    ) -> MotionReport | None:
        """Waits for the end of what was started, and returns the report of it.

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
                stop_again = execution.stop_is_due(self._clock.now(), STOP_AGAIN_SECONDS)
            if news is not None:
                on_report(news)
            if outcome:
                return outcome
            if silence:
                raise silence
            if stopped():
                return None
            if stop_again:
                self._plans.publish_stop(execution.plan_id)

    def _give_up_if_silent(self) -> MotionSilentError | None:
        """An error if the motion node is silent about the plan.

        What it reports on the plan later counts like a report on anybody's plan.
        """
        execution = self._execution
        if execution is None or execution.outcome is not None:
            return None
        silence = self._silence_about(execution)
        if silence is not None:
            self._execution = None
        return silence

    def _silence_about(self, execution: Execution) -> MotionSilentError | None:
        return execution.silence(
            self._clock.now(), self._settings, self._heard, self._plans.subscribers()
        )

    def _running_foreign(self) -> Foreign | None:
        foreign, silence = self._foreign, self._settings.motion_silence_timeout
        if foreign is None or self._clock.now() >= foreign.heard + silence:
            return None
        return foreign
