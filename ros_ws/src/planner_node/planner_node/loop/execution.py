# SPDX-License-Identifier: Apache-2.0
"""One plan in the motion node's hands: what was heard of it, and what silence about it means."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from tamp_runtime.motion_report import MotionReport

from ..errors import MotionSilentError
from ..settings import Settings

#: A plan that nobody subscribes to is given up after this long, which discovery never takes, unless
#: a motion node was there a moment ago: it may be starting again [s].
DISCOVERY_SECONDS: Final = 5.0
#: A motion node needs longer than this to restart; an idle report that follows a report on the
#: plan sooner was on its way before [s].
RESTART_SECONDS: Final = 0.5
#: The motion node beats once a second; after this long nothing is known of the arm any more [s].
STALE_SECONDS: Final = 5.0
#: A report this much older than the newest was overtaken; one older still is of a clock that
#: started anew [ns].
OVERTAKEN_NANOSECONDS: Final = 10_000_000_000
#: Somebody who cancels waits no longer than this for a motion node that says nothing [s].
CANCEL_SECONDS: Final = 8.0


@dataclass
class Execution:
    """One plan of ours, from its publication until the motion node reports its end.

    Attributes:
        published: wall time of the first publication [s].
        send: publishes it again.
        sent, times_sent: wall time of the last publication [s], and how many there were.
        heard: wall time of the last report on it [s]; None before the first.
        report: the last report on it; ``outcome`` if that is its end.
        updates: how many reports there were.
        lost: the motion node has gone on to something else.
        stopping: wall time of the last request to stop it [s]; None before the first.
    """

    plan_id: str
    published: float
    send: Callable[[], None]
    heard: float | None = None
    report: MotionReport | None = None
    outcome: MotionReport | None = None
    updates: int = 0
    times_sent: int = 1
    lost: bool = False
    stopping: float | None = None
    asked_again: float = 0.0

    def __post_init__(self) -> None:
        self.sent = self.published

    def take(self, report: MotionReport, heard: float) -> None:
        """A report on this plan."""
        self.heard, self.report = heard, report
        self.updates += 1
        if report.state.ended:
            self.outcome = report

    def miss(self, heard: float) -> None:
        """A report that says the motion node is idle, or carries out another plan.

        It does one thing at a time: had it taken up this plan before, then this plan is lost.
        """
        if self.heard is not None and heard > self.heard + RESTART_SECONDS:
            self.lost = True

    def stop_is_due(self, now: float, period: float) -> bool:
        """Whether a request to stop is to be published again; it is counted as published."""
        if self.stopping is None or now < max(self.stopping, self.asked_again) + period:
            return False
        self.asked_again = now
        return True

    def silence(
        self, now: float, settings: Settings, motion_heard: float | None, subscribers: int
    ) -> MotionSilentError | None:
        """The error of a motion node that has been silent about the plan for too long.

        Args:
            now: wall time [s].
            motion_heard: wall time of the last report on anything [s]; None if there was none.
            subscribers: how many hear the plan.
        """
        if self.lost:
            return self._error(
                f"the motion node says nothing of plan {self.plan_id} any more and does something "
                "else: its last reports were lost on the way, or it was restarted",
                speaks=True,
            )
        accept, silence = settings.motion_accept_timeout, settings.motion_silence_timeout
        recently = motion_heard is not None and now - motion_heard < silence
        if self.heard is not None:
            limit, since = silence, self.heard
        else:
            limit, since = accept, self.published
            if subscribers == 0 and not recently:
                limit = min(limit, DISCOVERY_SECONDS)
        if self.stopping is not None:
            limit, since = min(limit, CANCEL_SECONDS), max(since, self.stopping)
        if now - since < limit:
            return None
        waited = f"(waited {limit:g} s)"
        if self.heard is not None:
            return self._error(
                f"the motion node reports nothing any more on plan {self.plan_id} {waited}; is "
                "motion_node running, and does its motion_status reach this node?",
                speaks=False,
            )
        if subscribers == 0:
            return self._error(
                f"nobody subscribes to symbolic_plan {waited}; is motion_node running?",
                speaks=False,
                untouched=True,
            )
        if motion_heard is not None and motion_heard > max(self.published, now - STALE_SECONDS):
            return self._error(
                f"the motion node does not take up plan {self.plan_id} {waited}, published "
                f"{self.times_sent} times: motion_status arrives, but says nothing of it; does "
                "symbolic_plan reach motion_node?",
                speaks=True,
                untouched=True,
            )
        return self._error(
            f"no motion_status arrives {waited}, so nobody knows whether plan {self.plan_id} was "
            "carried out; is motion_node running, and does its motion_status reach this node?",
            speaks=False,
        )

    def _error(self, problem: str, speaks: bool, untouched: bool = False) -> MotionSilentError:
        return MotionSilentError(problem, self.plan_id, self.report is not None, speaks, untouched)


@dataclass
class Foreign:
    """The newest report on a plan of somebody else, such as this node before a restart."""

    report: MotionReport
    heard: float


def state_of(report: MotionReport | None) -> str:
    """How far a plan is, in a word or two."""
    return "not taken up yet" if report is None else report.state.name
