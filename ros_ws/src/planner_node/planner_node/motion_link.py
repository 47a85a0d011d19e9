# SPDX-License-Identifier: Apache-2.0
"""Handing plans to the motion node and following what becomes of them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from rclpy.publisher import Publisher
from rclpy.time import Time
from std_msgs.msg import Header
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.messages.stamps import nanoseconds

from .conversions import MOTION_STATES, constant_name
from .errors import MotionBusyError, MotionSilentError
from .scene_watch import POLL_SECONDS
from .settings import Settings

RUNNING: Final = (MotionStatus.OPTIMISING, MotionStatus.EXECUTING)
ENDED: Final = (MotionStatus.SUCCEEDED, MotionStatus.CANCELLED, MotionStatus.FAILED)

#: A plan that nobody subscribes to is given up after this long, which discovery never takes [s].
DISCOVERY_SECONDS: Final = 5.0
#: A motion node needs longer than this to restart; an idle report that follows a report on the
#: plan sooner was on its way before [s].
RESTART_SECONDS: Final = 0.5


@dataclass
class _Execution:
    """One plan of ours, from its publication until the motion node reports its end."""

    plan_id: str
    published: float
    heard: float | None = None
    status: MotionStatus | None = None
    outcome: MotionStatus | None = None
    updates: int = 0
    lost: bool = False


@dataclass
class _Foreign:
    """The newest report on a plan of somebody else, such as this node before a restart."""

    status: MotionStatus
    heard: float = field(default_factory=time.monotonic)


class MotionLink:
    """The motion node as the planner sees it; all methods may be called from any thread.

    Silence is measured in wall time, since a simulation that stops also stops its clock.
    """

    def __init__(self, settings: Settings, plans: Publisher, now: Callable[[], int]) -> None:
        """``plans`` is the publisher of plans; ``now`` is the ROS time [ns]."""
        self._settings = settings
        self._plans = plans
        self._now = now
        self._changed = threading.Condition()
        self._execution: _Execution | None = None
        self._foreign: _Foreign | None = None
        self._last_end = 0

    @property
    def last_end(self) -> int:
        """When the last motion ended, in ROS time [ns]; 0 if none has."""
        with self._changed:
            return self._last_end

    def receive(self, status: MotionStatus) -> None:
        with self._changed:
            if status.state in ENDED:
                # A stamp in the future is of another clock, and would make every image look old.
                now = self._now()
                self._last_end = min(nanoseconds(status.header.stamp) or now, now)
            execution = self._execution
            ours = execution is not None and status.plan_id == execution.plan_id
            if status.state in RUNNING:
                self._foreign = None if ours else _Foreign(status)
            elif self._foreign and status.plan_id in ("", self._foreign.status.plan_id):
                self._foreign = None
            if execution is None or execution.outcome is not None:
                pass
            elif status.state == MotionStatus.IDLE or (status.state in RUNNING and not ours):
                # One motion node does one thing: if it is idle or carries out another plan after
                # it had taken up ours, then ours is lost.
                if execution.heard and time.monotonic() > execution.heard + RESTART_SECONDS:
                    execution.lost = True
            elif ours:
                execution.heard = time.monotonic()
                execution.status = status
                execution.updates += 1
                if status.state in ENDED:
                    execution.outcome = status
            self._changed.notify_all()

    def check_free(self) -> None:
        """Raises MotionBusyError while a plan is being carried out, whoever asked for it."""
        with self._changed:
            self._give_up_if_silent()
            execution, foreign = self._execution, self._foreign
            if execution and execution.outcome is None:
                raise MotionBusyError(
                    f"plan {execution.plan_id} is being carried out "
                    f"({self._state(execution.status)}); wait until it ends",
                    execution.plan_id,
                )
            if foreign and time.monotonic() < foreign.heard + self._settings.motion_silence_timeout:
                raise MotionBusyError(
                    f"the motion node carries out plan {foreign.status.plan_id}, which this "
                    f"planner does not follow ({self._state(foreign.status)}); wait until it ends",
                    foreign.status.plan_id,
                )

    def start(self, plan: SymbolicPlan) -> None:
        """Publishes a plan and follows it from now on."""
        with self._changed:
            self._execution = _Execution(plan.plan_id, time.monotonic())
        self._plans.publish(plan)

    def stop(self, plan: SymbolicPlan) -> None:
        """Asks the motion node to stop: the same plan without moves."""
        self._plans.publish(
            SymbolicPlan(
                header=Header(
                    stamp=Time(nanoseconds=self._now()).to_msg(),
                    frame_id=plan.header.frame_id,
                ),
                plan_id=plan.plan_id,
            )
        )

    def follow(
        self, on_status: Callable[[MotionStatus], None], stopped: Callable[[], bool]
    ) -> MotionStatus | None:
        """Waits for the end of the started plan, and returns the status that reports it.

        Args:
            on_status: called with each new status; one that is overtaken may be left out.
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
                    self._changed.wait(POLL_SECONDS)
                news = execution.status if execution.updates > told else None
                told = execution.updates
                outcome = execution.outcome
                silence = self._give_up_if_silent()
            if news is not None:
                on_status(news)
            if outcome:
                return outcome
            if silence:
                raise MotionSilentError(silence, execution.plan_id, execution.status is not None)
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
            if self._plans.get_subscription_count() == 0:
                limit = min(limit, DISCOVERY_SECONDS)
                sentence = "nobody subscribes to symbolic_plan"
        else:
            limit, since = self._settings.motion_silence_timeout, execution.heard
            sentence = "the motion node reports nothing any more"
        if time.monotonic() - since < limit:
            return ""
        return f"{sentence} (waited {limit:g} s); is motion_node running?"

    @staticmethod
    def _state(status: MotionStatus | None) -> str:
        if status is None:
            return "not taken up yet"
        return constant_name(MotionStatus, status.state, MOTION_STATES)
