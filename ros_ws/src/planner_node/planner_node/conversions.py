# SPDX-License-Identifier: Apache-2.0
"""The only place where messages meet the types of the planner."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sensor_msgs.msg import Image
from std_msgs.msg import Header
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import PlanSighting, SymbolicPlan
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.motion_status import report_to_message
from tamp_runtime.messages.scene_graph import (
    graph_from_message,
    graph_to_message,
    moves_to_messages,
    object_to_message,
    relations_to_messages,
)
from tamp_runtime.messages.stamps import nanoseconds, stamp_from_nanoseconds

from scene_graph import ONE_ROW, GraphStatus, SceneGraph

from .errors import GoalImageError, InvalidGoalError, NotConfidentError
from .goals import ResolveGoal, complete_goal, goal_of_picture, parse_goal, resolve_goal
from .loop import Outcome, Plan, Progress, Scene, Sighting, scene_in
from .loop.plan_watch import PlanSight
from .search.peers.read_plan import state_after

#: Asks perception for the scene graph of an image and its segmentation.
Interpret = Callable[[Image, Image], SceneGraphMsg]


def sighting_from_message(message: SceneGraphMsg) -> Sighting:
    """What perception reports; a graph that cannot be read becomes a defect of the sighting."""
    graph, status, defect = SceneGraph((), frozenset()), GraphStatus.CONFIDENT, ""
    try:
        status = GraphStatus(message.status)
        graph = graph_from_message(message)
    except ValueError as error:
        defect = str(error)
    return Sighting(
        graph,
        status,
        message.message,
        nanoseconds(message.header.stamp),
        message.header.frame_id,
        defect,
        message.view_requested,
    )


def scene_to_message(scene: Scene) -> SceneGraphMsg:
    """The scene graph that was planned on, as perception sent it."""
    return graph_to_message(scene.graph, _header(scene.stamp, scene.frame_id))


def plan_to_message(plan: Plan) -> SymbolicPlan:
    """The plan as the motion node takes it."""
    return SymbolicPlan(
        header=_header(plan.stamp, plan.scene.frame_id),
        plan_id=plan.plan_id,
        initial=scene_to_message(plan.scene),
        moves=moves_to_messages(plan.moves, plan.states),
        goal=relations_to_messages(plan.goal.fulfilled_by(plan.states[-1])),
        explain=plan.explain,
        watched=plan.watched,
    )


def stop_to_message(plan_id: str, stamp: int) -> SymbolicPlan:
    """The request to stop a plan: its name without moves; ``stamp`` is the ROS time [ns]."""
    return SymbolicPlan(header=_header(stamp, ""), plan_id=plan_id)


def sight_to_message(plan_id: str, sight: PlanSight) -> PlanSighting:
    """What is seen of a plan that is watched."""
    return PlanSighting(
        header=_header(sight.stamp, ""),
        plan_id=plan_id,
        move=sight.move,
        sight=int(sight.sight),
        moved=[object_to_message(item) for item in sight.moved],
    )


def predicted_to_messages(plan: Plan) -> list[SceneGraphMsg]:
    """The predicted scene after each move."""
    return [graph_to_message(graph, _header(0, plan.scene.frame_id)) for graph in plan.predicted]


class FeedbackWriter:
    """Progress as feedback of AchieveGoal; a plan and its scenes go into the first on it only."""

    def __init__(self) -> None:
        self._plan: Plan | None = None

    def message(self, progress: Progress) -> AchieveGoal.Feedback:
        """The feedback on a progress."""
        motion = progress.motion
        message = AchieveGoal.Feedback(
            stage=int(progress.stage),
            message=progress.message,
            motion=report_to_message(motion, stamp_from_nanoseconds(motion.stamp)),
            replans=progress.replans,
        )
        plan = progress.plan
        if plan is self._plan:
            message.plan.plan_id = plan.plan_id if plan else ""
        elif plan is not None:
            self._plan = plan
            message.plan, message.states = plan_to_message(plan), predicted_to_messages(plan)
        return message


def outcome_to_message(outcome: Outcome) -> AchieveGoal.Result:
    """The result of achieve_goal."""
    return AchieveGoal.Result(
        status=int(outcome.status),
        message=outcome.message,
        answers=list(outcome.answers),
        module=outcome.module,
        moves_planned=outcome.moves_planned,
        moves_executed=outcome.moves_executed,
        replans=outcome.replans,
        causes=list(outcome.causes),
        initial=scene_to_message(outcome.initial) if outcome.initial else SceneGraphMsg(),
        final=scene_to_message(outcome.final) if outcome.final else SceneGraphMsg(),
        motion=report_to_message(outcome.motion, stamp_from_nanoseconds(outcome.motion.stamp)),
        perceive_seconds=outcome.perceive_seconds,
        plan_seconds=outcome.plan_seconds,
        motion_seconds=outcome.motion_seconds,
        execute_seconds=outcome.execute_seconds,
    )


def read_goal(request: Any, interpret: Interpret) -> ResolveGoal:
    """Everything about a goal that needs no scene; the result finds its objects in a scene.

    Args:
        request: a request of PlanToGoal or a goal of AchieveGoal; with a plan alone the goal is
            what that leads to.

    Raises:
        InvalidGoalError: the text makes no sense, or there are text and image.
        GoalImageError: the image makes no sense. The result raises it if the image shows other
            objects than the scene, or UnknownObjectError or AmbiguousObjectError for a text.
        GivenPlanError: of the result, where a plan without a goal is not possible.
    """
    has_image = request.goal_image.width > 0 or request.goal_segmentation.width > 0
    if not has_image and request.plan.strip() and not request.goal.strip():
        return lambda seen, _rows=ONE_ROW: complete_goal(state_after(request.plan, seen))
    if not has_image:
        parsed = parse_goal(request.goal)
        return lambda seen, rows=ONE_ROW: resolve_goal(
            parsed, [name for stack in seen for name in stack], len(seen), rows, seen
        )
    if request.goal.strip():
        raise InvalidGoalError("there is a goal text and a goal image; give one of them", 0)
    message = interpret(request.goal_image, request.goal_segmentation)
    try:
        shown = scene_in(sighting_from_message(message))
    except NotConfidentError as error:
        raise GoalImageError(f"the goal image cannot be used: {error}") from error
    return lambda seen, rows=ONE_ROW: goal_of_picture(shown.stacks, seen).on(rows)


def _header(stamp: int, frame_id: str) -> Header:
    return Header(stamp=stamp_from_nanoseconds(stamp), frame_id=frame_id)
