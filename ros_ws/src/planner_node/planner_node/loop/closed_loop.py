# SPDX-License-Identifier: Apache-2.0
"""The closed loop: perceive, plan, move, perceive again, until the camera confirms the goal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, Final, NoReturn

from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from scene_graph import Stacks, format_stacks

from ..errors import (
    CancelledError,
    MotionBusyError,
    MotionFailedError,
    MotionSilentError,
    PlannerError,
    TooManyReplansError,
)
from ..goals.goal import Goal
from ..search import SearchResult, make_plan
from ..settings import Settings
from .clock import Clock
from .motion_link import MotionLink
from .plan import Plan, plan_for
from .report import NO_REPORT, Outcome, Progress, Stage, Status
from .scene import Scene
from .scene_watch import SceneWatch

#: The scene is not what it was planned on: look again and plan anew.
REPLAN_REASONS: Final = (
    MotionReason.GRASP_LOST,
    MotionReason.TRACKING_LOST,
    MotionReason.TIMEOUT,
)


class ClosedLoop:
    """One run of achieve_goal.

    Attributes:
        outcome: kept up to date as the run goes on, so that it can be given even after a defect.
    """

    def __init__(
        self,
        settings: Settings,
        scenes: SceneWatch,
        motion: MotionLink,
        report: Callable[[Progress], None],
        cancelled: Callable[[], bool],
        shut_down: Callable[[], bool],
        clock: Clock | None = None,
    ) -> None:
        """``report`` gets every progress; ``cancelled`` includes ``shut_down``."""
        self._settings = settings
        self._scenes = scenes
        self._motion = motion
        self._report = report
        self._cancelled = cancelled
        self._shut_down = shut_down
        self._clock = clock or Clock()
        self._requested = scenes.now()
        self._progress = Progress()
        self.outcome = Outcome()

    def run(self, read: Callable[[], Callable[[Stacks], Goal]]) -> Outcome:
        """Works until the goal is confirmed or cannot be reached; every end is an outcome.

        Args:
            read: gives the function that resolves the goal in the first scene.
        """
        try:
            status, message = self._achieve(read)
            self._note(status=status, message=message)
        except PlannerError as error:
            self._note(status=Status[error.status], message=str(error), module=error.module)
        return self.outcome

    def _achieve(self, read: Callable[[], Callable[[Stacks], Goal]]) -> tuple[Status, str]:
        self._tell(Stage.PERCEIVING, "reading the goal")
        with self._timed("perceive_seconds"):
            resolve = read()
        scene = self._look(Stage.PERCEIVING, "waiting for a confident scene graph")
        goal = resolve(scene.stacks)
        self._note(initial=scene)
        plans, infeasible, reason = 0, False, ""
        while not goal.holds(scene.stacks):
            if plans:
                self._count_replan(scene, reason)
            found = self._plan(scene, goal)
            if not plans:
                self._note(moves_planned=len(found.moves))
            plans += 1
            end = self._move(plan_for(scene, goal, found, self._scenes.now()))
            reason = self._judge(end, infeasible)
            infeasible = bool(reason) and end.reason == MotionReason.INFEASIBLE
            scene = self._look(
                Stage.CONFIRMING, reason or "looking whether the goal is reached", goal.names
            )
        seen = format_stacks(scene.stacks)
        if not plans:
            return Status.ALREADY_TRUE, f"nothing to do: '{goal}' holds in {seen}"
        return Status.SUCCESS, f"the camera confirms '{goal}': {seen}"

    def _look(self, stage: Stage, message: str, needed: frozenset[str] = frozenset()) -> Scene:
        """The scene after the request and the last motion, with the ``needed`` objects in it."""
        self._tell(stage, message)
        after = max(self._requested, self._motion.last_end)
        with self._timed("perceive_seconds"):
            scene = self._scenes.wait(self._cancelled, after, needed)
        self._note(final=scene)
        return scene

    def _count_replan(self, scene: Scene, reason: str) -> None:
        replans = self.outcome.replans
        if replans >= self._settings.max_replans:
            raise TooManyReplansError(
                f"gave up after {replans} replans; the camera last saw "
                f"{format_stacks(scene.stacks)}{f' after: {reason}' if reason else ''}",
                replans,
            )
        self._note(replans=replans + 1)
        self._progress = replace(self._progress, replans=replans + 1)

    def _plan(self, scene: Scene, goal: Goal) -> SearchResult:
        self._tell(Stage.PLANNING, f"searching from {format_stacks(scene.stacks)} to '{goal}'")
        with self._timed("plan_seconds"):
            return make_plan(
                scene.stacks,
                goal,
                self._settings.max_expansions,
                self._cancelled,
                self._settings.search_algorithm,
            )

    def _move(self, plan: Plan) -> MotionReport:
        """Hands a plan to the motion node and follows it to its end."""
        moves = ", ".join(
            f"{block} to stack{move.target}" for block, move in zip(plan.blocks, plan.moves)
        )
        self._progress = replace(self._progress, plan=plan, motion=NO_REPORT)
        self._tell(Stage.OPTIMISING, f"{len(plan.moves)} moves: {moves}")
        started = self._clock.now()
        self._motion.start(plan)
        try:
            end = self._motion.follow(self._on_report, self._cancelled)
            if end is None:
                self._stop(plan)
        except CancelledError:
            raise
        except Exception:
            # Whatever went wrong here, the motion shall not go on with a plan that is given up.
            self._motion.stop(plan)
            raise
        finally:
            self._add_up(self._progress.motion, self._clock.now() - started)
        return end

    def _add_up(self, last: MotionReport, elapsed: float) -> None:
        """Notes what became of a plan; ``elapsed`` [s] is motion optimisation and execution."""
        outcome = self.outcome
        execution = max(0.0, elapsed - last.optimisation_seconds)
        self._note(
            motion=last,
            moves_executed=outcome.moves_executed + last.moves_done,
            motion_seconds=outcome.motion_seconds + last.optimisation_seconds,
            execute_seconds=outcome.execute_seconds + execution,
        )

    def _stop(self, plan: Plan) -> NoReturn:
        """Stops the motion, waits until it rests, and raises CancelledError."""
        self._tell(Stage.CANCELLING, "waiting until the arm rests and holds nothing")
        self._motion.stop(plan)
        try:
            end = self._motion.follow(self._on_report, self._shut_down)
        except MotionSilentError as error:
            if error.taken_up:
                raise
            raise CancelledError(f"cancelled before anything moved; {error}") from error
        moved = f"{self._progress.motion.moves_done} of {len(plan.moves)} moves were carried out"
        outcome = f": {end.message}" if end is not None and end.message else ""
        raise CancelledError(f"cancelled; {moved}{outcome}")

    def _judge(self, end: MotionReport, infeasible_before: bool) -> str:
        """Why to plan anew, or an empty string if the plan was carried out; raises if neither."""
        if end.state == MotionState.SUCCEEDED:
            return ""
        if end.state == MotionState.CANCELLED:
            raise CancelledError(f"somebody else stopped the motion: {end.message}")
        sentence = end.message or "the motion node gives no reason"
        if end.reason in REPLAN_REASONS:
            return sentence
        # The poses are seen anew, which may be enough; from the same poses it would fail again.
        if end.reason == MotionReason.INFEASIBLE and not infeasible_before:
            return sentence
        if end.reason == MotionReason.BUSY:
            raise MotionBusyError(sentence, end.plan_id)
        raise MotionFailedError(sentence)

    def _on_report(self, report: MotionReport) -> None:
        stage = self._progress.stage
        if stage != Stage.CANCELLING:
            optimising = report.state == MotionState.OPTIMISING
            stage = Stage.OPTIMISING if optimising else Stage.EXECUTING
        self._progress = replace(self._progress, motion=report)
        self._tell(stage, report.message)

    def _tell(self, stage: Stage, message: str) -> None:
        self._progress = replace(self._progress, stage=stage, message=message)
        self._report(self._progress)

    def _note(self, **changes: Any) -> None:
        self.outcome = replace(self.outcome, **changes)

    @contextmanager
    def _timed(self, field: str) -> Iterator[None]:
        """Adds the wall time that passes inside to a field of the outcome."""
        started = self._clock.now()
        try:
            yield
        finally:
            elapsed = self._clock.now() - started
            self._note(**{field: getattr(self.outcome, field) + elapsed})
