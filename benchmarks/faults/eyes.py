# SPDX-License-Identifier: Apache-2.0
"""What the campaign sees and the nodes do not: ground truth, all states of the arm; it resets."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rcl_interfaces.srv import SetParameters
from rclpy.client import Client
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.motion_status import report_from_message
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.motion_report import MotionReport
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA
from tamp_runtime.service_call import ask

from faults.fault import Phase
from faults.topics import GROUND_TRUTH
from scene_graph import SceneGraph, Stacks
from sim_node.layouts import format_layout
from tamp_bringup.scene_observer import SimulationError

#: Joints that differ by less are where they were [rad].
_SAME: Final = 0.05
#: Joints that differ by more after ``_MOVING_SECONDS`` are under way [rad, s].
_MOVED: Final = 0.02
_MOVING_SECONDS: Final = 0.25
#: Ground truth is kept for so many pictures.
_TRUTHS: Final = 400


class Eyes:
    """Watches the simulator and the motion node past all relays, in a thread of its own."""

    def __init__(self, **node_arguments: Any) -> None:
        self._node = Node("fault_eyes", **node_arguments)
        self._news = threading.Condition()
        self._truths: deque[SceneGraphMsg] = deque(maxlen=_TRUTHS)
        self._count = 0
        self._statuses: list[MotionStatus] = []
        self._joints: bytes | None = None
        self._graphs = 0
        self._home: NDArray[np.float64] | None = None
        node = self._node
        node.create_subscription(SceneGraphMsg, GROUND_TRUTH, self._on_truth, LATCHED)
        node.create_subscription(MotionStatus, "motion_status", self._on_status, RELIABLE)
        node.create_subscription(JointState, "joint_states", self._on_joints, SENSOR_DATA, raw=True)
        node.create_subscription(SceneGraphMsg, "scene_graph", self._on_graph, NEWEST, raw=True)
        node.create_subscription(SymbolicPlan, "symbolic_plan", self._on_plan, LATCHED)
        self._stops: dict[str, int] = {}
        self._setters: dict[str, Client] = {}
        self._reset = node.create_client(ResetScene, "sim/reset")
        self._thread = NodeThread(node)

    def __enter__(self) -> Eyes:
        return self

    def __exit__(self, *_error: object) -> None:
        self._thread.stop()
        self._node.destroy_node()

    def reset(self, layout: Stacks, timeout: float = 30.0) -> None:
        """Puts the blocks somewhere, and the arm home; returns once the truth shows it.

        Raises:
            SimulationError: if the simulator is not there or refuses.
        """
        request = ResetScene.Request(layout=format_layout(layout))
        response = _answer(self._reset, request, timeout)
        if not response.success:
            raise SimulationError(response.message)
        self.fresh_truth(timeout)

    def remember_home(self) -> None:
        """The arm is home now."""
        self._home = self.joints()

    def fresh_truth(self, timeout: float = 10.0) -> SceneGraph:
        """The ground truth of now; raises SimulationError if none arrives."""
        with self._news:
            wanted = self._count + 2
            if not self._news.wait_for(lambda: self._count >= wanted, timeout):
                raise SimulationError(f"no ground truth arrives within {timeout:g} s")
            return graph_from_message(self._truths[-1])

    def truth(self, timeout: float = 2.0) -> SceneGraph | None:
        """The newest ground truth; the last one if none arrives any more, None if none ever did."""
        try:
            return self.fresh_truth(timeout)
        except SimulationError:
            with self._news:
                return graph_from_message(self._truths[-1]) if self._truths else None

    def truth_at(self, stamp: int) -> SceneGraph | None:
        """What was true when a picture was taken [ns], if it is still known."""
        with self._news:
            for message in reversed(self._truths):
                if nanoseconds(message.header.stamp) == stamp:
                    return graph_from_message(message)
        return None

    def forget_motion(self) -> None:
        """What the motion node said up to now is of the past."""
        with self._news:
            self._statuses.clear()
            self._stops.clear()

    def phase_reached(self, phase: Phase, kind: str) -> bool:
        """Whether the motion has come to a phase; ``kind``: pick or place, for EXECUTE."""
        with self._news:
            if phase is Phase.PERCEIVE:
                return True
            executing = [said for said in self._statuses if said.state == said.EXECUTING]
            if phase is Phase.OPTIMISE:
                return bool(executing) or any(
                    said.state == said.OPTIMISING for said in self._statuses
                )
            wanted = kind if phase is Phase.EXECUTE else "home"
            return any(said.phase == wanted for said in executing)

    def reports(self) -> list[MotionReport]:
        """What the motion node said since :meth:`forget_motion`."""
        with self._news:
            return [report_from_message(said) for said in self._statuses]

    def stops(self) -> list[int]:
        """When plans were to be stopped since :meth:`forget_motion`, in simulated time [ns]."""
        with self._news:
            return sorted(self._stops.values())

    def truth_stamp(self) -> int:
        """When the newest ground truth was true, in simulated time [ns]; 0 if there is none."""
        with self._news:
            return nanoseconds(self._truths[-1].header.stamp) if self._truths else 0

    def joints_stamp(self) -> int:
        """The simulated time of the newest joint states [ns]; 0 if there are none."""
        data = self._joints
        return nanoseconds(deserialize_message(data, JointState).header.stamp) if data else 0

    def fresh_truth_stamp(self) -> int:
        """The simulated time of now [ns]; raises SimulationError if none arrives."""
        self.fresh_truth()
        return self.truth_stamp()

    def truth_at_or_before(self, stamp: int) -> SceneGraph | None:
        """The newest ground truth of up to a time [ns], if it is still known."""
        with self._news:
            for message in reversed(self._truths):
                if nanoseconds(message.header.stamp) <= stamp:
                    return graph_from_message(message)
        return None

    def set_parameter(self, node: str, name: str, value: str, timeout: float = 30.0) -> None:
        """Sets a parameter that is a text; raises SimulationError if the node does not take it."""
        service = f"{node}/set_parameters"
        if service not in self._setters:
            self._setters[service] = self._node.create_client(SetParameters, service)
        client = self._setters[service]
        parameter = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[parameter])
        answer = _answer(client, request, timeout)
        if not answer.results[0].successful:
            raise SimulationError(f"{node} does not take {name}: {answer.results[0].reason}")

    def motion(self) -> MotionStatus | None:
        """The last word of the motion node since :meth:`forget_motion`."""
        with self._news:
            return self._statuses[-1] if self._statuses else None

    def joints(self) -> NDArray[np.float64] | None:
        """The newest positions of all joints, or None."""
        data = self._joints
        if data is None:
            return None
        return np.array(deserialize_message(data, JointState).position)

    def arm_moves(self) -> bool:
        """Whether the arm is under way; takes a moment."""
        before = self.joints()
        time.sleep(_MOVING_SECONDS)
        after = self.joints()
        if before is None or after is None:
            return False
        return bool(np.abs(after - before).max() > _MOVED)

    def arm_is_home(self) -> bool:
        """Whether the arm is where the last reset put it."""
        now = self.joints()
        if now is None or self._home is None:
            return False
        return bool(np.abs(now - self._home)[:-2].max() < _SAME)

    def wait_for(self, what: Callable[[], bool], timeout: float) -> bool:
        """Looks again and again until something is so, or the time is over."""
        deadline = time.monotonic() + timeout
        while not what():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.05)
        return True

    def wait_for_graph(self, timeout: float) -> bool:
        """Whether perception says anything from now on in time."""
        wanted = self._graphs + 1
        return self.wait_for(lambda: self._graphs >= wanted, timeout)

    def nodes(self, name: str) -> int:
        """How many nodes of a name there are.

        By a service that every node has: the names of nodes come by a topic of their own, and those
        of a node that is started again at once are now and then not heard of by who is there long.
        """
        return self._node.count_services(f"/{name}/get_parameters")

    def _on_truth(self, message: SceneGraphMsg) -> None:
        with self._news:
            self._truths.append(message)
            self._count += 1
            self._news.notify_all()

    def _on_status(self, message: MotionStatus) -> None:
        with self._news:
            self._statuses.append(message)
            self._news.notify_all()

    def _on_plan(self, message: SymbolicPlan) -> None:
        if not message.moves and not message.plan_id.startswith("home-"):
            with self._news:
                # A stop is published again and again until it is obeyed.
                self._stops.setdefault(message.plan_id, nanoseconds(message.header.stamp))

    def _on_graph(self, _message: bytes) -> None:
        self._graphs += 1

    def _on_joints(self, message: bytes) -> None:
        self._joints = message


def _answer(client: Client, request: Any, timeout: float) -> Any:
    """What a service answers; raises SimulationError if it does not."""
    try:
        return ask(
            lambda: client.call_async(request),
            client.service_is_ready,
            client.wait_for_service,
            timeout,
        )
    except TimeoutError as error:
        raise SimulationError(f"{client.srv_name}: {error}") from None
