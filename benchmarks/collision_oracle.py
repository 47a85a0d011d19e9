# SPDX-License-Identifier: Apache-2.0
"""Distances between the arm's meshes, a held block, the other blocks and the table, by pybullet.

It shares nothing with the motion planner but the plan: it replays a trajectory kinematically,
moves the held block with the hand, and asks Bullet how far things are apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pybullet
import pybullet_data
from numpy.typing import NDArray

from motion_node.obstacles import Obstacle
from motion_node.phases import PICK, PLACE
from motion_node.planner import Motion
from motion_node.robots import PANDA
from motion_node.robots.joints import JointValues
from scene_graph import Move, SceneGraph, apply_move

Array = NDArray[np.float64]

FAR = 0.2
FINGERS = ("panda_leftfinger", "panda_rightfinger")
#: Fingers are beside a block if the point between them is so near to its middle, from above and in
#: height [m]; then they keep this distance to it [m].
BETWEEN = (0.015, 0.06)
BESIDE = 0.002


@dataclass(frozen=True)
class Nearest:
    """The smallest distance found between two things at one moment of a trajectory [m]."""

    distance: float
    what: str
    time: float


@dataclass(frozen=True)
class Replay:
    """What a replayed plan came to.

    Attributes:
        free: the nearest that things came that must not touch.
        support: the nearest that a held block came to what it stands on, next to a switch.
        positions: where the blocks ended [m].
    """

    free: Nearest
    support: Nearest
    positions: dict[str, Array]


class CollisionOracle:
    """One robot, a table and the blocks of a scene, without dynamics."""

    def __init__(self, graph: SceneGraph, obstacles: Sequence[Obstacle] = ()) -> None:
        self.client = pybullet.connect(pybullet.DIRECT)
        path = f"{pybullet_data.getDataPath()}/franka_panda/panda.urdf"
        self.robot = pybullet.loadURDF(path, useFixedBase=True, physicsClientId=self.client)
        count = pybullet.getNumJoints(self.robot, physicsClientId=self.client)
        infos = [
            pybullet.getJointInfo(self.robot, index, physicsClientId=self.client)
            for index in range(count)
        ]
        self.joints = {info[1].decode(): info[0] for info in infos}
        self.links = {info[12].decode(): info[0] for info in infos}
        self.link_names = {index: name for name, index in self.links.items()}
        self.table = self._box((1.0, 1.0, 0.02), (0.3, 0.0, -0.01), (0, 0, 0, 1))
        self.blocks = {
            item.name: self._box(item.size, item.position_world, item.quaternion_world)
            for item in graph.objects
        }
        self.obstacles = {item.name: self._obstacle(item) for item in obstacles}
        self.stacks = graph.stacks()
        self.held: tuple[str, Array, Array] | None = None

    def close(self) -> None:
        pybullet.disconnect(self.client)

    def _box(
        self, size: Sequence[float], position: Sequence[float], quaternion: Sequence[float]
    ) -> int:
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_BOX,
            halfExtents=[value / 2 for value in size],
            physicsClientId=self.client,
        )
        return int(
            pybullet.createMultiBody(
                0.0, shape, -1, position, quaternion, physicsClientId=self.client
            )
        )

    def _obstacle(self, item: Obstacle) -> int:
        turn = (0.0, 0.0, float(np.sin(item.yaw / 2)), float(np.cos(item.yaw / 2)))
        if not item.round:
            return self._box(item.size, item.position_world, turn)
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_CYLINDER,
            radius=item.size[0] / 2,
            height=item.size[2],
            physicsClientId=self.client,
        )
        return int(
            pybullet.createMultiBody(
                0.0, shape, -1, item.position_world, turn, physicsClientId=self.client
            )
        )

    def take_up(self, joints: JointValues) -> None:
        """Puts the arm and its fingers where the joints say; see :meth:`set_joints`."""
        self.set_joints(PANDA.joint_names, joints.joined())

    def set_joints(self, names: Sequence[str], positions: Array) -> None:
        """Puts the robot, and the held block with it, where the joints say."""
        for name, position in zip(names, positions):
            pybullet.resetJointState(
                self.robot, self.joints[name], position, physicsClientId=self.client
            )
        if self.held:
            block, position, quaternion = self.held
            pose = pybullet.multiplyTransforms(*self.hand_pose(), position, quaternion)
            pybullet.resetBasePositionAndOrientation(
                self.blocks[block], *pose, physicsClientId=self.client
            )

    def hand_pose(self) -> tuple[Array, Array]:
        """Position and quaternion of the grasp target in the world."""
        state = pybullet.getLinkState(
            self.robot,
            self.links["panda_grasptarget"],
            computeForwardKinematics=True,
            physicsClientId=self.client,
        )
        return state[4], state[5]

    def block_position(self, name: str) -> Array:
        position, _ = pybullet.getBasePositionAndOrientation(
            self.blocks[name], physicsClientId=self.client
        )
        return np.array(position)

    def grasp(self, name: str) -> None:
        """The block moves with the hand from now on."""
        pose = pybullet.getBasePositionAndOrientation(
            self.blocks[name], physicsClientId=self.client
        )
        inverse = pybullet.invertTransform(*self.hand_pose())
        self.held = (name, *pybullet.multiplyTransforms(*inverse, *pose))

    def release(self, name: str, move: Move, drop: float) -> None:
        """The held block falls by ``drop`` [m] onto what it was held above."""
        body = self.blocks[name]
        position, quaternion = pybullet.getBasePositionAndOrientation(
            body, physicsClientId=self.client
        )
        pybullet.resetBasePositionAndOrientation(
            body, np.subtract(position, (0, 0, drop)), quaternion, physicsClientId=self.client
        )
        self.held = None
        self.stacks = apply_move(self.stacks, move)

    def nearest(self, time: float) -> tuple[Nearest, Nearest]:
        """The two things that are nearest, and the held block and another block or the table.

        What is held touches the fingers; the arm's base stands on the table. Fingers that go
        around a block have to come near to it.

        Raises:
            AssertionError: if they touch it.
        """
        held = self.held[0] if self.held else ""
        robot = carried = Nearest(FAR, "", time)
        others = [(name, body) for name, body in self.blocks.items() if name != held]
        others += self.obstacles.items()
        for name, body in [*others, ("table", self.table)]:
            robot = self._robot_to(body, name, robot)
            if held:
                carried = self._pair(self.blocks[held], body, f"{held} to {name}", carried)
        return robot, carried

    def distance(self, links: Sequence[str], obstacle: str) -> float:
        """Of some of the robot's links to an obstacle [m]."""
        return min(
            point[8]
            for link in links
            for point in pybullet.getClosestPoints(
                self.robot,
                self.obstacles[obstacle],
                3.0,
                linkIndexA=self.links[link],
                physicsClientId=self.client,
            )
        )

    def _pair(self, body: int, other: int, what: str, found: Nearest) -> Nearest:
        for point in pybullet.getClosestPoints(body, other, FAR, physicsClientId=self.client):
            if point[8] < found.distance:
                found = Nearest(point[8], what, found.time)
        return found

    def _between_fingers(self, name: str) -> bool:
        x, y, z = np.subtract(self.hand_pose()[0], self.block_position(name))
        return bool(np.hypot(x, y) < BETWEEN[0] and abs(z) < BETWEEN[1])

    def _robot_to(self, body: int, name: str, found: Nearest) -> Nearest:
        between = name in self.blocks and self._between_fingers(name)
        for point in pybullet.getClosestPoints(self.robot, body, FAR, physicsClientId=self.client):
            link = self.link_names.get(point[3], "panda_link0")
            if name == "table" and link in ("panda_link0", "panda_link1"):
                continue
            if between and link in FINGERS:
                assert point[8] > BESIDE, f"{link} touches {name} at {found.time:.2f} s"
                continue
            if point[8] < found.distance:
                found = Nearest(point[8], f"{link} to {name}", found.time)
        return found


def switches(
    oracle: CollisionOracle,
    moves: Sequence[Move],
    motion: Motion,
    place_gap: float,
    until: float = np.inf,
) -> None:
    """Takes and puts down blocks as a plan does up to a time, skipping the ways in between."""
    trajectory = motion.trajectory
    for interval in trajectory.intervals:
        phase = interval.phase
        if interval.gripping and interval.end <= until:
            oracle.take_up(trajectory.sample(interval.end)[0])
            if phase.kind == PICK:
                oracle.grasp(phase.object_name)
            elif phase.kind == PLACE:
                oracle.release(phase.object_name, moves[phase.move], place_gap)


def replay(
    graph: SceneGraph,
    moves: Sequence[Move],
    motion: Motion,
    place_gap: float,
    vertical: float,
    step: float = 0.04,
    obstacles: Sequence[Obstacle] = (),
) -> Replay:
    """Carries a plan out without dynamics and looks how near things come.

    Args:
        place_gap: height from which blocks are let go [m].
        vertical: a held block may touch what it stands on within this height above a switch [m].
        step: between looks [s].
        obstacles: what stands around besides.
    """
    oracle = CollisionOracle(graph, obstacles)
    trajectory = motion.trajectory
    free = support = Nearest(FAR, "", 0.0)
    half = graph.objects[0].size[0] / 2
    try:
        for interval in trajectory.intervals:
            phase = interval.phase
            if interval.gripping:
                oracle.take_up(trajectory.sample(interval.end)[0])
                if phase.kind == PICK:
                    oracle.grasp(phase.object_name)
                elif phase.kind == PLACE:
                    oracle.release(phase.object_name, moves[phase.move], place_gap)
                continue
            for time in np.arange(interval.start, interval.end, step):
                joints = trajectory.sample(time)[0]
                if oracle.held:
                    joints = JointValues(joints.arm, np.full(2, half))
                oracle.take_up(joints)
                robot, carried = oracle.nearest(float(time))
                hand = np.array(oracle.hand_pose()[0])
                near_switch = any(
                    np.hypot(*(hand[:2] - switch.position_world[:2])) < 0.004
                    and hand[2] < switch.position_world[2] + vertical
                    for switch in (phase.start, phase.switch)
                    if switch
                )
                free = min(free, robot, key=lambda item: item.distance)
                if near_switch:
                    support = min(support, carried, key=lambda item: item.distance)
                else:
                    free = min(free, carried, key=lambda item: item.distance)
        return Replay(free, support, {name: oracle.block_position(name) for name in oracle.blocks})
    finally:
        oracle.close()
