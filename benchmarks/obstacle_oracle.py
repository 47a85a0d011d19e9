# SPDX-License-Identifier: Apache-2.0
"""Brute force for small tables with obstacles, by pybullet's meshes; shares no constraint.

Whether a hand can stand at a place: configurations from many starts, and Bullet's distances.
Whether a goal can be reached: all arrangements, with the moves whose ends a hand can stand at.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np
import pybullet
import pybullet_data
from motion_scenes import EDGE
from numpy.typing import NDArray

from motion_node.obstacles import Obstacle
from motion_node.planner import Motion, MotionPlanner
from motion_node.robots import PANDA
from planner_node.goals import Goal
from scene_graph import Stacks, all_moves, apply_move

Array = NDArray[np.float64]

#: Bullet's distance at which a hand can surely stand there, and surely not: the planner keeps its
#: clearance, and its hulls are larger than meshes [m].
SURE: Final = 0.035
NEVER: Final = 0.004
#: Configurations are looked for from so many starts.
STARTS: Final = 40
_FAR: Final = 0.1


class ObstacleOracle:
    """The arm's meshes among obstacles."""

    def __init__(self, planner: MotionPlanner, obstacles: Sequence[Obstacle]) -> None:
        self._planner = planner
        self._client = pybullet.connect(pybullet.DIRECT)
        path = f"{pybullet_data.getDataPath()}/franka_panda/panda.urdf"
        self._robot = pybullet.loadURDF(path, useFixedBase=True, physicsClientId=self._client)
        names = [
            pybullet.getJointInfo(self._robot, i, physicsClientId=self._client)[1].decode()
            for i in range(pybullet.getNumJoints(self._robot, physicsClientId=self._client))
        ]
        self._joints = [names.index(name) for name in PANDA.joint_names]
        self._obstacles = [self._body(item) for item in obstacles]
        self._rng = np.random.default_rng(0)

    def close(self) -> None:
        """Ends the physics server."""
        pybullet.disconnect(self._client)

    def _body(self, item: Obstacle) -> int:
        turn = (0.0, 0.0, float(np.sin(item.yaw / 2)), float(np.cos(item.yaw / 2)))
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=np.array(item.size) / 2, physicsClientId=self._client
        )
        return int(
            pybullet.createMultiBody(
                0.0, shape, -1, item.position_world, turn, physicsClientId=self._client
            )
        )

    def distance(self, arm: Array, fingers: Array) -> float:
        """Of the arm's meshes to the nearest obstacle, at most ``_FAR`` [m]."""
        for joint, value in zip(self._joints, [*arm, *fingers]):
            pybullet.resetJointState(self._robot, joint, value, physicsClientId=self._client)
        found = [
            point[8]
            for body in self._obstacles
            for point in pybullet.getClosestPoints(
                self._robot, body, _FAR, physicsClientId=self._client
            )
        ]
        return float(min(found, default=_FAR))

    def standing(self, place: tuple[float, float], level: int) -> float:
        """The best distance with which a hand stands at a place [m]; -1: out of reach."""
        point = np.array([*place, (level + 0.5) * EDGE])
        home, best = self._planner.model.home, -1.0
        for yaw in (0.0, np.pi / 2):
            near = home + self._rng.uniform(-1.0, 1.0, (STARTS, 7))
            near[:, 0] += np.arctan2(point[1], point[0])
            points, yaws = np.tile(point, (STARTS, 1)), np.full(STARTS, yaw)
            q = self._planner.inverse.solve(points, yaws, near, iterations=60)
            missed = np.abs(self._planner.inverse.residual(q, points)).max(axis=1)
            for own in q[missed < 1e-3]:
                best = max(best, self.distance(own, np.full(2, 0.04)))
        return best

    def touched(self, motion: Motion, step: float = 0.02) -> float:
        """The least distance along a motion [m]."""
        times = np.arange(0.0, motion.trajectory.duration, step)
        positions, _ = motion.trajectory.sample(times)
        return min(self.distance(a, f) for a, f in zip(positions.arm, positions.fingers))


class Reachable:
    """Which goals can be reached on a table, by all arrangements of its blocks."""

    def __init__(
        self, oracle: ObstacleOracle, places: Sequence[tuple[float, float]], blocks: int
    ) -> None:
        self._oracle, self._places, self._blocks = oracle, places, blocks

    @cached_property
    def distances(self) -> list[list[float]]:
        """Of a hand at each place and level [m]."""
        levels = range(self._blocks)
        return [[self._oracle.standing(place, level) for level in levels] for place in self._places]

    @property
    def clear(self) -> bool:
        """Whether it is sure of each whether a hand can stand there."""
        return not any(NEVER < value < SURE for own in self.distances for value in own)

    def solvable(self, start: Stacks, goal: Goal) -> bool:
        """Breadth first over all arrangements."""
        seen, queue = {start}, deque([start])
        while queue:
            state = queue.popleft()
            if goal.holds(state):
                return True
            for move in all_moves(len(state)):
                if not state[move.source] or not self._possible(state, move.source, move.target):
                    continue
                after = apply_move(state, move)
                if after not in seen:
                    seen.add(after)
                    queue.append(after)
        return False

    def _possible(self, state: Stacks, source: int, target: int) -> bool:
        taken, put = len(state[source]) - 1, len(state[target])
        return min(self.distances[source][taken], self.distances[target][put]) >= SURE
