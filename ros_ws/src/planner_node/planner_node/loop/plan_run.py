# SPDX-License-Identifier: Apache-2.0
"""One plan in the loop: handed over, followed to its end, stopped, and what its end means."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NoReturn

from tamp_runtime.motion_report import ArmPlace, MotionReason, MotionReport, MotionState

from ..errors import (
    ArmStuckError,
    CancelledError,
    ConflictError,
    MotionBusyError,
    MotionFailedError,
    MotionSilentError,
    PlannerError,
)
from ..settings import Settings
from .account import describe_arm, describe_step
from .arm_home import PASSING
from .motion_link import MotionLink
from .plan import Plan
from .plan_watch import PlanSight, PlanWatch
from .report import Stage
from .scene import Sighting
from .teller import Teller


@dataclass(frozen=True)
class PlanEnd:
    """How a plan ended.

    Attributes:
        report: what the motion node said last of it.
        silence: the error if it fell silent about it.
        contradicted: it was stopped since something else was seen than it predicts.
    """

    report: MotionReport
    silence: MotionSilentError | None = None
    contradicted: bool = False


class PlanRun:
    """Carries plans out, one after the other.

    Args:
        because: told why a plan failed.
        cancelled, conflict: why the run is to end; ``stopped``: whether it is, polled.
        shut_down: the node ends, so that nobody can wait for the arm.
        newest: what perception reported last.
    """

    def __init__(
        self,
        settings: Settings,
        motion: MotionLink,
        teller: Teller,
        because: Callable[[str], None],
        cancelled: Callable[[], bool],
        conflict: Callable[[], str],
        stopped: Callable[[], bool],
        shut_down: Callable[[], bool],
        newest: Callable[[], Sighting | None],
    ) -> None:
        self._settings = settings
        self._motion = motion
        self._teller = teller
        self._because = because
        self._cancelled = cancelled
        self._conflict = conflict
        self._stopped = stopped
        self._shut_down = shut_down
        self._newest = newest
        self._infeasible = False
        self._watch: PlanWatch | None = None
        self._told: PlanSight | None = None

    def carry_out(self, plan: Plan, watch: PlanWatch | None = None) -> PlanEnd:
        """Hands a plan to the motion node and follows it to its end.

        Args:
            watch: stops it where what is seen contradicts it.

        Raises:
            CancelledError, ConflictError: it was stopped, and the arm rests.
            ArmStuckError: it was stopped, and the arm does not come home.
            MotionSilentError: the motion node does not answer, and does not come back.
        """
        moves = ", ".join(
            f"{block} to stack{move.target}" for block, move in zip(plan.blocks, plan.moves)
        )
        self._watch, self._told = watch, None
        plan = replace(plan, watched=watch is not None)
        self._teller.begin(plan)
        self._teller.tell(Stage.OPTIMISING, f"{len(plan.moves)} moves: {moves}")
        self._motion.start(plan)
        try:
            end = self._motion.follow(self._on_report, self._stopped_or_contradicted)
        except MotionSilentError as error:
            self._motion.stop(plan.plan_id)
            return self._outlast(error)
        except Exception:
            # Whatever went wrong here, the motion shall not go on with a plan that is given up.
            self._motion.stop(plan.plan_id)
            raise
        if end is None and watch is not None and watch.contradiction and not self._stopped():
            return self._stop_short(plan, watch.contradiction)
        if end is None:
            self._stop(plan)
        return PlanEnd(end)

    def helpful(self, plan: Plan) -> str:
        """What would help a plan that was refused, in words; empty if nobody knows.

        Nothing moves. See ``explain`` of SymbolicPlan.
        """
        asked = replace(plan, plan_id=f"why-{uuid.uuid4().hex[:12]}", explain=True)
        self._watch = None
        self._teller.tell(Stage.OPTIMISING, "looking for what would help")
        self._motion.start(asked)
        try:
            end = self._motion.follow(self._on_report, self._stopped)
            if end is None:
                self._motion.stop(asked.plan_id)
                end = self._motion.follow(self._on_report, self._shut_down)
        except MotionSilentError:
            end = None
        return end.suggestion if end is not None else ""

    def judge(self, end: PlanEnd) -> PlannerError | None:
        """The error of a motion that failed for good; None if another look tells what to do.

        Raises:
            CancelledError, ConflictError, MotionBusyError: somebody else moves the arm.
        """
        infeasible_before, self._infeasible = self._infeasible, False
        report = end.report
        if end.silence is not None or report.state == MotionState.SUCCEEDED:
            return None
        if end.contradicted and report.state == MotionState.CANCELLED:
            return None
        if report.state == MotionState.CANCELLED:
            raise CancelledError(f"somebody else stopped the motion: {report.message}")
        sentence = report.message or "the motion node gives no reason"
        self._because(sentence)
        if report.reason in PASSING:
            return None
        # The poses are seen anew, which may be enough; from the same poses it would fail again.
        if report.reason == MotionReason.INFEASIBLE and not infeasible_before:
            self._infeasible = True
            return None
        if report.reason == MotionReason.CONFLICT:
            raise ConflictError(sentence)
        if report.reason == MotionReason.BUSY:
            if self._motion.foreign:  # it is stopped before the next look
                return None
            raise MotionBusyError(sentence, report.plan_id)
        return MotionFailedError(sentence)

    def _stopped_or_contradicted(self) -> bool:
        watch = self._watch
        if self._stopped() or watch is None:
            return self._stopped()
        contradicted = watch.see(self._newest())
        sight = watch.sight
        if sight is not None and sight != self._told:
            self._motion.tell_sight(sight)
        self._told = sight
        return contradicted

    def _stop_short(self, plan: Plan, contradiction: str) -> PlanEnd:
        """Stops a plan that what is seen contradicts, and waits until the arm is home."""
        self._because(contradiction)
        self._teller.say(f"stopping: {contradiction}")
        self._motion.stop(plan.plan_id)
        try:
            end = self._motion.follow(self._on_report, self._stopped)
        except MotionSilentError as error:
            return self._outlast(error)
        if end is None:
            self._stop(plan)
        return PlanEnd(end, contradicted=True)

    def _outlast(self, error: MotionSilentError) -> PlanEnd:
        """Waits until a motion node that fell silent reports again; raises if it does not."""
        self._because(str(error))
        motion = self._motion
        if not error.speaks:
            if not error.taken_up:
                raise error
            self._teller.say(f"waiting until the motion node reports again: {error}")
            before = motion.reports
            if not motion.wait(
                lambda: motion.reports > before,
                self._settings.motion_silence_timeout,
                self._stopped,
            ):
                if self._cancelled():
                    raise CancelledError(f"cancelled; {error}") from error
                raise error
        return PlanEnd(self._teller.progress.motion, error)

    def _stop(self, plan: Plan) -> NoReturn:
        """Stops the motion, waits until it rests, and raises why it was stopped."""
        conflict = "" if self._cancelled() else self._conflict()
        self._teller.tell(Stage.CANCELLING, "waiting until the arm rests and holds nothing")
        self._motion.stop(plan.plan_id)

        def shut_down() -> bool:
            self._teller.beat()
            return self._shut_down()

        try:
            end = self._motion.follow(self._on_report, shut_down)
        except MotionSilentError as error:
            if conflict:
                raise ConflictError(f"{conflict}; {error}") from error
            if not error.untouched:
                raise
            raise CancelledError(f"cancelled before anything moved; {error}") from error
        done = f"{self._teller.progress.motion.moves_done} of {len(plan.moves)}"
        moved = f"{done} moves were carried out"
        if end is not None and end.message:
            moved += f": {end.message}"
        if conflict:
            raise ConflictError(f"{conflict}; {moved}")
        if end is not None and end.state == MotionState.FAILED and _is_out(end):
            raise ArmStuckError(f"cancelled; {moved}; {describe_arm(end)}")
        raise CancelledError(f"cancelled; {moved}")

    def _on_report(self, report: MotionReport) -> None:
        if self._watch is not None:
            self._watch.hear(report)
        stage, message = self._teller.progress.stage, self._teller.progress.message
        if stage != Stage.CANCELLING:
            optimising = report.state == MotionState.OPTIMISING
            stage = Stage.OPTIMISING if optimising else Stage.EXECUTING
            message = report.message or message if optimising else describe_step(report)
        self._teller.follow(stage, message, report)


def _is_out(report: MotionReport) -> bool:
    """Whether the arm rests before the camera, or holds something."""
    return report.arm == ArmPlace.RESTING or bool(report.held)
