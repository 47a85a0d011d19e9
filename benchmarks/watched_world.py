# SPDX-License-Identifier: Apache-2.0
"""Plans carried out in the simulator's world by the executive itself, all contacts written down."""

from __future__ import annotations

import threading
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import pybullet
from physical_arm import PhysicalArm
from tamp_runtime.motion_report import MotionReport

from motion_node.execution.condition import Condition
from motion_node.execution.executive import Executive
from motion_node.execution.follow import Follower
from motion_node.execution.plan import Plan
from motion_node.execution.settings import ExecutionSettings
from motion_node.phases import HOME
from motion_node.planner import MotionPlanner
from motion_node.robots import PANDA
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move, SceneGraph, Stacks, apply_move, rotation_from_quaternion
from sim_node.controller import ArmController
from sim_node.trajectory import TrajectoryError
from sim_node.world import World

#: Slower than this the arm is at rest [rad/s], in so many joint states in a row.
RESTING: Final = 0.02
STATES: Final = 3
TABLE: Final = "the table"
#: These may touch what the hand goes to.
_FINGERS: Final = ("panda_leftfinger", "panda_rightfinger")


@dataclass
class Stop:
    """A request to stop while a plan is carried out.

    Attributes:
        after: since the first trajectory was sent [s].
        event: what is set then.
        asked, rested: when that was, and when the arm was at rest then, of simulated time [s].
    """

    after: float
    event: threading.Event = field(default_factory=threading.Event)
    asked: float = np.inf
    rested: float = np.inf
    slow: int = 0


class WatchedArm(PhysicalArm):
    """An arm in a world of which every contact is looked at, in every step of the physics.

    Attributes:
        touched: pairs that touched and must not have.
        doing: the newest report.
    """

    def __init__(self, world: World, moves: list[Move], stacks: Stacks, stop: Stop | None) -> None:
        self._controller = ArmController(world)
        self._moves, self._stacks, self._stop = moves, stacks, stop
        self._sent: float | None = None
        self.touched: set[str] = set()
        self.doing: MotionReport | None = None
        self._names = {world.body(name): name for name in world.names} | {world.table: TABLE}
        self._links = {
            index: pybullet.getJointInfo(world.robot, index, physicsClientId=world.client)[12]
            .decode()
            for index in range(pybullet.getNumJoints(world.robot, physicsClientId=world.client))
        }  # fmt: skip
        super().__init__(world, self)  # type: ignore[arg-type]

    def update(self) -> None:
        """Of the motors: what the controller says, after a look at the contacts."""
        self._look()
        self._controller.update()

    def send(self, trajectory: Trajectory, _begins: float | None = None) -> None:
        """Has the controller follow a trajectory, as the simulator does."""
        if self._sent is None:
            self._sent = self._world.time
        positions, velocities = trajectory.positions.joined(), trajectory.velocities.joined()
        with suppress(TrajectoryError):
            self._controller.follow(PANDA.joint_names, trajectory.times, positions, velocities)

    def observe(self, _fingers: np.ndarray) -> None:
        """Asks for the stop when its time has come, and notes when the arm has come to rest."""
        stop, now = self._stop, self._world.time
        if stop is None or self._sent is None:
            return
        if not stop.event.is_set():
            if now - self._sent >= stop.after:
                stop.asked = now
                stop.event.set()
            return
        speeds = self._world.joint_state()[1][: len(PANDA.arm_joints)]
        if np.isfinite(stop.rested):
            return
        stop.slow = stop.slow + 1 if np.abs(speeds).max() < RESTING else 0
        if stop.slow == STATES:
            stop.rested = now - (STATES - 1) * 4 * self._world.timestep

    def _look(self) -> None:
        world = self._world
        taken = {self._target(index): self._supports(index) for index in self._at_hand()}
        for point in pybullet.getContactPoints(bodyA=world.robot, physicsClientId=world.client):
            other, link = self._names.get(point[2], "itself"), self._links.get(point[3], "base")
            if point[9] <= 0.0 or (other == TABLE and link in ("base", "panda_link0")):
                continue
            if other not in taken or link not in _FINGERS:
                self.touched.add(f"{link} touches {other}")
        for name, beside in taken.items():
            body = world.body(name)
            for point in pybullet.getContactPoints(bodyA=body, physicsClientId=world.client):
                what = self._names.get(point[2])
                if point[9] > 0.0 and what is not None and what not in beside:
                    self.touched.add(f"{name} touches {what}")

    def _at_hand(self) -> list[int]:
        """The moves whose blocks the fingers may have between them."""
        doing = self.doing
        if doing is None or not doing.phase:
            return []
        if doing.phase != HOME:
            return [doing.move]
        # The hand has just let go of one; after a stop it may also hold the next one.
        stopped = self._stop is not None and self._stop.event.is_set()
        found = [doing.moves_done - 1, doing.moves_done] if stopped else [doing.moves_done - 1]
        return [index for index in found if 0 <= index < len(self._moves)]

    def _before(self, index: int) -> Stacks:
        stacks = self._stacks
        for move in self._moves[:index]:
            stacks = apply_move(stacks, move)
        return stacks

    def _target(self, index: int) -> str:
        return self._before(index)[self._moves[index].source][-1]

    def _supports(self, index: int) -> set[str]:
        """What the block of a move stands on before it and after it."""
        stacks, move = self._before(index), self._moves[index]
        return {(TABLE, *stacks[move.source])[-2], (TABLE, *stacks[move.target])[-1]}


def carry_out(
    world: World,
    planner: MotionPlanner,
    graph: SceneGraph,
    moves: list[Move],
    stop: Stop | None = None,
) -> tuple[MotionReport, set[str]]:
    """What became of moves in a world, and what touched what it must not touch."""
    arm = WatchedArm(world, moves, graph.stacks(), stop)
    follower = Follower(arm, arm.send, ExecutionSettings())
    condition = Condition(
        arm, lambda: follower.grip, planner.model.home, 0.04, planner.model.tool_at
    )
    executive = Executive(lambda: planner, arm, follower, condition, ExecutionSettings)

    def heard(report: MotionReport) -> None:
        arm.doing = report

    event = stop.event if stop else threading.Event()
    executive.carry_out(Plan("a", graph, tuple(moves), ()), event, heard)
    return condition.told_in(executive.report), arm.touched


def tilt(world: World, name: str) -> float:
    """Of a block from upright [deg]."""
    upright = rotation_from_quaternion(world.block_pose(name)[1])[2, 2]
    return float(np.degrees(np.arccos(np.clip(upright, -1.0, 1.0))))
