# SPDX-License-Identifier: Apache-2.0
"""The motion optimiser as a ROS node; see :class:`MotionNode`."""

from __future__ import annotations

import queue
import threading
import time
import traceback
from dataclasses import replace
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.messages.motion_status import report_to_message
from tamp_runtime.messages.stamps import seconds
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.qos import LATCHED, RELIABLE, SENSOR_DATA
from trajectory_msgs.msg import JointTrajectory

from .conversions import (
    joint_positions,
    plan_from_message,
    trajectory_to_message,
)
from .errors import InvalidPlanError, MotionError
from .execution.arm_state import ArmStateBox
from .execution.executive import Executive, Plan
from .optimiser import MotionOptimiser
from .parameters import PARAMETERS, execution_settings, optimiser_settings, timing_settings
from .robots import PANDA
from .timing.trajectory import Trajectory

#: Numbers of stacks and of moves for which the problems are built before they are asked for.
PREPARED_STACKS = 3
PREPARED_MOVES = 12


class MotionNode(Node):
    """Turns symbolic plans into joint trajectories and watches them being carried out.

    Subscribes:
        symbolic_plan (tamp_interfaces/SymbolicPlan, latched): the moves to carry out; without
            moves, a request to stop. Plans published before this node started are ignored.
        joint_states (sensor_msgs/JointState)
        robot_description (std_msgs/String, latched): URDF
    Publishes:
        joint_trajectory (trajectory_msgs/JointTrajectory): starts at once, replaces the running one
        motion_status (tamp_interfaces/MotionStatus): at every change, once a second while busy

    Callbacks only store what they hear; one worker thread carries out plans.
    """

    def __init__(self, **kwargs: Any) -> None:
        # A latched plan is delivered to a restarted node with the wall time of its publication,
        # which, unlike its header's stamp, does not depend on a simulated clock.
        self._started = time.time_ns()
        super().__init__("motion_node", **kwargs)
        self._values = declare_parameters(self, PARAMETERS, self._parameters_changed)
        self._robot = replace(PANDA, acceleration=tuple(self._values["acceleration_limits"]))
        self._arm = ArmStateBox()
        self._optimiser: MotionOptimiser | None = None
        self._description = ""
        self._lock = threading.Lock()
        self._running: str | None = None
        self._stop = threading.Event()
        self._plans: queue.SimpleQueue[tuple[Plan, threading.Event] | None] = queue.SimpleQueue()
        self._had_plan = False
        self._warned_about_joints = False

        self._trajectories = self.create_publisher(JointTrajectory, "joint_trajectory", RELIABLE)
        self._statuses = self.create_publisher(MotionStatus, "motion_status", RELIABLE)
        self._executive = Executive(
            lambda: self._optimiser,
            self._arm,
            self._send,
            lambda: execution_settings(self._values),
        )
        streams, plans = MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()
        self.create_subscription(
            JointState, "joint_states", self._on_joint_state, SENSOR_DATA, callback_group=streams
        )
        self.create_subscription(
            String, "robot_description", self._on_description, LATCHED, callback_group=plans
        )
        with_info: Any = self._on_plan  # rclpy passes the message's times to a second argument
        self.create_subscription(
            SymbolicPlan, "symbolic_plan", with_info, LATCHED, callback_group=plans
        )
        # The beat is in wall time: a planner shall hear of a node that waits for the clock, too.
        self.create_timer(
            1.0,
            self._beat,
            callback_group=MutuallyExclusiveCallbackGroup(),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        self._worker = threading.Thread(target=self._work, name="motion", daemon=True)
        self._worker.start()

    def destroy_node(self) -> None:
        """The running trajectory goes on: it ends at home with an empty hand, if it is not cut."""
        self._plans.put(None)
        self._worker.join(timeout=2.0)
        super().destroy_node()

    # Callbacks

    def _parameters_changed(self, values: dict[str, Any]) -> None:
        self._values = {**self._values, **values}
        if self._optimiser:
            self._optimiser.timing = timing_settings(self._values)

    def _on_joint_state(self, message: JointState) -> None:
        positions = joint_positions(message, self._robot)
        if positions is None:
            if not self._warned_about_joints:
                names = ", ".join(self._robot.joint_names)
                self.get_logger().warning(
                    f"joint_states lack finite positions of some of {names}"
                )
            self._warned_about_joints = True
            return
        self._arm.put(seconds(message.header.stamp) or time.monotonic(), positions)

    def _on_description(self, message: String) -> None:
        if message.data == self._description:
            return
        self._description = message.data
        try:
            optimiser = MotionOptimiser(message.data, self._robot, optimiser_settings(self._values))
            optimiser.prepare(PREPARED_STACKS)
        except MotionError as error:
            self.get_logger().error(f"robot_description cannot be used: {error}")
            return
        self._optimiser = optimiser
        self.get_logger().info("ready for plans")
        for moves in range(1, PREPARED_MOVES + 1):
            optimiser.prepare(PREPARED_STACKS, moves)

    def _on_plan(self, message: SymbolicPlan, info: dict[str, Any]) -> None:
        published = int(info.get("source_timestamp", 0))
        if 0 < published < self._started:
            self.get_logger().info(
                f"plan {message.plan_id!r} is older than this node and is ignored"
            )
            return
        if not message.moves:
            self._on_stop(message.plan_id)
            return
        with self._lock:
            running = self._running
            if running is None:
                self._running, self._had_plan = message.plan_id, True
                self._stop = threading.Event()
        if running is None:
            self._take_up(message)
        elif running == message.plan_id:
            self.get_logger().info(f"plan {running!r} is being carried out already")
        else:
            sentence = f"plan {running!r} is being carried out; wait for it, or stop it"
            self._refuse(message, MotionReason.BUSY, sentence)

    def _take_up(self, message: SymbolicPlan) -> None:
        try:
            plan = plan_from_message(message)
        except InvalidPlanError as error:
            with self._lock:
                self._running = None
            self._refuse(message, MotionReason.INVALID_PLAN, str(error))
            return
        self.get_logger().info(f"plan {plan.plan_id!r}: {len(plan.moves)} moves")
        self._plans.put((plan, self._stop))

    def _refuse(self, message: SymbolicPlan, reason: MotionReason, sentence: str) -> None:
        self._publish(
            MotionReport(
                message.plan_id,
                MotionState.FAILED,
                reason,
                sentence,
                moves_total=len(message.moves),
            )
        )

    def _on_stop(self, plan_id: str) -> None:
        """A plan without moves: stop that plan, or whatever runs if it names none."""
        with self._lock:
            running, stop = self._running, self._stop
        if running is not None and plan_id in ("", running):
            self.get_logger().info(f"stopping plan {running!r} on request")
            stop.set()
            return
        last = self._executive.report
        if last.plan_id == plan_id and last.state.ended:
            self._publish(last)
        else:
            self._publish(
                MotionReport(
                    plan_id, MotionState.CANCELLED, message="this plan is not being carried out"
                )
            )

    def _beat(self) -> None:
        with self._lock:
            running, had_plan = self._running, self._had_plan
        if running is not None:
            report = self._executive.report
            if report.plan_id == running and not report.state.ended:
                self._publish(report)
        elif not had_plan:
            # So that a planner whose plan was lost with an earlier life of this node learns of it.
            self._publish(MotionReport())

    # The worker thread

    def _work(self) -> None:
        while (item := self._plans.get()) is not None:
            plan, stop = item
            try:
                self._executive.carry_out(plan, stop, self._report)
            except Exception:
                if self.context.ok():
                    self.get_logger().error(
                        f"plan {plan.plan_id!r} met a defect:\n{traceback.format_exc()}"
                    )

    def _report(self, report: MotionReport) -> None:
        """Publishes a report of the worker; at its end the next plan may come at once."""
        if report.state.ended:
            with self._lock:
                self._running = None
        self._publish(report)

    def _send(self, trajectory: Trajectory) -> None:
        if self.context.ok():
            self._trajectories.publish(trajectory_to_message(trajectory, self._robot))

    def _publish(self, report: MotionReport) -> None:
        if not self.context.ok():
            return
        if report.state is MotionState.FAILED:
            self.get_logger().warning(f"plan {report.plan_id!r} failed: {report.message}")
        elif report.message:
            self.get_logger().debug(f"plan {report.plan_id!r}: {report.message}")
        self._statuses.publish(report_to_message(report, self.get_clock().now().to_msg()))


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(MotionNode)
