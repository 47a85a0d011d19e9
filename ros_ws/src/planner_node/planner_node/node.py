# SPDX-License-Identifier: Apache-2.0
"""planner_node: from scene graph to symbolic plan, and the closed loop around both."""

from __future__ import annotations

import functools
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SceneGraph, SymbolicPlan
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.messages.motion_status import report_from_message
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE

from scene_graph import Stacks

from .conversions import (
    FeedbackWriter,
    outcome_to_message,
    plan_to_message,
    predicted_to_messages,
    read_goal,
    sighting_from_message,
    stop_to_message,
)
from .errors import BusyError, PlannerError, SearchError
from .goals import Goal
from .image_client import ImageClient
from .loop import ClosedLoop, MotionLink, Outcome, Plan, Progress, SceneWatch, Status, plan_for
from .parameters import PARAMETERS
from .search import make_plan
from .settings import Settings

#: achieve_goal, plan_to_goal with a goal image, a refused second goal, and what they wait for.
THREADS = 4


class PlannerNode(Node):
    """Plans with a search on scene graphs and watches over the execution.

    It needs an executor with four threads or more.

    Subscribed topics:
        scene_graph (tamp_interfaces/SceneGraph): what perception sees.
        motion_status (tamp_interfaces/MotionStatus): what becomes of a plan.

    Published topics:
        symbolic_plan (tamp_interfaces/SymbolicPlan, latched): the plan to carry out; without moves:
            the plan to stop. Its header has the time of publication, so that a motion node that
            starts later knows it for an old one.

    Services:
        plan_to_goal (tamp_interfaces/srv/PlanToGoal): plans from the newest confident scene graph,
            and publishes the plan only on request.

    Service clients:
        image_to_scene_graph (tamp_interfaces/srv/ImageToSceneGraph): interprets goal images.

    Actions:
        achieve_goal (tamp_interfaces/action/AchieveGoal): the closed loop. A goal that comes while
            another is worked on is accepted and aborted with the status BUSY, for the sentence.

    Parameters: see :data:`planner_node.parameters.PARAMETERS`.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Raises ValueError if a parameter is out of range."""
        super().__init__("planner_node", **kwargs)
        self._settings = Settings()
        self._settings.update(declare_parameters(self, PARAMETERS, self._settings.update))
        plans = _PlanPublisher(self)
        self._scenes = SceneWatch(self._settings, plans.now)
        self._motion = MotionLink(self._settings, plans, plans.now)
        self._images = ImageClient(self, self._settings)
        self._claim_lock = threading.Lock()
        self._claimed_by = ""

        topics = MutuallyExclusiveCallbackGroup()
        self.create_subscription(
            SceneGraph, "scene_graph", self._on_scene_graph, NEWEST, callback_group=topics
        )
        self.create_subscription(
            MotionStatus, "motion_status", self._on_motion_status, RELIABLE, callback_group=topics
        )
        self.create_service(
            PlanToGoal,
            "plan_to_goal",
            self._on_plan_to_goal,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self._action_server = ActionServer(
            self,
            AchieveGoal,
            "achieve_goal",
            self._on_achieve_goal,
            callback_group=ReentrantCallbackGroup(),
            cancel_callback=lambda _goal: CancelResponse.ACCEPT,
        )
        self.get_logger().info("ready")

    def destroy_node(self) -> None:
        """Ends the action server, which rclpy does not do by itself, and the node."""
        self._action_server.destroy()
        super().destroy_node()

    def _on_scene_graph(self, message: SceneGraph) -> None:
        self._scenes.receive(sighting_from_message(message))

    def _on_motion_status(self, message: MotionStatus) -> None:
        try:
            report = report_from_message(message)
        except ValueError as error:
            self.get_logger().error(f"motion_status makes no sense: {error}")
        else:
            self._motion.receive(report)

    def _on_plan_to_goal(
        self, request: PlanToGoal.Request, response: PlanToGoal.Response
    ) -> PlanToGoal.Response:
        try:
            self._plan_to_goal(request, response)
        except PlannerError as error:
            response.status, response.message = int(Status[error.status]), str(error)
            if isinstance(error, SearchError):
                response.expanded, response.planning_seconds = error.expanded, error.seconds
        except Exception as error:
            response.status = int(Status.INTERNAL_ERROR)
            response.message = self._internal_error(error)
        self.get_logger().info(f"plan_to_goal '{request.goal}': {response.message}")
        return response

    def _plan_to_goal(self, request: PlanToGoal.Request, response: PlanToGoal.Response) -> None:
        self._check_free()
        resolve = read_goal(
            request, functools.partial(self._images.interpret, cancelled=self._is_shut_down)
        )
        scene = self._scenes.latest(self._motion.last_end)
        goal = resolve(scene.stacks)
        settings = self._settings
        found = make_plan(
            scene.stacks,
            goal,
            settings.max_expansions,
            self._is_shut_down,
            settings.search_algorithm,
        )
        plan = plan_for(scene, goal, found, self._scenes.now())
        response.expanded, response.planning_seconds = found.expanded, found.seconds
        response.plan, response.states = plan_to_message(plan), predicted_to_messages(plan)
        if not plan.moves:
            response.status = int(Status.ALREADY_TRUE)
            response.message = f"nothing to do: '{goal}' holds already"
            return
        response.status = int(Status.SUCCESS)
        response.message = f"{len(plan.moves)} moves to '{goal}'"
        if request.execute:
            with self._claimed("a plan of plan_to_goal"):
                self._motion.start(plan)
            response.message += f"; published as plan {plan.plan_id}"

    def _on_achieve_goal(self, handle: ServerGoalHandle) -> AchieveGoal.Result:
        request, feedback = handle.request, FeedbackWriter()

        def cancelled() -> bool:
            return handle.is_cancel_requested or self._is_shut_down()

        def report(progress: Progress) -> None:
            handle.publish_feedback(feedback.message(progress))

        def read() -> Callable[[Stacks], Goal]:
            return read_goal(
                request, functools.partial(self._images.interpret, cancelled=cancelled)
            )

        loop = ClosedLoop(
            self._settings, self._scenes, self._motion, report, cancelled, self._is_shut_down
        )
        try:
            with self._claimed(f"achieve_goal '{request.goal or 'goal image'}'"):
                outcome = loop.run(read)
        except BusyError as error:
            outcome = Outcome(Status[error.status], str(error), error.module)
        except Exception as error:
            outcome = replace(
                loop.outcome,
                status=Status.INTERNAL_ERROR,
                message=self._internal_error(error),
                module="planner",
            )
        self._finish(handle, outcome)
        return outcome_to_message(outcome)

    def _finish(self, handle: ServerGoalHandle, outcome: Outcome) -> None:
        """Sets the goal's end; nobody is left to be told while the node is shut down."""
        if self._is_shut_down():
            return
        self.get_logger().info(f"achieve_goal '{handle.request.goal}': {outcome.message}")
        if outcome.status in (Status.SUCCESS, Status.ALREADY_TRUE):
            handle.succeed()
        elif outcome.status == Status.CANCELLED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()

    @contextmanager
    def _claimed(self, claimant: str) -> Iterator[None]:
        """One goal at a time; raises BusyError while another is worked on or carried out."""
        with self._claim_lock:
            self._check_free()
            self._claimed_by = claimant
        try:
            yield
        finally:
            self._claimed_by = ""

    def _check_free(self) -> None:
        if self._claimed_by:
            raise BusyError(f"{self._claimed_by} is worked on; wait until it ends, or cancel it")
        self._motion.check_free()

    def _internal_error(self, error: Exception) -> str:
        """Logs a defect and tells it in a sentence."""
        if not self._is_shut_down():
            self.get_logger().error(f"internal error:\n{traceback.format_exc()}")
        return (
            f"a defect ({type(error).__name__}: {error}); the log has the traceback, please report"
        )

    def _is_shut_down(self) -> bool:
        return not self.context.ok()


class _PlanPublisher:
    """The topic symbolic_plan, and the clock of its node."""

    def __init__(self, node: Node) -> None:
        self._clock = node.get_clock()
        self._publisher = node.create_publisher(SymbolicPlan, "symbolic_plan", LATCHED)

    def publish(self, plan: Plan) -> None:
        self._publisher.publish(plan_to_message(plan))

    def publish_stop(self, plan: Plan) -> None:
        self._publisher.publish(stop_to_message(plan, self.now()))

    def subscribers(self) -> int:
        count: int = self._publisher.get_subscription_count()
        return count

    def now(self) -> int:
        """The ROS time [ns]; 0 while simulated time has not arrived."""
        nanoseconds: int = self._clock.now().nanoseconds
        return nanoseconds


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(PlannerNode, threads=THREADS)
