# SPDX-License-Identifier: Apache-2.0
"""The simulated world: a table, blocks under gravity, and a Franka Panda with its gripper.

Nothing holds a block but contact and friction: there are no constraints between bodies, no
teleports after a reset, and gravity is always on.
"""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Any, Final

import numpy as np
import pybullet
import pybullet_data
from numpy.typing import NDArray

from scene_graph import COLORS, CYLINDER, SPHERE, Stacks, split_object_name

from .camera import CameraRenderer, Frame
from .layouts import check_layout
from .scene import SceneConfig

URDF_PATH: Final = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
ARM_JOINTS: Final = tuple(f"panda_joint{number}" for number in range(1, 8))
FINGER_JOINTS: Final = ("panda_finger_joint1", "panda_finger_joint2")
JOINTS: Final = ARM_JOINTS + FINGER_JOINTS
#: Joint positions after a reset [rad, m]: hand up and back, fingers open, no block hidden.
HOME: Final = (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785, 0.04, 0.04)

_TABLE_HALF_EXTENTS: Final = (0.5, 0.6, 0.02)
_TABLE_CENTRE: Final = (0.35, 0.0, -0.02)


class World:
    """The world in a physics server of its own; use as a context manager or call ``close``."""

    def __init__(self, config: SceneConfig | None = None, timestep: float = 1.0 / 240.0) -> None:
        self.config = config or SceneConfig()
        self.timestep = timestep
        self.client = pybullet.connect(pybullet.DIRECT)
        self._bodies: dict[str, int] = {}
        self._labels: dict[str, int] = {}
        self.time = 0.0
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=timestep, numSolverIterations=100, physicsClientId=self.client
        )
        pybullet.setGravity(0.0, 0.0, -9.81, physicsClientId=self.client)
        self._table = self._create_table()
        self.robot = pybullet.loadURDF(
            str(URDF_PATH),
            useFixedBase=True,
            flags=pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT,
            physicsClientId=self.client,
        )
        infos = [
            pybullet.getJointInfo(self.robot, index, physicsClientId=self.client)
            for index in range(pybullet.getNumJoints(self.robot, physicsClientId=self.client))
        ]
        by_name = {info[1].decode(): info for info in infos}
        self.joint_indices = [by_name[name][0] for name in JOINTS]
        #: Limits by joint, shape (9,) [rad or m, rad/s or m/s, N·m or N].
        self.lower = np.array([by_name[name][8] for name in JOINTS])
        self.upper = np.array([by_name[name][9] for name in JOINTS])
        self.max_effort = np.array([by_name[name][10] for name in JOINTS])
        self.max_velocity = np.array([by_name[name][11] for name in JOINTS])
        self._couple_fingers()
        self._camera = CameraRenderer(self.client, self.config.camera)
        self._send_home()

    def __enter__(self) -> World:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Disconnects from the physics server; the world cannot be used afterwards."""
        if pybullet.isConnected(self.client):
            pybullet.disconnect(self.client)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the blocks, in the order in which they were put down."""
        return tuple(self._bodies)

    def label(self, name: str) -> int:
        """Instance label of a block in :attr:`Frame.labels`."""
        return self._labels[name]

    def body(self, name: str) -> int:
        """pybullet's body id of a block."""
        return self._bodies[name]

    def reset(self, layout: Stacks, seed: int = 0, settle_time: float = 0.3) -> None:
        """Removes all blocks, builds a layout, sends the arm home and lets everything settle.

        ``seed`` draws the small offsets with which blocks are put down, and the labels.

        Raises:
            LayoutError: if the layout is impossible; the world is then as it was.
        """
        check_layout(layout, self.config.stack_count)
        for body in self._bodies.values():
            pybullet.removeBody(body, physicsClientId=self.client)
        self._bodies.clear()
        self._send_home()
        rng = np.random.default_rng(seed)
        config = self.config
        for stack, base in zip(layout, config.stack_positions):
            for level, name in enumerate(stack):
                offset = rng.uniform(-config.position_jitter, config.position_jitter, 2)
                yaw = rng.uniform(-config.yaw_jitter, config.yaw_jitter)
                height = (level + 0.5) * config.block_size + level * 1e-4
                position = np.add(base, [*offset, height])
                self._bodies[name] = self._create_block(name, position, yaw)
        shuffled = rng.permutation(len(self._bodies)) + 1
        self._labels = {name: int(label) for name, label in zip(self._bodies, shuffled)}
        for _ in range(round(settle_time / self.timestep)):
            self.step()

    def command(
        self, positions: NDArray[np.float64], velocities: NDArray[np.float64] | None = None
    ) -> None:
        """Targets of the joint motors until the next command, shapes (9,), within the limits.

        The motors apply at most the URDF's torques and forces.
        """
        velocities = np.zeros(len(JOINTS)) if velocities is None else velocities
        positions = np.clip(positions, self.lower, self.upper)
        velocities = np.clip(velocities, -self.max_velocity, self.max_velocity)
        pybullet.setJointMotorControlArray(
            self.robot,
            self.joint_indices,
            pybullet.POSITION_CONTROL,
            targetPositions=positions,
            targetVelocities=velocities,
            forces=self.max_effort,
            positionGains=[0.4] * 7 + [0.2] * 2,
            velocityGains=[1.0] * 9,
            physicsClientId=self.client,
        )

    def step(self) -> None:
        """Advances by one time step."""
        pybullet.stepSimulation(physicsClientId=self.client)
        self.time += self.timestep

    def joint_state(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Positions, velocities and efforts in the order of ``JOINTS``, shapes (9,)."""
        states = pybullet.getJointStates(
            self.robot, self.joint_indices, physicsClientId=self.client
        )
        return (
            np.array([state[0] for state in states]),
            np.array([state[1] for state in states]),
            np.array([state[3] for state in states]),
        )

    def block_pose(
        self, name: str
    ) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
        """True position [m] and quaternion (x, y, z, w) of a block in world."""
        position, quaternion = pybullet.getBasePositionAndOrientation(
            self._bodies[name], physicsClientId=self.client
        )
        return tuple(position), tuple(quaternion)

    def push(self, name: str, force_world: tuple[float, float, float]) -> None:
        """Applies a force at a block's centre for the next step [N]: a nudge for tests."""
        position, _ = self.block_pose(name)
        pybullet.applyExternalForce(
            self._bodies[name],
            -1,
            force_world,
            position,
            pybullet.WORLD_FRAME,
            physicsClientId=self.client,
        )

    def render(self) -> Frame:
        """What the camera sees now."""
        return self._camera.render({self._bodies[name]: self._labels[name] for name in self.names})

    def _send_home(self) -> None:
        for index, position in zip(self.joint_indices, HOME):
            pybullet.resetJointState(self.robot, index, position, 0.0, physicsClientId=self.client)
        self.command(np.array(HOME))

    def _create_table(self) -> int:
        collision = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=_TABLE_HALF_EXTENTS, physicsClientId=self.client
        )
        visual = pybullet.createVisualShape(
            pybullet.GEOM_BOX,
            halfExtents=_TABLE_HALF_EXTENTS,
            rgbaColor=(0.78, 0.74, 0.68, 1.0),
            physicsClientId=self.client,
        )
        table = pybullet.createMultiBody(
            0.0, collision, visual, _TABLE_CENTRE, physicsClientId=self.client
        )
        pybullet.changeDynamics(
            table, -1, lateralFriction=0.9, restitution=0.0, physicsClientId=self.client
        )
        return int(table)

    def _create_block(self, name: str, position_world: NDArray[np.float64], yaw: float) -> int:
        color, shape = split_object_name(name)
        half = 0.5 * self.config.block_size
        if shape == CYLINDER:
            kind = pybullet.GEOM_CYLINDER
            collision_size: dict[str, Any] = {"radius": half, "height": 2.0 * half}
            visual_size: dict[str, Any] = {"radius": half, "length": 2.0 * half}
        elif shape == SPHERE:
            kind = pybullet.GEOM_SPHERE
            collision_size = visual_size = {"radius": half}
        else:
            kind = pybullet.GEOM_BOX
            collision_size = visual_size = {"halfExtents": [half] * 3}
        body = pybullet.createMultiBody(
            self.config.block_mass,
            pybullet.createCollisionShape(kind, physicsClientId=self.client, **collision_size),
            pybullet.createVisualShape(
                kind, rgbaColor=(*COLORS[color], 1.0), physicsClientId=self.client, **visual_size
            ),
            position_world,
            pybullet.getQuaternionFromEuler((0.0, 0.0, yaw)),
            physicsClientId=self.client,
        )
        pybullet.changeDynamics(
            body,
            -1,
            lateralFriction=0.9,
            spinningFriction=0.003,
            rollingFriction=1e-4 if shape == SPHERE else 0.0,
            restitution=0.0,
            physicsClientId=self.client,
        )
        return int(body)

    def _couple_fingers(self) -> None:
        """The real hand drives both fingers with one motor; a gear joint does the same here."""
        left, right = self.joint_indices[7:]
        gear = pybullet.createConstraint(
            self.robot,
            left,
            self.robot,
            right,
            pybullet.JOINT_GEAR,
            (1, 0, 0),
            (0, 0, 0),
            (0, 0, 0),
            physicsClientId=self.client,
        )
        pybullet.changeConstraint(
            gear, gearRatio=-1, erp=0.1, maxForce=50, physicsClientId=self.client
        )
        for finger in (left, right):
            pybullet.changeDynamics(
                self.robot,
                finger,
                lateralFriction=1.2,
                spinningFriction=0.01,
                restitution=0.0,
                physicsClientId=self.client,
            )
