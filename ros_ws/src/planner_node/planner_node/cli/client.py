# SPDX-License-Identifier: Apache-2.0
"""planner_node for programs: a façade that spins by itself and waits for nothing for ever.

with PlannerClient() as planner:
    planner.start("red on blue")
    while not planner.is_done():
        feedback = planner.next_feedback(timeout=0.2)
        if feedback:
            print(feedback.message)
    print(planner.result(timeout=1.0).message)
"""

from __future__ import annotations

import queue
import time
import uuid
from collections.abc import Callable
from functools import partial
from typing import Any, Final

from action_msgs.msg import GoalInfo, GoalStatus
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient
from rclpy.context import Context
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import Image
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.neighbour import Neighbour
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.service_call import arrival, ask
from unique_identifier_msgs.msg import UUID

from .unavailable import WHAT_TO_DO, PlannerUnavailableError, no_answer, unknown_goal

#: The planner counts as gone when DDS has not seen it for this long [s].
GONE_SECONDS: Final = 2.0
#: How often a goal is cancelled of which the planner may not have heard yet.
CANCEL_ATTEMPTS: Final = 5

_TERMINATED: Final = CancelGoal.Response.ERROR_GOAL_TERMINATED


class PlannerClient:
    """Asks planner_node for plans, and has it achieve goals.

    It has its own node and thread, so it works beside whatever else the caller spins. ``rclpy``, or
    the given context, must be initialised before and shut down after.

    A planner that is killed is noticed by its signs of life within ten seconds, also where another
    one has taken its place; one that stands still for five is waited for.
    """

    def __init__(self, context: Context | None = None, **node_arguments: Any) -> None:
        """``node_arguments`` go to the node, for example ``namespace``."""
        name = f"planner_client_{uuid.uuid4().hex[:6]}"
        self._node = node = Node(name, context=context, **node_arguments)
        self._planner = Neighbour(node, "planner_node")
        self._plan_client = node.create_client(PlanToGoal, "plan_to_goal")
        self._goal_client = ActionClient(node, AchieveGoal, "achieve_goal")
        self._send_goal = node.resolve_service_name("achieve_goal/_action/send_goal")
        # rclpy's own way to cancel needs a goal that was accepted, and can cancel no one else's.
        self._cancel_client = node.create_client(CancelGoal, "achieve_goal/_action/cancel_goal")
        self._feedback: queue.SimpleQueue[AchieveGoal.Feedback] = queue.SimpleQueue()
        self._goal_id: UUID | None = None
        self._followed_by: frozenset[str] = frozenset()
        self._ask_again: Callable[[], Future] | None = None
        self._result: Future | None = None
        self._gone_since: float | None = None
        self._thread = NodeThread(node)

    def plan(
        self,
        goal: str = "",
        *,
        goal_image: Image | None = None,
        goal_segmentation: Image | None = None,
        execute: bool = False,
        plan: str = "",
        answer: str = "",
        timeout: float = 10.0,
    ) -> PlanToGoal.Response:
        """The answer of plan_to_goal; ``goal`` or the images are given, or another's ``plan``.

        ``answer`` is the one to a question that was asked back (NEEDS_ANSWER).

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        request = PlanToGoal.Request(
            goal=goal,
            goal_image=goal_image or Image(),
            goal_segmentation=goal_segmentation or Image(),
            execute=execute,
            plan=plan,
            answer=answer,
        )
        return self._call(self._plan_client, request, timeout)

    def start(
        self,
        goal: str = "",
        *,
        goal_image: Image | None = None,
        goal_segmentation: Image | None = None,
        plan: str = "",
        answer: str = "",
        timeout: float = 10.0,
    ) -> None:
        """Begins to achieve a goal, given as for :meth:`plan`; returns once the planner has it.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        feedback: queue.SimpleQueue[AchieveGoal.Feedback] = queue.SimpleQueue()
        self._feedback = feedback
        self._goal_id, self._result, self._gone_since = None, None, None
        request = AchieveGoal.Goal(
            goal=goal,
            goal_image=goal_image or Image(),
            goal_segmentation=goal_segmentation or Image(),
            plan=plan,
            answer=answer,
        )
        client, identity = self._goal_client, UUID(uuid=list(uuid.uuid4().bytes))

        def send() -> Future:
            self._goal_id = identity
            return client.send_goal_async(
                request, lambda message: feedback.put(message.feedback), identity
            )

        try:
            handle = self._ask(
                lambda: self._thread.call(send),
                client.server_is_ready,
                client.wait_for_server,
                timeout,
                self._send_goal,
            )
        except PlannerUnavailableError:
            if self._goal_id:  # one that wakes up later shall not begin with what nobody awaits
                self._cancel_client.call_async(self._cancel_request())
            raise
        if not handle.accepted:
            raise PlannerUnavailableError("planner_node refused the goal; its log says why")
        self._followed_by = self._planner.living()
        self._ask_again = None if self._followed_by else handle.get_result_async
        self._result = self._thread.call(handle.get_result_async)

    @property
    def is_started(self) -> bool:
        """Whether a planner has accepted a goal from :meth:`start`."""
        return self._result is not None

    def is_done(self) -> bool:
        """Whether the result is there.

        Raises:
            PlannerUnavailableError: the planner went away meanwhile, so no result will come.
        """
        if self._started().done():
            return True
        if loss := self._loss():
            raise PlannerUnavailableError(f"{loss} while it worked on the goal. {WHAT_TO_DO}")
        return False

    def next_feedback(self, timeout: float) -> AchieveGoal.Feedback | None:
        """The next feedback in order, or None if none comes within ``timeout`` [s]."""
        try:
            return self._feedback.get(timeout=timeout)
        except queue.Empty:
            return None

    def cancel(self, timeout: float = 8.0) -> None:
        """Asks for cancellation; the result, of status CANCELLED, comes when the arm rests.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s], or from one that does not
                know the goal.
        """
        result = self._started()
        code = self._cancel(timeout)
        if result.done() or code in (CancelGoal.Response.ERROR_NONE, _TERMINATED):
            return
        if code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID:
            raise unknown_goal(self._node.count_services(self._send_goal))
        raise PlannerUnavailableError("planner_node refused to cancel the goal; its log says why")

    def withdraw(self, timeout: float = 2.0) -> bool:
        """Cancels what :meth:`start` asked for and was interrupted; whether the planner knew it.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        if self._goal_id is None:
            return False
        for _ in range(CANCEL_ATTEMPTS):  # the goal may still be on its way
            if self._cancel(timeout) != CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID:
                return True
            time.sleep(0.1)
        return False

    def cancel_all(self, timeout: float = 5.0) -> int:
        """Cancels every goal of achieve_goal, whoever asked for it; returns how many there were.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        # No name and no time: all of them.
        answer = self._call(self._cancel_client, CancelGoal.Request(), timeout)
        return len(answer.goals_canceling)

    def result(self, timeout: float) -> AchieveGoal.Result:
        """Waits for the result, whatever its status.

        Raises:
            TimeoutError: it is not there within ``timeout`` [s].
            PlannerUnavailableError: the planner went away.
        """
        deadline = time.monotonic() + timeout
        future = self._started()
        arrived = arrival(future)
        while not self.is_done():
            if time.monotonic() >= deadline:
                raise TimeoutError(f"the goal is not done after {timeout:g} s")
            arrived.wait(0.1)
        response = future.result()
        if response.status == GoalStatus.STATUS_UNKNOWN:
            raise unknown_goal(self._node.count_services(self._send_goal))
        return response.result

    def close(self) -> None:
        """Stops the thread and removes the node; a goal that is under way goes on."""
        self._thread.stop()
        self._goal_client.destroy()
        self._node.destroy_node()

    def __enter__(self) -> PlannerClient:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def _started(self) -> Future:
        if self._result is None:
            raise RuntimeError("no goal was started; call start() first")
        return self._result

    def _loss(self) -> str:
        """How the planner that has the goal was lost, or an empty string."""
        if self._ask_again and self._planner.living():
            self._adopt(self._ask_again)
        if self._followed_by and self._planner.are_gone(self._followed_by):
            if self._planner.living() - self._followed_by:
                return "planner_node went away, and another one was started,"
            return "planner_node went away: it has given no sign of life for 8 s"
        if self._gone_since is None and not self._goal_client.server_is_ready():
            self._gone_since = time.monotonic()
        # A planner that comes back knows nothing of the goal, so its return changes nothing.
        gone = self._gone_since and time.monotonic() > self._gone_since + GONE_SECONDS
        return "planner_node went away" if gone else ""

    def _adopt(self, ask: Callable[[], Future]) -> None:
        """Takes who lives for the planner that accepted before any sign of life was heard.

        It may be another one, started since, which says so when it is asked for the result.
        """
        if not self._planner.are_found(self._node.count_services(self._send_goal)):
            return
        self._ask_again, self._followed_by = None, self._planner.living()
        result = self._started()

        def take(answer: Future) -> None:
            if not result.done():
                result.set_result(answer.result())

        self._thread.call(ask).add_done_callback(take)

    def _cancel(self, timeout: float) -> int:
        """The return code of the request to cancel the own goal."""
        return int(self._call(self._cancel_client, self._cancel_request(), timeout).return_code)

    def _cancel_request(self) -> CancelGoal.Request:
        return CancelGoal.Request(goal_info=GoalInfo(goal_id=self._goal_id))

    def _call(self, client: Any, request: Any, timeout: float) -> Any:
        return self._ask(
            lambda: client.call_async(request),
            client.service_is_ready,
            client.wait_for_service,
            timeout,
            client.service_name,
        )

    def _ask(
        self,
        send: Callable[[], Future],
        is_ready: Callable[[], bool],
        wait_for: Callable[..., bool],
        timeout: float,
        service: str,
    ) -> Any:
        try:
            servers = partial(self._node.count_services, service)
            return ask(send, is_ready, wait_for, timeout, self._planner, servers)
        except TimeoutError:
            raise no_answer(timeout) from None
