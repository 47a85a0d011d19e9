# SPDX-License-Identifier: Apache-2.0
"""Carries one plan out: optimise, send the trajectory, watch it, and end in an orderly way.

Runs in a thread of its own and is written as it happens, from top to bottom. Whatever goes wrong
on the way ends in a report; all waits have time limits.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any, Final

from tamp_runtime.motion_report import SOMETHING, MotionReason, MotionReport, MotionState

from scene_graph import SceneGraph

from ..errors import CancelledError, InfeasibleError, MotionError
from ..phases import HOME, PICK
from ..planner import Motion
from ..timing.trajectory import Trajectory
from .arm_state import ArmState, ArmStates
from .condition import REST_SECONDS, Condition
from .corrections import Corrections
from .errors import ClosedError, ExecutionError, findings
from .follow import Follower
from .last_look import LastLook, Sightings
from .motion_run import MotionRun
from .plan import Plan, Planner
from .recovery import Recovered, Recovery
from .settings import ExecutionSettings

#: How long an arm that has arrived may take to come to rest before that is said [s].
_SETTLING_SECONDS: Final = 3.0
#: For so long an arm that finds no way home among obstacles waits for others to be told [s].
OBSTACLES_PASS: Final = 10.0

#: Planner, plan, its motion, what is under way, from which of its times on, scene -> the rest.
CorrectFirst = Callable[[Any, Plan, Motion, Motion, float, SceneGraph], Motion]
#: Plan, state of the arm, why the plan was refused, whether to stop looking -> words.
Suggest = Callable[[Plan, ArmState, InfeasibleError, Callable[[], bool]], str]


class Executive:
    """Carries plans out, one at a time.

    Args:
        planner: the planner if there is one yet; it needs the robot description.
        arm: where the arm's states arrive.
        follower: makes the arm follow trajectories.
        condition: tells how the arm is.
        settings: asked for anew for each plan.
        conflict: why nothing may set out: somebody else does the same; empty: it may.
        check: raises InvalidPlanError for a plan that is not for this arm.
        suggest: what would help a plan that was refused, in words; empty: nobody knows.
        in_the_way: what has come into the rest of a motion's way, given the plan and the motion's
            time; empty: nothing.
        sightings: what is seen of plans that are watched.
        correct: solves the rest of a motion anew for blocks that were moved; None: nothing does.
    """

    def __init__(
        self,
        planner: Callable[[], Planner | None],
        arm: ArmStates,
        follower: Follower,
        condition: Condition,
        settings: Callable[[], ExecutionSettings],
        conflict: Callable[[], str] = lambda: "",
        check: Callable[[Plan], None] = lambda _plan: None,
        suggest: Suggest = lambda _plan, _state, _error, _stopped: "",
        in_the_way: Callable[[Plan, Motion, float], str] = lambda _plan, _motion, _time: "",
        sightings: Sightings | None = None,
        correct: CorrectFirst | None = None,
    ) -> None:
        self._sightings, self._correct = sightings or Sightings(), correct
        self._suggest, self._in_the_way = suggest, in_the_way
        self._planner, self._arm, self._settings, self._check = planner, arm, settings, check
        self._follower, self._condition, self._conflict = follower, condition, conflict
        self._publish: Callable[[MotionReport], None] = lambda _report: None
        self._report = MotionReport()
        self._motion: Motion | None = None
        self._before = ""
        follower.on_waiting = self._tell_waiting

    @property
    def report(self) -> MotionReport:
        """The newest report, progress included; any thread may ask."""
        return self._report

    def carry_out(
        self, plan: Plan, stop: threading.Event, publish: Callable[[MotionReport], None]
    ) -> None:
        """Carries out a plan; when it returns, its end has been published, or the node ends.

        A plan without moves brings the arm home from wherever it is, see :meth:`_tidy`.

        Args:
            stop: set from another thread to end early, as SymbolicPlan describes.
            publish: told every change of the report; the last one has ended.

        Raises:
            Exception: a defect, which has been reported as such.
        """
        self._publish = publish
        self._report = MotionReport(plan.plan_id, moves_total=len(plan.moves))
        self._follower.settings = self._settings()
        try:
            if plan.moves:
                self._tell(MotionState.OPTIMISING, f"optimising {len(plan.moves)} moves")
                self._plan_and_run(plan, stop)
            else:
                self._tell(MotionState.EXECUTING, "looking how the arm is")
                self._tidy()
        except ClosedError:
            return
        except CancelledError as error:
            self._tell(MotionState.CANCELLED, str(error))
        except MotionError as error:
            self._tell(MotionState.FAILED, str(error), **findings(error, len(plan.moves)))
        except Exception as error:
            sentence = f"a defect: {error!r}; the node's log has the traceback"
            self._tell(MotionState.FAILED, sentence, reason=MotionReason.INTERNAL_ERROR)
            raise

    def _plan_and_run(self, plan: Plan, stop: threading.Event) -> None:
        planner = self._wait_for_planner(stop.is_set)
        self._check(plan)
        state = self._follower.wait_for_rest(stop.is_set)
        if state is not None and not plan.explain and self._condition.held(state):
            self._empty_hand(planner)
            state = self._follower.wait_for_rest(stop.is_set)
        if state is None:
            raise CancelledError("stopped on request before anything moved")
        motion = self._motion_for(plan, planner, state, lambda: stop.is_set() or self._arm.closed)
        if plan.explain:
            raise CancelledError("the plan could be carried out; nothing was moved, as asked")
        if self._arm.closed:
            raise ClosedError("the node ends")
        self._check_conflict()
        self._motion = motion
        self._tell(
            MotionState.EXECUTING,
            "setting out",
            optimisation_seconds=motion.seconds,
            duration=motion.trajectory.duration,
        )
        self._run(plan, motion, planner, stop)

    def _motion_for(
        self, plan: Plan, planner: Planner, state: ArmState, stopped: Callable[[], bool]
    ) -> Motion:
        arm, fingers = state.positions.arm, state.positions.fingers
        try:
            return planner.solve(plan.graph, plan.moves, arm, fingers, plan.object_names, stopped)
        except InfeasibleError as error:
            if plan.explain:
                self._tell(MotionState.OPTIMISING, f"{error}; looking for what would help")
                error.suggestion = self._suggest(plan, state, error, stopped)
            raise

    def _wait_for_planner(self, stopped: Callable[[], bool] = lambda: False) -> Planner:
        timeout = self._follower.settings.description_timeout
        deadline = self._arm.now() + timeout
        while (planner := self._planner()) is None:
            if self._arm.closed:
                raise ClosedError("the node ends")
            if stopped():
                raise CancelledError("stopped on request before anything moved")
            if self._arm.now() > deadline:
                raise ExecutionError(
                    MotionReason.NO_JOINT_STATES,
                    f"no usable robot_description within {timeout:g} s; is the arm's driver (or "
                    "sim_node) running?",
                )
            time.sleep(0.05)
        return planner

    def _check_conflict(self) -> None:
        sentence = self._conflict()
        if sentence:
            raise ExecutionError(MotionReason.CONFLICT, sentence)

    def _run(self, plan: Plan, motion: Motion, planner: Planner, stop: threading.Event) -> None:
        follower = self._follower

        def on_progress(motion: Motion, at: float, before: float) -> None:
            self._tell_progress(motion.trajectory, at, before)
            if found := self._in_the_way(plan, motion, at):
                sentence = f"{found}; the arm was stopped"
                raise ExecutionError(MotionReason.OBSTRUCTED, sentence, recoverable=True)

        run = MotionRun(
            *(motion, follower, self._arm, *self._watching(plan, motion, planner)),
            *(on_progress, self._tell_standing, stop.is_set),
        )
        try:
            arrived = run.run()
        except ExecutionError as error:
            if not error.recoverable:
                raise
            try:
                if error.reason is MotionReason.OBSTRUCTED:
                    recovered = self._recover_obstructed(run.motion, str(error), stop)
                else:
                    recovered = self._recover(run.motion, planner, str(error))
            except ExecutionError as second:
                raise ExecutionError(error.reason, f"{error}; {second}") from error
            raise ExecutionError(error.reason, f"{error}; {recovered.sentence}") from error
        total = self._report.moves_total
        if arrived:
            self._settle()
            self._tell(
                MotionState.SUCCEEDED,
                "every move was carried out and the arm is home",
                moves_done=total,
                progress=1.0,
            )
            return
        recovered = self._recover(run.motion, planner, "stopped on request")
        sentence = (
            f"stopped on request after {self._report.moves_done} of {total} moves; "
            f"{recovered.sentence}"
        )
        if recovered.held:
            raise ExecutionError(MotionReason.GRASP_LOST, sentence)
        self._tell(MotionState.CANCELLED, sentence)

    def _watching(
        self, plan: Plan, motion: Motion, planner: Planner
    ) -> tuple[LastLook | None, Corrections | None]:
        """What is seen of a plan that is watched, and what comes of it."""
        if not plan.watched:
            return None, None
        look, solve = LastLook(self._sightings, plan.plan_id), self._correct

        def correct(now: Motion, at: float, graph: SceneGraph) -> Motion:
            assert solve is not None
            return solve(planner, plan, motion, now, at, graph)

        # Two controllers would have to go over to it at the same instant.
        can = solve is not None and self._follower.settings.in_step is None
        corrections = Corrections(plan, self._sightings, self._follower, correct if can else None)
        return look, corrections

    def _recover(self, motion: Motion, planner: Planner, why: str) -> Recovered:
        """Brings the arm home in the middle of a plan."""
        follower = self._follower
        self._tell(
            MotionState.EXECUTING,
            f"{why}; going home",
            moves_done=follower.moves_done,
            phase=HOME,
            object_name="",
        )
        self._stop_moving()
        return self._bring_home(motion, planner, f"{why}; ", in_order=True)

    def _recover_obstructed(self, motion: Motion, why: str, stop: threading.Event) -> Recovered:
        """The same among the obstacles of now; where there is no way, among others that come soon.

        What came into the way of the arm is often a person's, and gone in a moment.
        """
        self._stop_moving()
        deadline = self._arm.now() + OBSTACLES_PASS
        while True:
            planner = self._wait_for_planner()
            try:
                return self._recover(motion, planner, why)
            except ExecutionError as error:
                if error.reason is not MotionReason.INFEASIBLE:
                    raise
                for _ in self._follower.states():
                    if self._planner() not in (planner, None):
                        break
                    if stop.is_set() or self._arm.closed or self._arm.now() > deadline:
                        raise

    def _stop_moving(self) -> None:
        if self._follower.under_way:
            try:
                self._follower.brake()
            except ExecutionError as error:
                if not error.recoverable:
                    raise

    def _tidy(self) -> None:
        """Brings an arm home that no plan moves: it was left somewhere, or holds something."""
        planner = self._wait_for_planner()
        self._follower.wait_for_rest()
        self._check_conflict()
        recovered = self._bring_home(self._motion, planner, "", in_order=False)
        if recovered.held:
            raise ExecutionError(MotionReason.GRASP_LOST, recovered.sentence)
        self._tell(MotionState.CANCELLED, recovered.sentence)

    def _empty_hand(self, planner: Planner) -> None:
        """A plan starts with an empty hand; returns if it is empty after all.

        Raises:
            ExecutionError: if something was held, whether it could be put down or not.
        """
        held = self._condition.held()
        self._check_conflict()
        recovered = self._bring_home(self._motion, planner, "", in_order=False)
        if recovered.held:
            raise ExecutionError(MotionReason.GRASP_LOST, recovered.sentence)
        if held != SOMETHING:
            raise ExecutionError(
                MotionReason.TRACKING_LOST,
                f"the hand held {held} when the plan came; {recovered.sentence}; look again",
            )

    def _bring_home(
        self, motion: Motion | None, planner: Planner, prefix: str, in_order: bool
    ) -> Recovered:
        def tell(sentence: str, kind: str, block: str) -> None:
            message = f"{prefix}{sentence}"
            self._tell(MotionState.EXECUTING, message, phase=kind, object_name=block)

        recovery = Recovery(
            self._follower,
            planner,
            self._condition,
            motion,
            self._follower.moves_done,
            in_order,
            tell,
        )
        try:
            recovered = recovery.bring_home()
        finally:
            if in_order:
                self._report = replace(self._report, moves_done=recovery.moves_done)
        self._settle()
        return recovered

    def _settle(self) -> None:
        """Waits until the arm is seen to rest, so that the end of the plan can say so."""
        with suppress(ExecutionError):
            self._follower.wait_for_rest(seconds=REST_SECONDS, within=_SETTLING_SECONDS)

    # Reports

    def _tell(self, state: MotionState, message: str, **changes: Any) -> None:
        self._report = replace(self._report, state=state, message=message, **changes)
        self._publish(self._report)

    def _tell_waiting(self, sentence: str) -> None:
        """Something has been awaited for a while, or no more if there is no sentence."""
        if sentence:
            self._before = self._report.message
        message = f"{self._before}; {sentence}" if sentence else self._before
        self._tell(self._report.state, message)

    def _tell_standing(self, sentence: str) -> None:
        self._tell(MotionState.EXECUTING, sentence)

    def _tell_progress(self, trajectory: Trajectory, at: float, elapsed: float) -> None:
        phase = trajectory.interval_at(at).phase
        before = self._report
        self._report = replace(
            before,
            move=min(phase.move, max(before.moves_total - 1, 0)),
            moves_done=trajectory.moves_done(at),
            phase=phase.kind,
            object_name=phase.object_name,
            progress=(elapsed + at) / (elapsed + trajectory.duration),
        )
        if (before.phase, before.move) != (self._report.phase, self._report.move):
            doing = {PICK: f"picking {phase.object_name}", HOME: "going home"}
            self._tell(MotionState.EXECUTING, doing.get(phase.kind, f"placing {phase.object_name}"))
