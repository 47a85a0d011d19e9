# SPDX-License-Identifier: Apache-2.0
"""Carries one plan out: optimise, send the trajectory, watch it, and end in an orderly way.

Runs in a thread of its own and is written as it happens, from top to bottom. Whatever goes wrong
on the way ends in a report; all waits have time limits.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from scene_graph import Move, SceneGraph

from ..errors import CancelledError, InfeasibleError, InvalidPlanError
from ..phases import HOME, PICK
from ..planner import Motion
from ..timing.trajectory import Trajectory
from .arm_state import ArmStates
from .follow import ExecutionError, ExecutionSettings, Follower

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Plan:
    """A symbolic plan as the executive needs it."""

    plan_id: str
    graph: SceneGraph
    moves: tuple[Move, ...]
    object_names: tuple[str, ...]


class Planner(Protocol):
    """What plans motions; see :class:`motion_node.planner.MotionPlanner`."""

    @property
    def solve(self) -> Callable[..., Motion]:
        """Plans the motion that carries out moves in a scene, and goes home."""

    def solve_way_home(self, motion: Motion, moves_done: int, arm: Array, fingers: Array) -> Motion:
        """The way home of an empty hand in the middle of a plan."""


class Executive:
    """Carries plans out, one at a time.

    Args:
        planner: the planner if there is one yet; it needs the robot description.
        arm: where the arm's states arrive.
        send: publishes a trajectory, which replaces the running one.
        settings: asked for anew for each plan.
    """

    def __init__(
        self,
        planner: Callable[[], Planner | None],
        arm: ArmStates,
        send: Callable[[Trajectory], None],
        settings: Callable[[], ExecutionSettings],
    ) -> None:
        self._planner = planner
        self._arm, self._send, self._settings = arm, send, settings
        self._publish: Callable[[MotionReport], None] = lambda _report: None
        self._report = MotionReport()

    @property
    def report(self) -> MotionReport:
        """The newest report, progress included; any thread may ask."""
        return self._report

    def carry_out(
        self, plan: Plan, stop: threading.Event, publish: Callable[[MotionReport], None]
    ) -> None:
        """Carries out a plan; when it returns, its end has been published.

        Args:
            stop: set from another thread to end early, as SymbolicPlan describes.
            publish: told every change of the report; the last one has ended.

        Raises:
            Exception: a defect, which has been reported as such.
        """
        self._publish = publish
        self._report = MotionReport(plan.plan_id, moves_total=len(plan.moves))
        self._tell(MotionState.OPTIMISING, f"optimising {len(plan.moves)} moves")
        try:
            self._plan_and_run(plan, stop)
        except CancelledError as error:
            self._tell(MotionState.CANCELLED, str(error))
        except InvalidPlanError as error:
            self._fail(
                MotionReason.INVALID_PLAN,
                str(error),
                object_name=error.object_name,
                move=max(error.move, 0),
            )
        except InfeasibleError as error:
            self._fail(
                MotionReason.INFEASIBLE,
                str(error),
                bound=error.bound,
                object_name=error.object_name,
                constraint=error.constraint,
                move=min(error.move, max(len(plan.moves) - 1, 0)),
                phase=error.phase,
            )
        except ExecutionError as error:
            self._fail(error.reason, str(error))
        except Exception as error:
            self._fail(
                MotionReason.INTERNAL_ERROR,
                f"a defect: {error!r}; the node's log has the traceback",
            )
            raise

    def _plan_and_run(self, plan: Plan, stop: threading.Event) -> None:
        settings = self._settings()
        follower = Follower(self._arm, self._send, settings)
        planner = self._wait_for_planner(settings.description_timeout, stop)
        state = follower.wait_for_rest(stop.is_set)
        if state is None:
            raise CancelledError("stopped on request before anything moved")
        motion = planner.solve(
            plan.graph,
            plan.moves,
            state.positions.arm,
            state.positions.fingers,
            plan.object_names,
            stop.is_set,
        )
        self._tell(
            MotionState.EXECUTING,
            "setting out",
            optimisation_seconds=motion.seconds,
            duration=motion.trajectory.duration,
        )
        self._run(motion, planner, follower, stop)

    def _wait_for_planner(self, seconds: float, stop: threading.Event) -> Planner:
        deadline = self._arm.now() + seconds
        while (planner := self._planner()) is None:
            if stop.wait(0.05):
                raise CancelledError("stopped on request before anything moved")
            if self._arm.now() > deadline:
                raise ExecutionError(
                    MotionReason.NO_JOINT_STATES,
                    "no usable robot_description arrives; is the arm's driver (or sim_node) "
                    "running?",
                )
        return planner

    def _run(
        self,
        motion: Motion,
        planner: Planner,
        follower: Follower,
        stop: threading.Event,
    ) -> None:
        try:
            arrived = follower.follow(
                motion.trajectory,
                self._tell_progress,
                lambda: stop.is_set() and follower.empty_handed,
            )
        except ExecutionError as error:
            if not error.recoverable:
                raise
            try:
                self._go_home(motion, planner, follower, str(error))
            except (ExecutionError, InfeasibleError) as second:
                raise ExecutionError(
                    error.reason, f"{error}; the arm could not go home: {second}"
                ) from error
            raise ExecutionError(error.reason, f"{error}; the arm is home") from error
        if arrived:
            total = self._report.moves_total
            self._tell(
                MotionState.SUCCEEDED,
                "every move was carried out and the arm is home",
                moves_done=total,
                progress=1.0,
            )
            return
        self._go_home(motion, planner, follower, "stopped on request")
        done, total = self._report.moves_done, self._report.moves_total
        self._tell(
            MotionState.CANCELLED,
            f"stopped on request after {done} of {total} moves; the arm is home",
        )

    def _go_home(self, motion: Motion, planner: Planner, follower: Follower, why: str) -> None:
        """Brakes, opens the fingers, rises, and goes home."""
        phase = follower.interval.phase
        moves_done = phase.move + 1 if follower.let_go else phase.move
        self._tell(
            MotionState.EXECUTING,
            f"{why}; going home",
            moves_done=moves_done,
            phase=HOME,
            object_name="",
        )
        state = follower.brake()
        home = planner.solve_way_home(
            motion, moves_done, state.positions.arm, state.positions.fingers
        )
        follower.follow(home.trajectory)

    # Reports

    def _tell(self, state: MotionState, message: str, **changes: Any) -> None:
        self._report = replace(self._report, state=state, message=message, **changes)
        self._publish(self._report)

    def _fail(self, reason: MotionReason, message: str, **changes: Any) -> None:
        self._tell(MotionState.FAILED, message, reason=reason, **changes)

    def _tell_progress(self, trajectory: Trajectory, at: float) -> None:
        phase = trajectory.interval_at(at).phase
        before = self._report
        self._report = replace(
            before,
            move=min(phase.move, max(before.moves_total - 1, 0)),
            moves_done=trajectory.moves_done(at),
            phase=phase.kind,
            object_name=phase.object_name,
            progress=at / trajectory.duration,
        )
        if (before.phase, before.move) != (self._report.phase, self._report.move):
            doing = {PICK: f"picking {phase.object_name}", HOME: "going home"}
            self._tell(MotionState.EXECUTING, doing.get(phase.kind, f"placing {phase.object_name}"))
