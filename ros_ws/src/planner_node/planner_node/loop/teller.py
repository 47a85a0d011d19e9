# SPDX-License-Identifier: Apache-2.0
"""How far a run is, told at every change and once a second: often enough, and no more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from tamp_runtime.motion_report import MotionReport

from .clock import Clock
from .plan import Plan
from .report import NO_REPORT, Progress, Stage

#: Between two progresses that differ in nothing but how far the trajectory is [s].
PERIOD_SECONDS: Final = 1.0


class Teller:
    """Keeps the progress of a run, and passes it on.

    Attributes:
        progress: as it is now.
    """

    def __init__(self, report: Callable[[Progress], None], clock: Clock) -> None:
        """``report`` gets every progress that is told."""
        self._report = report
        self._clock = clock
        self._told = clock.now()
        self.progress = Progress()

    def tell(self, stage: Stage, message: str) -> None:
        """Tells what begins now."""
        self.progress = replace(self.progress, stage=stage, message=message)
        self._pass_on()

    def say(self, message: str) -> None:
        """Tells what is being done in the stage under way."""
        self.tell(self.progress.stage, message)

    def begin(self, plan: Plan) -> None:
        """Notes the plan that is followed from now on; told with what comes next."""
        self.progress = replace(self.progress, plan=plan, motion=NO_REPORT)

    def follow(self, stage: Stage, message: str, report: MotionReport) -> None:
        """Takes a report on the plan; it is passed on if it says something new, or now and then."""
        before = self.progress
        self.progress = replace(before, stage=stage, message=message, motion=report)
        if _news(before) != _news(self.progress):
            self._pass_on()
        else:
            self.beat()

    def beat(self) -> None:
        """Tells the same once more if the last time was long ago: whoever listens knows we live."""
        if self._clock.now() - self._told >= PERIOD_SECONDS:
            self._pass_on()

    def _pass_on(self) -> None:
        self._told = self._clock.now()
        self._report(self.progress)


def _news(progress: Progress) -> tuple[object, ...]:
    motion = progress.motion
    return progress.stage, progress.message, motion.state, motion.moves_done, motion.phase
