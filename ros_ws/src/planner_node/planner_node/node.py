# SPDX-License-Identifier: Apache-2.0
"""planner_node: from scene graph to symbolic plan, and the closed loop around both."""

from __future__ import annotations

import functools
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SceneGraph
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.machine_code import written_below
from tamp_runtime.messages.motion_status import report_from_message
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.presence import Presence
from tamp_runtime.qos import NEWEST, STATUS

from scene_graph import ONE_ROW

from .conversions import (
    FeedbackWriter,
    outcome_to_message,
    plan_to_message,
    predicted_to_messages,
    read_goal,
    sighting_from_message,
)
from .errors import (
    BusyError,
    ConflictError,
    InvalidGoalError,
    NeedsAnswerError,
    NotConfidentError,
    PlannerError,
    SearchError,
)
from .goals import Goal, ResolveGoal
from .image_client import ImageClient
from .loop import (
    Answers,
    ClosedLoop,
    MotionLink,
    Outcome,
    Progress,
    Scene,
    SceneWatch,
    Status,
    decided,
    given_plan_in,
    meaning,
    plan_for,
    plan_in,
    uncover_in,
)
from .loop.account import besides, in_the_view
from .parameters import PARAMETERS
from .plan_publisher import PlanPublisher
from .search import SearchResult
from .settings import LATENT, Settings

if TYPE_CHECKING:
    from .latent_view import LatentView

#: achieve_goal, plan_to_goal with a goal image, a refused second goal, and what they wait for.
THREADS = 4


class PlannerNode(Node):
    """Plans with a search on scene graphs and watches over the execution.

    It needs an executor with four threads or more.

    Subscribed topics:
        scene_graph (tamp_interfaces/SceneGraph): what perception sees.
        motion_status (tamp_interfaces/MotionStatus, transient local): what becomes of a plan, and
            where the arm is.
        diagnostics (diagnostic_msgs/DiagnosticArray): who lives; with two nodes that do the work of
            one, requests are refused with the status CONFLICT.

    Published topics:
        symbolic_plan (tamp_interfaces/SymbolicPlan, latched): the plan to carry out; without moves:
            the plan to stop, or the way home. A plan that is not taken up by a motion node that
            reports to be idle is published again, under the same name.
        plan_sighting (tamp_interfaces/PlanSighting): what is seen of a plan that is watched, before
            the motion node takes a block.
        diagnostics (diagnostic_msgs/DiagnosticArray): that it lives.

    Services:
        plan_to_goal (tamp_interfaces/srv/PlanToGoal): plans from the newest confident scene graph,
            and publishes the plan only on request.

    Service clients:
        image_to_scene_graph (tamp_interfaces/srv/ImageToSceneGraph): interprets goal images.

    Actions:
        achieve_goal (tamp_interfaces/action/AchieveGoal): the closed loop. A goal that comes while
            another is worked on is accepted and aborted with the status BUSY, for the sentence. A
            plan that this planner does not follow, such as that of an earlier life, is stopped.

    Parameters: see :data:`planner_node.parameters.PARAMETERS`.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Raises ValueError if a parameter is out of range."""
        super().__init__("planner_node", **kwargs)
        written_below(Path(__file__).parent)  # now, not at the first plan
        self._settings = Settings()
        self._settings.update(declare_parameters(self, PARAMETERS, self._settings.update))
        plans = PlanPublisher(self)
        self._scenes = SceneWatch(self._settings, plans.now)
        self._motion = MotionLink(self._settings, plans, plans.now)
        self._images = ImageClient(self, self._settings)
        self._latent = self._latent_view()
        self._claim_lock = threading.Lock()
        self._claim: _Claim | None = None
        self._presence = Presence(self, "planner_node")

        topics = MutuallyExclusiveCallbackGroup()
        self.create_subscription(
            SceneGraph, "scene_graph", self._on_scene_graph, NEWEST, callback_group=topics
        )
        self.create_subscription(
            MotionStatus, "motion_status", self._on_motion_status, STATUS, callback_group=topics
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
        self._motion.wake()  # a plan that is watched is stopped by what is seen, without delay

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
            if isinstance(error, NeedsAnswerError):
                response.answers = list(error.doubt.colors)
            if isinstance(error, SearchError):
                response.expanded, response.planning_seconds = error.expanded, error.seconds
        except Exception as error:
            response.status = int(Status.INTERNAL_ERROR)
            response.message = self._internal_error(error)
        self.get_logger().info(f"plan_to_goal '{request.goal}': {response.message}")
        return response

    def _plan_to_goal(self, request: PlanToGoal.Request, response: PlanToGoal.Response) -> None:
        self._check_conflict()
        self._check_free(self._motion.check_free)
        resolve = self._read_goal(request, self._is_shut_down)
        try:
            scene = self._scenes.latest(self._motion.last_end)
        except NotConfidentError as error:
            if clause := in_the_view(self._motion.newest):
                raise NotConfidentError(
                    f"{error}; {clause}; achieve_goal brings it home"
                ) from error
            raise
        if self._latent is not None:
            goal, found = self._latent.plan(request, scene.stacks, scene.stamp)
        else:
            scene, goal, found = self._plan_in(scene, resolve, request)
        plan = plan_for(scene, goal, found, self._scenes.now())
        response.expanded, response.planning_seconds = found.expanded, found.seconds
        response.bound = found.bound
        response.plan, response.states = plan_to_message(plan), predicted_to_messages(plan)
        if not plan.moves:
            response.status = int(Status.ALREADY_TRUE)
            response.message = f"nothing to do: '{goal}' holds already"
            return
        response.status = int(Status.SUCCESS)
        told = f"{len(plan.moves)} moves to '{goal}'"
        fetched = (f"{sentence} and is fetched" for sentence in besides(scene))
        response.message = "; ".join(filter(None, (told, *fetched, found.note)))
        if scene.hidden:
            wanted = f"'{request.goal}'" if request.goal else "the goal image"
            moves = "1 move" if len(plan.moves) == 1 else f"{len(plan.moves)} moves"
            response.message = f"{moves} to look, then {wanted} is planned for: {found.note}"
        if request.execute:
            self._check_conflict()
            claim = _Claim("a plan of plan_to_goal", self._is_shut_down)
            with self._claimed(claim, self._motion.check_free):
                self._motion.start(plan)
            response.message += f"; published as plan {plan.plan_id}"

    def _plan_in(
        self, scene: Scene, resolve: ResolveGoal, request: PlanToGoal.Request
    ) -> tuple[Scene, Goal, SearchResult]:
        """A plan to the goal, one given, or where blocks hide others one that uncovers them."""
        if not scene.hidden:
            look = functools.partial(self._scenes.latest, self._motion.last_end)
            answers = Answers(request.answer, self._scenes.answer, look, self._search)
            scene, goal = answers.goal_in(scene, resolve)
            if given := request.plan.strip():
                return scene, goal, given_plan_in(scene, given, goal, self._settings)
            return scene, goal, self._search(scene, goal)
        meant = meaning(resolve, scene)
        if meant is not None and decided(meant, scene) and meant.holds(scene.stacks):
            return scene, meant, self._search(scene, meant)
        found = uncover_in(scene, meant, self._settings, self._is_shut_down)
        return scene, meant or Goal(()), found

    def _search(self, scene: Scene, goal: Goal) -> SearchResult:
        return plan_in(scene, goal, self._settings, self._is_shut_down)

    def _on_achieve_goal(self, handle: ServerGoalHandle) -> AchieveGoal.Result:
        request, feedback = handle.request, FeedbackWriter()

        def cancelled() -> bool:
            return handle.is_cancel_requested or self._is_shut_down()

        def report(progress: Progress) -> None:
            handle.publish_feedback(feedback.message(progress))

        def read() -> ResolveGoal:
            return self._read_goal(request, cancelled)

        motion, conflict = self._motion, self._presence.conflict
        loop = ClosedLoop(
            *(self._settings, self._scenes, motion, report, cancelled, self._is_shut_down),
            conflict=conflict,
            answer=request.answer,
        )
        claim = _Claim(f"achieve_goal '{request.goal or 'goal image'}'", cancelled)
        try:
            # A plan that is not this planner's own is stopped by the loop.
            with self._claimed(claim, motion.check_own):
                outcome = loop.run(read, request.plan)
        except BusyError as error:
            outcome = Outcome(Status[error.status], str(error), error.module, motion=motion.newest)
        except Exception as error:
            message = self._internal_error(error)
            outcome = loop.give_up(Status.INTERNAL_ERROR, message, "planner")
        self._finish(handle, outcome)
        return outcome_to_message(outcome)

    def _read_goal(self, request: Any, cancelled: Callable[[], bool]) -> ResolveGoal:
        """Of pictures as codes the goal is the state that their plan leads to."""
        latent = self._latent
        if latent is not None and request.plan.strip():
            raise InvalidGoalError("representation latent takes no plan; give a goal image", 0)
        if latent is not None:
            return lambda seen, _rows=ONE_ROW: latent.plan(request, seen)[0]
        return read_goal(request, functools.partial(self._images.interpret, cancelled=cancelled))

    def _latent_view(self) -> LatentView | None:
        """What plans on codes of pictures, where the parameters ask for it."""
        if self._settings.representation != LATENT:
            return None
        from .latent_view import LatentView  # PyTorch, which nothing else here needs

        return LatentView(self, self._settings)

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
    def _claimed(self, claim: _Claim, check: Callable[[], None]) -> Iterator[None]:
        """One goal at a time; raises BusyError while another is worked on or carried out."""
        with self._claim_lock:
            self._check_free(check)
            self._claim = claim
        try:
            yield
        finally:
            self._claim = None

    def _check_free(self, check: Callable[[], None]) -> None:
        """Raises BusyError; ``check`` raises it where the arm is not free."""
        claim = self._claim
        if claim is not None and claim.is_cancelled():
            raise BusyError(f"{claim.name} is being cancelled; wait until the arm rests")
        if claim is not None:
            raise BusyError(f"{claim.name} is worked on; wait until it ends, or cancel it")
        check()

    def _check_conflict(self) -> None:
        if conflict := self._presence.conflict():
            raise ConflictError(conflict)

    def _internal_error(self, error: Exception) -> str:
        """Logs a defect and tells it in a sentence."""
        if not self._is_shut_down():
            self.get_logger().error(f"internal error:\n{traceback.format_exc()}")
        return (
            f"a defect ({type(error).__name__}: {error}); the log has the traceback, please report"
        )

    def _is_shut_down(self) -> bool:
        return not self.context.ok()


@dataclass(frozen=True)
class _Claim:
    """Who has the planner to himself, and whether he has been asked to let go."""

    name: str
    is_cancelled: Callable[[], bool]


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(PlannerNode, threads=THREADS)
