# SPDX-License-Identifier: Apache-2.0
"""The simulated world: a table, blocks under gravity, and an arm with its gripper.

Nothing holds a block but contact and friction: there are no constraints between bodies, no
teleports after a reset, and gravity is always on.
"""

from __future__ import annotations

import itertools

import numpy as np
import pybullet
from numpy.typing import NDArray

from scene_graph import Stacks

from .bodies import create_block, create_table
from .camera import CameraRenderer, Frame
from .layouts import check_layout
from .meshes.light_urdf import light_urdf
from .scene import SceneConfig
from .simulated_arms import PANDA, SimulatedArm


class World:
    """The world in a physics server of its own; use as a context manager or call ``close``.

    Attributes:
        config: what stands where.
        arm: which arm it is; arrays over its n joints are in the order of ``arm.joints``.
        timestep: of the physics [s].
        steps: of the physics since the world was made.
        client, robot: pybullet's ids of the physics server and of the arm's body.
        joint_indices: pybullet's numbers of the arm's joints, n of them.
        lower, upper, max_effort, max_velocity: limits of the joints by the URDF, shape (n,) [rad
            or m; N·m or N; rad/s or m/s].

    Raises:
        OSError: if the arm's meshes cannot be read, or their light copies not be written.
    """

    def __init__(
        self,
        config: SceneConfig | None = None,
        timestep: float = 1.0 / 240.0,
        arm: SimulatedArm = PANDA,
    ) -> None:
        self.config = config or SceneConfig()
        self.arm = arm
        self.timestep = timestep
        self.client = pybullet.connect(pybullet.DIRECT)
        self.steps = 0
        self._urdf = str(light_urdf(arm.urdf))
        self._build()

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def close(self) -> None:
        """Disconnects from the physics server; the world cannot be used afterwards."""
        if pybullet.isConnected(self.client):
            pybullet.disconnect(self.client)

    @property
    def time(self) -> float:
        """Simulated time since the world was made [s]."""
        return self.steps * self.timestep

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
        """Builds the world anew with a layout and the arm at home, and lets everything settle.

        What was before leaves no trace: the same layout, seed and commands give the same physics
        bit by bit. ``seed`` draws the small offsets with which blocks are put down, and the labels.

        Raises:
            LayoutError: if the layout is impossible; the world is then as it was.
        """
        check_layout(layout, self.config.stack_count)
        self._build()
        rng = np.random.default_rng(seed)
        config = self.config
        for stack, base in zip(layout, config.stack_positions):
            for level, name in enumerate(stack):
                offset = rng.uniform(-config.position_jitter, config.position_jitter, 2)
                yaw = rng.uniform(-config.yaw_jitter, config.yaw_jitter)
                height = (level + 0.5) * config.block_size + level * 1e-4
                position = np.add(base, [*offset, height])
                self._bodies[name] = create_block(self.client, name, config, position, yaw)
        shuffled = rng.permutation(len(self._bodies)) + 1
        self._labels = {name: int(label) for name, label in zip(self._bodies, shuffled)}
        for _ in range(round(settle_time / self.timestep)):
            self.step()

    def command(
        self, positions: NDArray[np.float64], velocities: NDArray[np.float64] | None = None
    ) -> None:
        """Targets of the joint motors until the next command, shapes (n,), within the limits.

        The motors apply at most the URDF's torques and forces.
        """
        velocities = np.zeros_like(positions) if velocities is None else velocities
        positions = np.clip(positions, self.lower, self.upper)
        velocities = np.clip(velocities, -self.max_velocity, self.max_velocity)
        pybullet.setJointMotorControlArray(
            self.robot,
            self.joint_indices,
            pybullet.POSITION_CONTROL,
            targetPositions=positions,
            targetVelocities=velocities,
            forces=self.max_effort,
            positionGains=self._gains,
            velocityGains=self._velocity_gains,
            physicsClientId=self.client,
        )

    def step(self) -> None:
        """Advances by one time step."""
        pybullet.stepSimulation(physicsClientId=self.client)
        self.steps += 1

    def joint_state(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Positions, velocities and efforts of the joints, shapes (n,)."""
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

    def add_block(self, name: str, position_world: NDArray[np.float64], yaw: float = 0.0) -> None:
        """Puts one more block down, as :meth:`reset` does; its label is the lowest free one."""
        self._bodies[name] = create_block(self.client, name, self.config, position_world, yaw)
        taken = set(self._labels.values())
        self._labels[name] = next(label for label in itertools.count(1) if label not in taken)

    def remove_block(self, name: str) -> None:
        """Takes a block away."""
        del self._labels[name]
        self.remove_body(self._bodies.pop(name))

    def remove_body(self, body: int) -> None:
        """Takes a body away; the next one may get its number, so the camera forgets its looks."""
        pybullet.removeBody(body, physicsClientId=self.client)
        self._camera.forget(body)

    def render(self) -> Frame:
        """What the camera sees now."""
        return self._camera.render({self._bodies[name]: self._labels[name] for name in self.names})

    def _build(self) -> None:
        """Table, camera and arm, and no blocks, in an empty physics server."""
        arm = self.arm
        pybullet.resetSimulation(physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=self.timestep, numSolverIterations=100, physicsClientId=self.client
        )
        pybullet.setGravity(0.0, 0.0, -9.81, physicsClientId=self.client)
        create_table(self.client)
        self._camera = CameraRenderer(self.client, self.config.camera)
        self._bodies: dict[str, int] = {}
        self._labels = {}
        self.robot = pybullet.loadURDF(
            self._urdf,
            useFixedBase=True,
            flags=pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT,
            physicsClientId=self.client,
        )
        infos = [
            pybullet.getJointInfo(self.robot, index, physicsClientId=self.client)
            for index in range(pybullet.getNumJoints(self.robot, physicsClientId=self.client))
        ]
        by_name = {info[1].decode(): info for info in infos}
        joints = [by_name[name] for name in arm.joints]
        self.joint_indices = [info[0] for info in joints]
        self.lower, self.upper, self.max_effort, self.max_velocity = (
            np.array([info[column] for info in joints]) for column in range(8, 12)
        )
        self._gains, self._velocity_gains = arm.gains, np.ones(len(joints))
        self._couple_fingers(*(by_name[name][0] for name in arm.finger_joints))
        self._send_home()

    def _send_home(self) -> None:
        home = self.arm.home_positions
        for index, position in zip(self.joint_indices, home):
            pybullet.resetJointState(self.robot, index, position, 0.0, physicsClientId=self.client)
        self.command(home)

    def _couple_fingers(self, left: int, right: int) -> None:
        """The real hand drives both fingers with one motor; a gear joint does the same here."""
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
