# SPDX-License-Identifier: Apache-2.0
"""Runs one task on a running graph and judges it by the ground truth."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable

from tamp_interfaces.action import AchieveGoal

from planner_node.cli.client import PlannerClient
from planner_node.cli.unavailable import PlannerUnavailableError
from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import SceneGraph, rows_of

from .processes import NodeDiedError
from .scene_observer import SceneObserver, SimulationError, true_stacks
from .task import Failure, TaskResult, triples

OnFeedback = Callable[[AchieveGoal.Feedback], None]

#: How long a task may take before it counts as failed [s].
TASK_TIMEOUT = 900.0
CANCEL_TIMEOUT = 120.0


def run_task(
    planner: PlannerClient,
    observer: SceneObserver,
    initial: SceneGraph,
    goal: str,
    on_feedback: OnFeedback = lambda _: None,
    check_alive: Callable[[], None] = lambda: None,
    timeout: float = TASK_TIMEOUT,
) -> TaskResult:
    """Has the planner achieve a goal and compares the outcome with the ground truth.

    Args:
        initial: the ground truth before.
        check_alive: called now and then; raises NodeDiedError if waiting has become pointless.

    Raises:
        KeyboardInterrupt: after the running goal was cancelled and the arm rests.
    """
    started = time.monotonic()
    result: AchieveGoal.Result | None = None
    failure: Failure | None = None
    try:
        planner.start(goal)
        while not planner.is_done():
            check_alive()
            if time.monotonic() - started > timeout:
                planner.cancel()
                failure = Failure("planner", f"not done after {timeout:g} s; cancelled")
                break
            if feedback := planner.next_feedback(timeout=0.05):
                on_feedback(feedback)
        result = planner.result(timeout=CANCEL_TIMEOUT)
    except (PlannerUnavailableError, TimeoutError) as error:
        failure = failure or Failure("planner", str(error))
    except NodeDiedError as error:
        failure = Failure(error.node.removesuffix("_node"), str(error))
    except KeyboardInterrupt:
        with contextlib.suppress(PlannerUnavailableError, TimeoutError):  # the nodes go down anyhow
            planner.withdraw()
            if planner.is_started:
                planner.result(timeout=CANCEL_TIMEOUT)
        raise
    total = time.monotonic() - started

    try:
        final = observer.fresh_truth()
    except SimulationError as error:
        final = SceneGraph((), frozenset())
        failure = failure or Failure("sim", str(error))
    stacks = true_stacks(final)
    reached = goal_holds(goal, final)
    if result is not None and failure is None:
        claimed = result.status in (result.SUCCESS, result.ALREADY_TRUE)
        if not claimed:
            failure = Failure(result.module, result.message)
        elif not reached:
            failure = Failure("perception", f"success was claimed, but the truth is {stacks}")
    return TaskResult(
        success=reached and failure is None,
        goal=goal,
        initial=triples(initial.relations),
        final=triples(final.relations),
        moves_planned=result.moves_planned if result else 0,
        moves_executed=result.moves_executed if result else 0,
        replans=result.replans if result else 0,
        timing_s={
            "perceive": round(result.perceive_seconds, 4) if result else 0.0,
            "plan": round(result.plan_seconds, 4) if result else 0.0,
            "motion": round(result.motion_seconds, 4) if result else 0.0,
            "execute": round(result.execute_seconds, 4) if result else 0.0,
            "total": round(total, 4),
        },
        failure=failure,
    )


def goal_holds(goal: str, truth: SceneGraph) -> bool:
    """Whether the true state fulfils a goal text."""
    stacks = true_stacks(truth)
    if not stacks:
        return False
    try:
        meant = resolve_goal(parse_goal(goal), truth.names).on(rows_of(truth.places))
        return meant.holds(stacks)
    except PlannerError:  # of a block that is not there, nothing holds
        return False
