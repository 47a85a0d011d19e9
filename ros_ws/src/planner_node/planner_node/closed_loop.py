# SPDX-License-Identifier: Apache-2.0
"""The closed loop: perceive, plan, move, perceive again, until the camera confirms the goal."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NoReturn

from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SymbolicPlan

from scene_graph import format_stacks

from .conversions import Scene, predicted_scenes, status_code
from .errors import (
    CancelledError,
    MotionBusyError,
    MotionFailedError,
    MotionSilentError,
    PlannerError,
    TooManyReplansError,
)
from .goals import Goal
from .motion_link import MotionLink
from .planning import make_plan
from .scene_watch import SceneWatch
from .search import SearchResult
from .settings import Settings

Feedback = AchieveGoal.Feedback

#: The scene is not what it was planned on: look again and plan anew.
REPLAN_REASONS = (MotionStatus.GRASP_LOST, MotionStatus.TRACKING_LOST, MotionStatus.TIMEOUT)


class ClosedLoop:
    """One run of achieve_goal."""

    def __init__(
        self,
        settings: Settings,
        scenes: SceneWatch,
        motion: MotionLink,
        make_message: Callable[[Scene, Goal, SearchResult], SymbolicPlan],
        report: Callable[[AchieveGoal.Feedback], None],
        cancelled: Callable[[], bool],
        shut_down: Callable[[], bool],
    ) -> None:
        """``report`` gets every feedback; ``cancelled`` includes ``shut_down``."""
        self._settings = settings
        self._scenes = scenes
        self._motion = motion
        self._make_message = make_message
        self._report = report
        self._cancelled = cancelled
        self._shut_down = shut_down
        self._requested = scenes.now()
        self._feedback = AchieveGoal.Feedback()
        #: Filled as the run goes on, so that it can be given even after a defect.
        self.result = AchieveGoal.Result()

    def run(self, read: Callable[[], Callable[[Scene], Goal]]) -> AchieveGoal.Result:
        """Works until the goal is confirmed or cannot be reached; every outcome is a result.

        Args:
            read: gives the function that resolves the goal against the first scene.
        """
        result = self.result
        try:
            result.status, result.message = self._achieve(read)
        except PlannerError as error:
            result.status, result.message = status_code(error), str(error)
            result.module = error.module
        return result

    def _achieve(self, read: Callable[[], Callable[[Scene], Goal]]) -> tuple[int, str]:
        result = self.result
        self._tell(Feedback.PERCEIVING, "reading the goal")
        with self._timed("perceive_seconds"):
            resolve = read()
        scene = self._look(Feedback.PERCEIVING, "waiting for a confident scene graph")
        goal = resolve(scene)
        result.initial = scene.message
        plans, infeasible, reason = 0, False, ""
        while not goal.holds(scene.stacks):
            if plans:
                self._count_replan(scene, reason)
            found = self._plan(scene, goal)
            if not plans:
                result.moves_planned = len(found.moves)
            plans += 1
            end = self._move(self._make_message(scene, goal, found), scene, found)
            reason = self._judge(end, infeasible)
            infeasible = end.state == MotionStatus.FAILED and end.reason == MotionStatus.INFEASIBLE
            scene = self._look(
                Feedback.CONFIRMING, reason or "looking whether the goal is reached", goal.names
            )
        seen = format_stacks(scene.stacks)
        if not plans:
            return AchieveGoal.Result.ALREADY_TRUE, f"nothing to do: '{goal}' holds in {seen}"
        return AchieveGoal.Result.SUCCESS, f"the camera confirms '{goal}': {seen}"

    def _look(self, stage: int, message: str, needed: frozenset[str] = frozenset()) -> Scene:
        """The scene after the request and the last motion, with the ``needed`` objects in it."""
        self._tell(stage, message)
        after = max(self._requested, self._motion.last_end)
        with self._timed("perceive_seconds"):
            scene = self._scenes.wait(self._cancelled, after, needed)
        self.result.final = scene.message
        return scene

    def _count_replan(self, scene: Scene, reason: str) -> None:
        if self.result.replans >= self._settings.max_replans:
            raise TooManyReplansError(
                f"gave up after {self.result.replans} replans; the camera last saw "
                f"{format_stacks(scene.stacks)}{f' after: {reason}' if reason else ''}",
                self.result.replans,
            )
        self.result.replans += 1
        self._feedback.replans = self.result.replans

    def _plan(self, scene: Scene, goal: Goal) -> SearchResult:
        self._tell(Feedback.PLANNING, f"searching from {format_stacks(scene.stacks)} to '{goal}'")
        with self._timed("plan_seconds"):
            return make_plan(scene.stacks, goal, self._settings.max_expansions, self._cancelled)

    def _move(self, plan: SymbolicPlan, scene: Scene, found: SearchResult) -> MotionStatus:
        """Hands a plan to the motion node and follows it to its end."""
        self._feedback.plan = plan
        self._feedback.states = predicted_scenes(scene, found)
        self._feedback.motion = MotionStatus()
        moves = ", ".join(f"{item.object_name} to stack{item.target}" for item in plan.moves)
        self._tell(Feedback.OPTIMISING, f"{len(plan.moves)} moves: {moves}")
        started = time.monotonic()
        self._motion.start(plan)
        try:
            end = self._motion.follow(self._on_status, self._cancelled)
            if end is None:
                self._stop(plan)
        except CancelledError:
            raise
        except Exception:
            # Whatever went wrong here, the motion shall not go on with a plan that is given up.
            self._motion.stop(plan)
            raise
        finally:
            last = self._feedback.motion
            self.result.motion = last
            self.result.moves_executed += last.moves_done
            self.result.motion_seconds += last.optimisation_seconds
            elapsed = time.monotonic() - started
            self.result.execute_seconds += max(0.0, elapsed - last.optimisation_seconds)
        return end

    def _stop(self, plan: SymbolicPlan) -> NoReturn:
        """Stops the motion, waits until it rests, and raises CancelledError."""
        self._tell(Feedback.CANCELLING, "waiting until the arm rests and holds nothing")
        self._motion.stop(plan)
        try:
            end = self._motion.follow(self._on_status, self._shut_down)
        except MotionSilentError as error:
            if error.taken_up:
                raise
            raise CancelledError(f"cancelled before anything moved; {error}") from error
        moved = f"{self._feedback.motion.moves_done} of {len(plan.moves)} moves were carried out"
        outcome = f": {end.message}" if end is not None and end.message else ""
        raise CancelledError(f"cancelled; {moved}{outcome}")

    def _judge(self, end: MotionStatus, infeasible_before: bool) -> str:
        """Why to plan anew, or an empty string if the plan was carried out; raises if neither."""
        if end.state == MotionStatus.SUCCEEDED:
            return ""
        if end.state == MotionStatus.CANCELLED:
            raise CancelledError(f"somebody else stopped the motion: {end.message}")
        sentence = end.message or "the motion node gives no reason"
        if end.reason in REPLAN_REASONS:
            return sentence
        # The poses are seen anew, which may be enough; from the same poses it would fail again.
        if end.reason == MotionStatus.INFEASIBLE and not infeasible_before:
            return sentence
        if end.reason == MotionStatus.BUSY:
            raise MotionBusyError(sentence, end.plan_id)
        raise MotionFailedError(sentence)

    def _on_status(self, status: MotionStatus) -> None:
        self._feedback.motion = status
        if self._feedback.stage != Feedback.CANCELLING:
            executing = status.state != MotionStatus.OPTIMISING
            self._feedback.stage = Feedback.EXECUTING if executing else Feedback.OPTIMISING
        self._feedback.message = status.message
        self._report(self._feedback)

    def _tell(self, stage: int, message: str) -> None:
        self._feedback.stage = stage
        self._feedback.message = message
        self._report(self._feedback)

    @contextmanager
    def _timed(self, field: str) -> Iterator[None]:
        started = time.monotonic()
        try:
            yield
        finally:
            total = getattr(self.result, field) + time.monotonic() - started
            setattr(self.result, field, total)
