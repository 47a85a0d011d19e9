# SPDX-License-Identifier: Apache-2.0
"""The motion node's neighbours without physics: an arm's driver, and a planner that only talks."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pybullet_data
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.parameter import Parameter
from scipy.interpolate import CubicHermiteSpline
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from tamp_interfaces.msg import (
    Base,
    MotionStatus,
    Move,
    Relation,
    SceneGraph,
    SceneObject,
    SymbolicPlan,
)
from tamp_runtime.qos import LATCHED, RELIABLE, SENSOR_DATA, STATUS
from trajectory_msgs.msg import JointTrajectory

from motion_node.node import MotionNode
from motion_node.robots import PANDA

Array = NDArray[np.float64]

FINGERS = len(PANDA.arm_joints)
HOME = np.array([*PANDA.home, 0.04, 0.04])
#: Machines that stand still for half a minute exist, and the time of this arm is not the wall's.
PATIENT = {"joint_state_timeout": 60.0, "start_timeout": 60.0, "max_lag": 60.0}
EDGE = 0.045
COLORS = ("red", "green", "blue", "yellow", "purple")
ENDS = (MotionStatus.SUCCEEDED, MotionStatus.CANCELLED, MotionStatus.FAILED)


class FakeArm(Node):
    """Follows every trajectory exactly, in a time of its own.

    Attributes:
        step: how much later by its clock each tick is [s]; 15 times faster than the wall clock,
            and slower on a machine that is busy elsewhere.
        hold_at: it stands still, as if held, this long after it set out [s]; None: it does not.
        cut_at: the next trajectory ends this long after it set out [s]; None: at its end.
        unusable: the third joint's position is not a number.
        block: half of what the fingers close on [m].
        trajectories: those received.
    """

    TICK = 0.004

    def __init__(self, describe: bool = True, **kwargs: Any) -> None:
        super().__init__("fake_arm", **kwargs)
        self.step, self.block = 15 * self.TICK, EDGE / 2
        self.hold_at: float | None = None
        self.cut_at: float | None = None
        self.unusable = False
        self._end = 0.0
        self.trajectories: list[JointTrajectory] = []
        self._lock = threading.Lock()
        self._positions = HOME.copy()
        self._spline: CubicHermiteSpline | None = None
        self._along, self._time = 0.0, 100.0
        self._states = self.create_publisher(JointState, "joint_states", SENSOR_DATA)
        self._description = self.create_publisher(String, "robot_description", LATCHED)
        self.create_subscription(JointTrajectory, "joint_trajectory", self._follow, RELIABLE)
        self.create_timer(self.TICK, self._tick)
        if describe:
            self.describe()

    def describe(self, text: str | None = None) -> None:
        """Publishes the robot description."""
        path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
        self._description.publish(String(data=text or path.read_text(encoding="utf-8")))

    @property
    def time(self) -> float:
        """By its clock [s]."""
        return self._time

    @property
    def positions(self) -> Array:
        """Where the joints are, shape (9,)."""
        with self._lock:
            return self._positions.copy()

    @property
    def held(self) -> bool:
        """Whether it stands still as ``hold_at`` says."""
        return self.hold_at is not None and self._along >= self.hold_at

    @property
    def at_home(self) -> bool:
        """Whether the arm is home with open fingers."""
        return bool(np.abs(self.positions - HOME).max() < 0.02)

    def put(self, arm: Array) -> None:
        """The arm is there, and nobody has sent it."""
        with self._lock:
            self._positions[:FINGERS] = arm

    def _follow(self, message: JointTrajectory) -> None:
        times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points]
        order = [list(message.joint_names).index(name) for name in PANDA.joint_names]
        positions = np.array([p.positions for p in message.points])[:, order]
        velocities = np.array([p.velocities for p in message.points])[:, order]
        with self._lock:
            jump = np.abs(positions[0] - self._positions)[:FINGERS].max()
            assert jump < 0.3, f"the trajectory starts {jump:.2f} rad from here"
            self._spline, self._along = CubicHermiteSpline(times, positions, velocities), 0.0
            self._end, self.cut_at = self.cut_at or times[-1], None
            self.trajectories.append(message)

    def _tick(self) -> None:
        with self._lock:
            held = self.held
            self._time += 0.001 if held else self.step
            if self._spline is not None and not held:
                self._along += self.step
                self._positions = np.array(self._spline(min(self._along, self._end)))
                self._positions[FINGERS:] = np.maximum(self._positions[FINGERS:], self.block)
            positions, stamp = self._positions.tolist(), self._time
            if self.unusable:
                positions[2] = float("nan")
        if not self.context.ok():
            return
        header = Header()
        header.stamp.sec, header.stamp.nanosec = int(stamp), int(stamp % 1 * 1e9)
        names = list(PANDA.joint_names)
        self._states.publish(JointState(header=header, name=names, position=positions))


class FakePlanner(Node):
    """Publishes plans and keeps the statuses."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("fake_planner", **kwargs)
        self.statuses: list[MotionStatus] = []
        self._plans = self.create_publisher(SymbolicPlan, "symbolic_plan", LATCHED)
        self.create_subscription(MotionStatus, "motion_status", self.statuses.append, RELIABLE)

    def ask(self, plan: SymbolicPlan) -> None:
        """Publishes a plan."""
        plan.header.stamp = self.get_clock().now().to_msg()
        self._plans.publish(plan)

    def stop(self, plan_id: str) -> None:
        """Asks to stop a plan."""
        self.ask(SymbolicPlan(plan_id=plan_id))

    def of(self, plan_id: str) -> list[MotionStatus]:
        """The statuses of a plan so far."""
        return [status for status in list(self.statuses) if status.plan_id == plan_id]

    def end(self, plan_id: str) -> MotionStatus | None:
        """The status that ended a plan."""
        return next((status for status in self.of(plan_id) if status.state in ENDS), None)


class LateListener(Node):
    """Hears what was said before it came."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("late_listener", **kwargs)
        self.statuses: list[MotionStatus] = []
        self.create_subscription(MotionStatus, "motion_status", self.statuses.append, STATUS)


class Bench:
    """Arm and planner in one context, and the motion node when it is started."""

    def __init__(self, ros: Any, describe: bool = True) -> None:
        self.ros = ros
        self.arm = ros.add(FakeArm(describe=describe, context=ros.context))
        self.planner = ros.add(FakePlanner(context=ros.context))

    def make(self, **parameters: Any) -> MotionNode:
        """A motion node that is not spun yet."""
        values = {**PATIENT, **parameters}
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        return MotionNode(context=self.ros.context, parameter_overrides=overrides)

    def start(self, **parameters: Any) -> MotionNode:
        """A motion node that its neighbours have found."""
        node: MotionNode = self.ros.add(self.make(**parameters))
        self.ros.wait_until(
            lambda: (
                node.count_subscribers("joint_trajectory")
                and node.count_subscribers("motion_status")
                and self.planner.count_subscribers("symbolic_plan")
            ),
            what="discovery",
        )
        return node

    def wait(self, condition: Callable[[], Any], what: str) -> None:
        self.ros.wait_until(condition, what=what)

    def end(self, plan_id: str) -> MotionStatus:
        self.wait(lambda: self.planner.end(plan_id), f"the end of {plan_id}")
        end = self.planner.end(plan_id)
        assert end is not None
        return end

    def wait_for_phase(self, plan_id: str, phase: str, move: int) -> None:
        self.wait(
            lambda: any(
                (status.phase, status.move, status.state) == (phase, move, MotionStatus.EXECUTING)
                for status in self.planner.of(plan_id)
            ),
            f"{phase} of move {move}",
        )

    def wait_for_idle(self) -> None:
        self.wait(
            lambda: any(status.state == MotionStatus.IDLE for status in self.planner.statuses),
            "IDLE",
        )


def scene_message(heights: tuple[int, ...] = (2, 1, 0)) -> SceneGraph:
    """Towers of boxes on three places; the first colours stand on the left, from the bottom."""
    message = SceneGraph()
    colors = iter(COLORS)
    for index, (count, y) in enumerate(zip(heights, (-0.15, 0.0, 0.15))):
        base = Base(index=index)
        base.position.x, base.position.y = 0.5, y
        message.bases.append(base)
        below = f"stack{index}"
        for level in range(count):
            color = next(colors)
            item = SceneObject(name=f"{color}_box", color=color, shape="box")
            item.pose.position.x, item.pose.position.y = 0.5, y
            item.pose.position.z = (level + 0.5) * EDGE
            item.size.x = item.size.y = item.size.z = EDGE
            message.objects.append(item)
            message.relations.append(
                Relation(subject=item.name, predicate=Relation.UP, object=below)
            )
            below = item.name
    return message


def plan_message(
    plan_id: str, *moves: tuple[int, int], heights: tuple[int, ...] = (2, 1, 0)
) -> SymbolicPlan:
    """A plan of moves (p, q) that names no blocks."""
    return SymbolicPlan(
        plan_id=plan_id,
        initial=scene_message(heights),
        moves=[Move(source=p, target=q) for p, q in moves],
    )
