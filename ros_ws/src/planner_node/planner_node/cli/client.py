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
from typing import Any, Final

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.context import Context
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import Image
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.service_call import arrival, ask
from unique_identifier_msgs.msg import UUID

#: The planner counts as gone when it has not been seen for this long [s].
GONE_SECONDS: Final = 2.0


class PlannerUnavailableError(RuntimeError):
    """planner_node does not answer; the message says what to do about it."""


class PlannerClient:
    """Asks planner_node for plans, and has it achieve goals.

    It has its own node and thread, so it works beside whatever else the caller spins. ``rclpy``, or
    the given context, must be initialised before and shut down after.
    """

    def __init__(self, context: Context | None = None, **node_arguments: Any) -> None:
        """``node_arguments`` go to the node, for example ``namespace``."""
        name = f"planner_client_{uuid.uuid4().hex[:6]}"
        self._node = Node(name, context=context, **node_arguments)
        self._plan_client = self._node.create_client(PlanToGoal, "plan_to_goal")
        self._goal_client = ActionClient(self._node, AchieveGoal, "achieve_goal")
        self._feedback: queue.SimpleQueue[AchieveGoal.Feedback] = queue.SimpleQueue()
        self._handle: ClientGoalHandle | None = None
        self._result: Future | None = None
        self._gone_since: float | None = None
        self._thread = NodeThread(self._node)

    def plan(
        self,
        goal: str = "",
        *,
        goal_image: Image | None = None,
        goal_segmentation: Image | None = None,
        execute: bool = False,
        timeout: float = 10.0,
    ) -> PlanToGoal.Response:
        """The answer of plan_to_goal; ``goal`` or the images are given.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        request = PlanToGoal.Request(
            goal=goal,
            goal_image=goal_image or Image(),
            goal_segmentation=goal_segmentation or Image(),
            execute=execute,
        )
        client = self._plan_client
        return _ask(
            lambda: client.call_async(request),
            client.service_is_ready,
            client.wait_for_service,
            timeout,
        )

    def start(
        self,
        goal: str = "",
        *,
        goal_image: Image | None = None,
        goal_segmentation: Image | None = None,
        timeout: float = 10.0,
    ) -> None:
        """Begins to achieve a goal, given as for :meth:`plan`; returns once the planner has it.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        feedback: queue.SimpleQueue[AchieveGoal.Feedback] = queue.SimpleQueue()
        self._feedback = feedback
        self._result, self._gone_since = None, None
        request = AchieveGoal.Goal(
            goal=goal,
            goal_image=goal_image or Image(),
            goal_segmentation=goal_segmentation or Image(),
        )
        client, identity = self._goal_client, UUID(uuid=list(uuid.uuid4().bytes))
        handle = _ask(
            lambda: self._thread.call(
                lambda: client.send_goal_async(
                    request, lambda message: feedback.put(message.feedback), identity
                )
            ),
            client.server_is_ready,
            client.wait_for_server,
            timeout,
        )
        if not handle.accepted:
            raise PlannerUnavailableError("planner_node refused the goal; its log says why")
        self._handle = handle
        self._result = self._thread.call(handle.get_result_async)

    def is_done(self) -> bool:
        """Whether the result is there.

        Raises:
            PlannerUnavailableError: the planner went away meanwhile, so no result will come.
        """
        if self._started().done():
            return True
        if self._gone_since is None and not self._goal_client.server_is_ready():
            self._gone_since = time.monotonic()
        # A planner that comes back knows nothing of the goal, so its return changes nothing.
        if self._gone_since and time.monotonic() > self._gone_since + GONE_SECONDS:
            raise PlannerUnavailableError(
                "planner_node went away while it worked on the goal; what became of the plan is "
                "not known. Start it again and ask again"
            )
        return False

    def next_feedback(self, timeout: float) -> AchieveGoal.Feedback | None:
        """The next feedback in order, or None if none comes within ``timeout`` [s]."""
        try:
            return self._feedback.get(timeout=timeout)
        except queue.Empty:
            return None

    def cancel(self, timeout: float = 5.0) -> None:
        """Asks for cancellation; the result, of status CANCELLED, comes when the arm rests.

        Raises:
            PlannerUnavailableError: no answer within ``timeout`` [s].
        """
        self._started()
        assert self._handle is not None
        if not arrival(self._thread.call(self._handle.cancel_goal_async)).wait(timeout):
            raise _unavailable(timeout)

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
            raise PlannerUnavailableError(
                "planner_node does not know the goal; was it restarted? Ask again"
            )
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


def _ask(
    send: Callable[[], Future],
    is_ready: Callable[[], bool],
    wait_for: Callable[..., bool],
    timeout: float,
) -> Any:
    try:
        return ask(send, is_ready, wait_for, timeout)
    except TimeoutError:
        raise _unavailable(timeout) from None


def _unavailable(timeout: float) -> PlannerUnavailableError:
    return PlannerUnavailableError(
        f"planner_node does not answer (waited {timeout:g} s); start it with: "
        "ros2 run planner_node planner_node"
    )
