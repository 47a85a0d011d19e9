# SPDX-License-Identifier: Apache-2.0
"""How long a running motion_node takes for motions that are found alone in turns with it."""

from __future__ import annotations

import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Final

import numpy as np
import pybullet_data
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.messages.scene_graph import graph_to_message, moves_to_messages
from tamp_runtime.qos import LATCHED, RELIABLE, SENSOR_DATA

from motion_node.robots import PANDA
from scene_graph import Move, SceneGraph, apply_move
from tamp_bringup.processes import NodeProcesses, use_own_domain

#: Between two joint states of the arm, which stands at home [s].
PERIOD: Final = 0.01
#: An arm that stands still ends a plan soon.
PARAMETERS: Final = {"use_sim_time": "false", "start_timeout": "0.5"}
#: A node that says nothing for so long hangs [s].
TIMEOUT: Final = 60.0
_ENDS: Final = (MotionStatus.SUCCEEDED, MotionStatus.CANCELLED, MotionStatus.FAILED)


class MotionInGraph:
    """A motion_node in a process of its own, beside an arm that tells its joints all the while.

    The arm never sets out, which ends each plan after its motion was found. A context manager.
    """

    def __enter__(self) -> MotionInGraph:
        use_own_domain()
        self._logs = tempfile.TemporaryDirectory()
        self._processes = NodeProcesses(
            Path(self._logs.name), {"motion_node": PARAMETERS}, ("motion_node",)
        ).__enter__()
        rclpy.init()
        self._node = Node("arm_and_planner")
        self._statuses: list[MotionStatus] = []
        self._heard = threading.Condition()
        self.quiet = False
        self._states = self._node.create_publisher(JointState, "joint_states", SENSOR_DATA)
        self._plans = self._node.create_publisher(SymbolicPlan, "symbolic_plan", LATCHED)
        self._node.create_subscription(MotionStatus, "motion_status", self._hear, RELIABLE)
        self._node.create_timer(PERIOD, self._tell)
        urdf = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
        self._description = self._node.create_publisher(String, "robot_description", LATCHED)
        self._description.publish(String(data=urdf.read_text(encoding="utf-8")))
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()
        self._wait(lambda status: status.state == MotionStatus.IDLE)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._executor.shutdown()
        self._thread.join(TIMEOUT)
        self._node.destroy_node()
        rclpy.shutdown()
        self._processes.__exit__(kind, error, trace)
        self._logs.cleanup()

    def seconds(self, name: str, graph: SceneGraph, moves: Sequence[Move]) -> float:
        """The time that the node says it took to find a motion [s].

        Raises:
            TimeoutError: it says nothing for a minute.
        """
        states = [graph.stacks()]
        for move in moves:
            states.append(apply_move(states[-1], move))
        header = Header(stamp=self._node.get_clock().now().to_msg(), frame_id="world")
        self._plans.publish(
            SymbolicPlan(
                header=header,
                plan_id=name,
                initial=graph_to_message(graph, header),
                moves=moves_to_messages(moves, states),
            )
        )
        found = self._wait(
            lambda status: (
                status.plan_id == name
                and (status.state in _ENDS or status.state == MotionStatus.EXECUTING)
            )
        )
        self._wait(lambda status: status.plan_id == name and status.state in _ENDS)
        return float(found.optimisation_seconds)

    def _hear(self, status: MotionStatus) -> None:
        with self._heard:
            self._statuses.append(status)
            self._heard.notify_all()

    def _wait(self, wanted: Callable[[MotionStatus], bool]) -> MotionStatus:
        end = time.monotonic() + TIMEOUT
        with self._heard:
            while True:
                for status in self._statuses:
                    if wanted(status):
                        return status
                if not self._heard.wait(end - time.monotonic()) and time.monotonic() > end:
                    raise TimeoutError("motion_node says nothing of what it was asked for")

    def _tell(self) -> None:
        if self.quiet:
            return
        fingers = np.full(2, PANDA.gripper.finger_travel)
        header = Header(stamp=self._node.get_clock().now().to_msg())
        position = [*map(float, PANDA.home), *map(float, fingers)]
        self._states.publish(
            JointState(header=header, name=list(PANDA.joint_names), position=position)
        )
