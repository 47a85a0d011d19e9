# SPDX-License-Identifier: Apache-2.0
"""planner_node: from scene graph to symbolic plan, and the closed loop around both."""

from __future__ import annotations

import functools
import threading
import traceback
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SceneGraph, SymbolicPlan
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE

from .closed_loop import ClosedLoop
from .conversions import Scene, plan_to_message, predicted_scenes, status_code
from .errors import BusyError, PlannerError, SearchError
from .goal_reader import read_goal
from .goals import Goal
from .image_client import ImageClient
from .motion_link import MotionLink
from .planning import make_plan
from .scene_watch import SceneWatch
from .search import SearchResult
from .settings import PARAMETERS, Settings

#: achieve_goal, plan_to_goal with a goal image, a refused second goal, and what they wait for.
THREADS = 4


class PlannerNode(Node):
    """Plans with breadth-first search on scene graphs and watches over the execution.

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

    Parameters: see :data:`planner_node.settings.PARAMETERS`.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Raises ValueError if a parameter is out of range."""
        super().__init__("planner_node", **kwargs)
        self._settings = Settings()
        self._settings.update(declare_parameters(self, PARAMETERS, self._settings.update))
        plans = self.create_publisher(SymbolicPlan, "symbolic_plan", LATCHED)
        self._scenes = SceneWatch(self._settings, self._now)
        self._motion = MotionLink(self._settings, plans, self._now)
        self._images = ImageClient(self, self._settings)
        self._claim_lock = threading.Lock()
        self._claimed_by = ""

        topics = MutuallyExclusiveCallbackGroup()
        self.create_subscription(
            SceneGraph, "scene_graph", self._scenes.receive, NEWEST, callback_group=topics
        )
        self.create_subscription(
            MotionStatus, "motion_status", self._motion.receive, RELIABLE, callback_group=topics
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
        self._action_server.destroy()
        super().destroy_node()

    def _on_plan_to_goal(
        self, request: PlanToGoal.Request, response: PlanToGoal.Response
    ) -> PlanToGoal.Response:
        try:
            self._plan_to_goal(request, response)
        except PlannerError as error:
            response.status, response.message = status_code(error), str(error)
            if isinstance(error, SearchError):
                response.expanded, response.planning_seconds = error.expanded, error.seconds
        except Exception as error:
            response.status, response.message = self._internal_error(error)
        self.get_logger().info(f"plan_to_goal '{request.goal}': {response.message}")
        return response

    def _plan_to_goal(self, request: PlanToGoal.Request, response: PlanToGoal.Response) -> None:
        self._check_free()
        resolve = read_goal(
            request, functools.partial(self._images.interpret, cancelled=self._is_shut_down)
        )
        scene = self._scenes.latest(self._motion.last_end)
        goal = resolve(scene)
        found = make_plan(scene.stacks, goal, self._settings.max_expansions, self._is_shut_down)
        response.expanded, response.planning_seconds = found.expanded, found.seconds
        response.plan = self._make_message(scene, goal, found)
        response.states = predicted_scenes(scene, found)
        if not found.moves:
            response.status = PlanToGoal.Response.ALREADY_TRUE
            response.message = f"nothing to do: '{goal}' holds already"
            return
        response.status = PlanToGoal.Response.SUCCESS
        response.message = f"{len(found.moves)} moves to '{goal}'"
        if request.execute:
            with self._claimed("a plan of plan_to_goal"):
                self._motion.start(response.plan)
            response.message += f"; published as plan {response.plan.plan_id}"

    def _on_achieve_goal(self, handle: ServerGoalHandle) -> AchieveGoal.Result:
        request = handle.request

        def cancelled() -> bool:
            return handle.is_cancel_requested or self._is_shut_down()

        loop = ClosedLoop(
            self._settings,
            self._scenes,
            self._motion,
            self._make_message,
            handle.publish_feedback,
            cancelled,
            self._is_shut_down,
        )
        interpret = functools.partial(self._images.interpret, cancelled=cancelled)
        try:
            with self._claimed(f"achieve_goal '{request.goal or 'goal image'}'"):
                result = loop.run(lambda: read_goal(request, interpret))
        except BusyError as error:
            result = AchieveGoal.Result(
                status=status_code(error), message=str(error), module=error.module
            )
        except Exception as error:
            result = loop.result
            result.status, result.message = self._internal_error(error)
            result.module = "planner"
        self._finish(handle, result)
        return result

    def _finish(self, handle: ServerGoalHandle, result: AchieveGoal.Result) -> None:
        """Sets the goal's end; nobody is left to be told while the node is shut down."""
        if self._is_shut_down():
            return
        self.get_logger().info(f"achieve_goal '{handle.request.goal}': {result.message}")
        if result.status in (AchieveGoal.Result.SUCCESS, AchieveGoal.Result.ALREADY_TRUE):
            handle.succeed()
        elif result.status == AchieveGoal.Result.CANCELLED and handle.is_cancel_requested:
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

    def _make_message(self, scene: Scene, goal: Goal, found: SearchResult) -> SymbolicPlan:
        stamp = self.get_clock().now().to_msg()
        return plan_to_message(scene, goal, found, uuid.uuid4().hex[:12], stamp)

    def _internal_error(self, error: Exception) -> tuple[int, str]:
        if not self._is_shut_down():
            self.get_logger().error(f"internal error:\n{traceback.format_exc()}")
        return (
            PlanToGoal.Response.INTERNAL_ERROR,
            f"a defect ({type(error).__name__}: {error}); the log has the traceback, please report",
        )

    def _is_shut_down(self) -> bool:
        return not self.context.ok()

    def _now(self) -> int:
        nanoseconds: int = self.get_clock().now().nanoseconds
        return nanoseconds


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(PlannerNode, threads=THREADS)
