# SPDX-License-Identifier: Apache-2.0
"""The motion planner and its execution as a ROS node; see :class:`MotionNode`."""

from __future__ import annotations

import threading
import time
import traceback
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tamp_interfaces.msg import MotionStatus, PlanSighting, SymbolicPlan
from tamp_runtime.messages.motion_status import report_to_message
from tamp_runtime.messages.stamps import seconds
from tamp_runtime.motion_report import MotionReport, MotionState
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.presence import Presence
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA, STATUS
from tamp_runtime.stream_thread import StreamThread
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import MarkerArray

from .certificate import Suggestions
from .conversions import (
    joint_positions,
    obstacles_from_markers,
    plan_from_message,
    sighting_from_message,
    trajectory_to_message,
    trajectory_to_two_messages,
)
from .correcting import choices_of, corrected
from .errors import InfeasibleError, JointStateError, MotionError
from .execution.arm_state import ArmState, ArmStateBox
from .execution.condition import Condition
from .execution.executive import Executive
from .execution.follow import Follower
from .execution.last_look import Sightings
from .execution.plan import Plan
from .execution.settings import ExecutionSettings
from .execution.worker import PlanWorker
from .frames import check_frame
from .obstacles import Obstacle, read_obstacles
from .parameters import (
    PARAMETERS,
    chosen_arm,
    execution_settings,
    planner_settings,
    timing_settings,
)
from .planner import MotionPlanner
from .surroundings import Planners, Surroundings
from .timing.trajectory import Trajectory

#: Numbers of stacks and of moves for which the problems are built before they are asked for.
PREPARED_STACKS = 3
PREPARED_MOVES = 12


class MotionNode(Node):
    """Turns symbolic plans into joint trajectories and watches them being carried out.

    Subscribes:
        symbolic_plan (tamp_interfaces/SymbolicPlan, latched): the moves to carry out; without
            moves, a request to stop, or to bring home an arm that no plan moves. Plans published
            before this node started are ignored.
        plan_sighting (tamp_interfaces/PlanSighting): what is seen of a plan that is watched
        joint_states (sensor_msgs/JointState)
        robot_description (std_msgs/String, latched): URDF
        obstacles (visualization_msgs/MarkerArray, latched): what stands around besides blocks, as
            RViz takes it; see :func:`obstacles_from_markers`. Plans keep clear of it from now on; a
            motion under way that it is in the way of is stopped
        diagnostics (diagnostic_msgs/DiagnosticArray): who lives; with two nodes that do the work
            of one, plans are refused with the reason CONFLICT
    Publishes:
        joint_trajectory (trajectory_msgs/JointTrajectory): of all joints; starts at once, replaces
            the running one. With gripper_apart of the arm's joints, and stamped with its start
        gripper_trajectory (trajectory_msgs/JointTrajectory), with gripper_apart: of the fingers'
            joints, with the same stamp
        motion_status (tamp_interfaces/MotionStatus, the newest ones are kept for late listeners):
            at every change, and once a second
        diagnostics (diagnostic_msgs/DiagnosticArray): that it lives

    Callbacks only store what they hear; one worker thread carries out plans.
    """

    def __init__(self, **kwargs: Any) -> None:
        # A latched plan is delivered to a restarted node with the wall time of its publication,
        # which, unlike its header's stamp, does not depend on a simulated clock.
        self._started = time.time_ns()
        super().__init__("motion_node", **kwargs)
        self._values = declare_parameters(self, PARAMETERS, self._parameters_changed)
        self._arm = chosen_arm(self._values)
        self._around = Surroundings(read_obstacles(self._values["obstacles"]))
        self._planners = Planners(self._around)
        self._states, self._sightings = ArmStateBox(), Sightings()
        self._description = ""
        self._early: list[MarkerArray] = []
        self._hearing = threading.Lock()

        self._trajectories = self.create_publisher(JointTrajectory, "joint_trajectory", RELIABLE)
        self._gripper: Publisher | None = None
        if self._values["gripper_apart"]:
            self._gripper = self.create_publisher(JointTrajectory, "gripper_trajectory", RELIABLE)
        self._statuses = self.create_publisher(MotionStatus, "motion_status", STATUS)
        self._presence = Presence(self, "motion_node")
        follower = Follower(self._states, self._send, self._settings(), self._missing_controller)
        condition = Condition(
            self._states,
            lambda: follower.grip,
            np.array(self._arm.home),
            self._arm.gripper.finger_travel,
            lambda q: planner.model.tool_at(q) if (planner := self._planners.any) else None,
            lambda: self._settings().monitor.goal_tolerance,
        )
        executive = Executive(
            self._planners.now,
            self._states,
            follower,
            condition,
            self._settings,
            self._presence.conflict,
            self._check_frame,
            self._suggest,
            lambda plan, motion, at: self._planners.in_the_way(motion, plan.graph, at),
            self._sightings,
            lambda planner, plan, first, now, at, graph: corrected(
                planner, now, at, graph, plan.moves, choices=choices_of(first)
            ),
        )
        self._moving = lambda: follower.under_way
        self._worker = PlanWorker(
            executive, condition, self._publish, self._on_defect, self._presence.conflict
        )
        plans = MutuallyExclusiveCallbackGroup()
        obstacles = MutuallyExclusiveCallbackGroup()
        building = MutuallyExclusiveCallbackGroup()  # of problems, for seconds
        self._joint_states = StreamThread.subscribe(
            self, JointState, "joint_states", self._on_joint_state, SENSOR_DATA
        )
        self.create_subscription(
            String, "robot_description", self._on_description, LATCHED, callback_group=building
        )
        self.create_subscription(
            MarkerArray, "obstacles", self._on_obstacles, LATCHED, callback_group=obstacles
        )
        self._building = self.create_guard_condition(self._build, callback_group=building)
        with_info: Any = self._on_plan  # rclpy passes the message's times to a second argument
        self.create_subscription(
            SymbolicPlan, "symbolic_plan", with_info, LATCHED, callback_group=plans
        )
        self.create_subscription(
            PlanSighting,
            "plan_sighting",
            lambda message: self._sightings.put(sighting_from_message(message)),
            NEWEST,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        # The beat is in wall time: a planner shall hear of a node that waits for the clock, too.
        self.create_timer(
            1.0,
            self._worker.beat,
            callback_group=MutuallyExclusiveCallbackGroup(),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        self._worker.start()

    def destroy_node(self) -> None:
        """The running trajectory goes on: it ends at home with an empty hand, if it is not cut."""
        self._joint_states.stop()
        self._states.close()
        self._worker.close(timeout=2.0)
        super().destroy_node()

    def _settings(self) -> ExecutionSettings:
        return execution_settings(self._values)

    # What is heard

    def _parameters_changed(self, values: dict[str, Any]) -> None:
        self._values = {**self._values, **values}
        for planner in self._planners.all:
            planner.timing = timing_settings(self._values)

    def _on_joint_state(self, message: JointState) -> None:
        try:
            positions = joint_positions(message, self._arm)
        except JointStateError as error:
            if str(error) != self._states.problem:
                self.get_logger().warning(str(error))
            self._states.refuse(str(error))
            return
        self._states.put(seconds(message.header.stamp) or None, positions)

    def _on_description(self, message: String) -> None:
        if message.data == self._description:
            return
        self._description = message.data

        def make(obstacles: Sequence[Obstacle]) -> MotionPlanner:
            settings = planner_settings(self._values)
            planner = MotionPlanner(message.data, self._arm, settings, obstacles=obstacles)
            planner.prepare(PREPARED_STACKS)
            return planner

        try:
            planner = self._planners.describe(make)
        except MotionError as error:
            self.get_logger().error(f"robot_description cannot be used: {error}")
            return
        self.get_logger().info("ready for plans")
        with self._hearing:
            early, self._early = self._early, []
            for heard in early:
                self._hear_obstacles(heard)
        self._prepare(planner)

    def _prepare(self, planner: MotionPlanner) -> None:
        planner.timing = timing_settings(self._values)  # it may have been changed meanwhile
        for moves in range(1, PREPARED_MOVES + 1):
            if self._planners.wanting or not self.context.ok():
                return
            planner.prepare(PREPARED_STACKS, moves)

    def _build(self) -> None:
        if (planner := self._planners.build(self._moving)) is not None:
            self._prepare(planner)

    def _on_obstacles(self, message: MarkerArray) -> None:
        with self._hearing:
            if self._planners.any is None:  # in which frame the arm is is not known yet
                self._early.append(message)
            else:
                self._hear_obstacles(message)

    def _hear_obstacles(self, message: MarkerArray) -> None:
        if self._around.hear(
            lambda known: obstacles_from_markers(message, known, self._check_obstacles_frame)
        ):
            self.get_logger().info(f"{len(self._around.all)} obstacles are kept clear of")
        else:
            self.get_logger().warning(f"obstacles are refused: {self._around.problem}")
        self._building.trigger()
        self._worker.beat()

    def _on_plan(self, message: SymbolicPlan, info: dict[str, Any]) -> None:
        published = int(info.get("source_timestamp", 0))
        if 0 < published < self._started:
            becomes = "is older than this node and is ignored"
        elif message.moves:
            becomes = self._worker.ask(
                message.plan_id, len(message.moves), lambda: plan_from_message(message)
            )
        else:
            becomes = self._worker.stop(message.plan_id)
        self.get_logger().info(f"plan {message.plan_id!r} {becomes}")

    # What is said

    def _send(self, trajectory: Trajectory, begins: float | None) -> None:
        if not self.context.ok():
            return
        if self._gripper is None:
            self._trajectories.publish(trajectory_to_message(trajectory, self._arm, begins))
            return
        arm, fingers = trajectory_to_two_messages(trajectory, self._arm, begins)
        self._gripper.publish(fingers)  # first: fingers that are to go on holding shall know
        self._trajectories.publish(arm)

    def _missing_controller(self) -> str:
        """Which controller nobody hears for; empty: none."""
        for whose, publisher in (("arm", self._trajectories), ("gripper", self._gripper)):
            if publisher is not None and not publisher.get_subscription_count():
                topic = publisher.topic_name
                return f"nobody listens to {topic}; is the {whose}'s controller running?"
        return ""

    def _check_frame(self, plan: Plan) -> None:
        check_frame(plan.frame, self._root, self._values["world_frame"])

    def _check_obstacles_frame(self, frame: str) -> None:
        check_frame(frame, self._root, self._values["world_frame"], "the obstacles")

    @property
    def _root(self) -> str:
        planner = self._planners.any
        return planner.model.kinematics.root if planner else self._values["world_frame"]

    def _suggest(
        self,
        plan: Plan,
        state: ArmState,
        error: InfeasibleError,
        stopped: Callable[[], bool],
    ) -> str:
        planner = self._planners.now()
        assert planner is not None
        arm, fingers = state.positions.arm, state.positions.fingers
        found = Suggestions(planner).suggest(plan.graph, plan.moves, arm, fingers, error, stopped)
        return found.words if found else ""

    def _publish(self, report: MotionReport) -> None:
        if not self.context.ok():
            return
        if report.state is MotionState.FAILED:
            self.get_logger().warning(f"plan {report.plan_id!r} failed: {report.message}")
        elif report.message:
            self.get_logger().debug(f"plan {report.plan_id!r}: {report.message}")
        report = self._around.told_in(report)
        self._statuses.publish(report_to_message(report, self.get_clock().now().to_msg()))

    def _on_defect(self, plan_id: str) -> None:
        if self.context.ok():
            self.get_logger().error(f"plan {plan_id!r} met a defect:\n{traceback.format_exc()}")


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(MotionNode)
