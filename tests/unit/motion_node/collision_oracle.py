# SPDX-License-Identifier: Apache-2.0
"""Distances between the arm's meshes, a held block, the other blocks and the table, by pybullet.

It shares nothing with the motion optimiser but the plan: it replays a trajectory kinematically,
moves the held block with the hand, and asks Bullet how far things are apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pybullet
import pybullet_data
from numpy.typing import NDArray

from scene_graph import Move, SceneGraph, apply_move

Array = NDArray[np.float64]

FAR = 0.2


@dataclass(frozen=True)
class Nearest:
    """The smallest distance found between two kinds of things [m]."""

    distance: float
    what: str
    time: float


class CollisionOracle:
    """One robot, a table and the blocks of a scene, without dynamics."""

    def __init__(self, graph: SceneGraph) -> None:
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

    def release(self, move: Move) -> None:
        """The held block stays where it is, on top of the move's target."""
        self.held = None
        self.stacks = apply_move(self.stacks, move)

    def support_of(self, name: str) -> int:
        """What a block stands on."""
        stack = next(stack for stack in self.stacks if name in stack)
        level = stack.index(name)
        return self.blocks[stack[level - 1]] if level else self.table

    def nearest(self, time: float, touching: Sequence[str] = ()) -> Nearest:
        """The two things that are nearest to one another.

        Args:
            touching: blocks that the fingers are meant to be around.
        """
        found = Nearest(FAR, "", time)
        held = self.held[0] if self.held else ""
        for name, body in self.blocks.items():
            if name == held:
                continue
            found = self._robot_to(body, name, found, name in touching)
            if held:
                found = self._pair(self.blocks[held], body, f"{held} to {name}", found)
        found = self._robot_to(self.table, "table", found, False)
        if held:
            found = self._pair(self.blocks[held], self.table, f"{held} to table", found)
        return found

    def _pair(self, body: int, other: int, what: str, found: Nearest) -> Nearest:
        for point in pybullet.getClosestPoints(body, other, FAR, physicsClientId=self.client):
            if point[8] < found.distance:
                found = Nearest(point[8], what, found.time)
        return found

    def _robot_to(self, body: int, name: str, found: Nearest, fingers_may: bool) -> Nearest:
        for point in pybullet.getClosestPoints(self.robot, body, FAR, physicsClientId=self.client):
            link = self.link_names.get(point[3], "panda_link0")
            if name == "table" and link in ("panda_link0", "panda_link1"):
                continue
            if fingers_may and "finger" in link:
                continue
            if point[8] < found.distance:
                found = Nearest(point[8], f"{link} to {name}", found.time)
        return found
