# SPDX-License-Identifier: Apache-2.0
"""The simulated world: a table, blocks under gravity, and an arm with its gripper.

Nothing holds a block but contact and friction: there are no constraints between bodies, no
teleports after a reset, and gravity is always on.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pybullet
from numpy.typing import NDArray

from scene_graph import Stacks, rotation_from_quaternion

from .bodies import couple_fingers, create_block, create_obstacle, create_table
from .camera import CameraRenderer
from .frame import Frame
from .layouts import check_layout
from .meshes.light_urdf import light_urdf
from .penetration import check_arm_is_free, check_obstacles_are_free
from .scene import Block, SceneConfig, SceneError
from .scene.cameras import Vector
from .scene.config import check_scene
from .simulated_arms import PANDA, SimulatedArm, arm_of_scene


class World:
    """The world in a physics server of its own; use as a context manager or call ``close``.

    Attributes:
        config: what stands where.
        arm: which arm it is; arrays over its n joints are in the order of ``arm.joints``.
        timestep: of the physics [s].
        steps: of the physics since the world was made.
        seed: of the present scene; ``config.blocks.block(name, seed)`` is what a block is like.
        client, robot, table: pybullet's ids of the physics server and of two of its bodies.
        obstacles: those of what stands around and is no block, by name.
        joint_indices: pybullet's numbers of the arm's joints, n of them.
        lower, upper, max_effort, max_velocity: limits of the joints by the URDF, shape (n,) [rad
            or m; N·m or N; rad/s or m/s].

    Raises:
        OSError: if the arm's meshes cannot be read, or their light copies not be written.
        SceneError: if the arm cannot rest where the scene says, or something lies inside of it.
    """

    def __init__(
        self,
        config: SceneConfig | None = None,
        timestep: float = 1.0 / 240.0,
        arm: SimulatedArm = PANDA,
    ) -> None:
        self.config = config or SceneConfig()
        self.arm = arm = arm_of_scene(self.config.arm, arm)
        self.timestep = timestep
        self.client = pybullet.connect(pybullet.DIRECT)
        self.steps = self.seed = 0
        self._urdf = str(light_urdf(arm.urdf))
        self._build()
        self._check_scene()

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

    def block(self, name: str) -> Block:
        """What a block is like."""
        return self._blocks[name]

    def reset(self, layout: Stacks, seed: int = 0, settle_time: float = 0.3) -> None:
        """Builds the world anew with a layout and the arm at home, and lets everything settle.

        What was before leaves no trace: the same layout, seed and commands give the same physics
        bit by bit. ``seed`` draws the small offsets with which blocks are put down, the labels,
        and what the scene leaves open of the blocks.

        Raises:
            LayoutError: if the layout is impossible; the world is then as it was.
        """
        config = self.config
        check_layout(layout, config.stack_count, config.blocks, seed)
        self._build()
        self.seed = seed
        rng = np.random.default_rng(seed)
        for stack, base in zip(layout, config.stack_positions):
            below: list[float] = []
            for level, name in enumerate(stack):
                block = config.blocks.block(name, seed)
                offset = rng.uniform(-config.position_jitter, config.position_jitter, 2)
                yaw = rng.uniform(-config.yaw_jitter, config.yaw_jitter)
                # Exactly rounded, so that equal blocks stand at the same multiples of their size.
                height = math.fsum([*below, 0.5 * block.size[2]]) + level * 1e-4
                position = np.add(base, [*offset, height])
                self._bodies[name] = create_block(self.client, block, position, yaw)
                self._blocks[name] = block
                below.append(block.size[2])
        shuffled = rng.permutation(len(self._bodies)) + 1
        self._labels |= {name: int(label) for name, label in zip(self._bodies, shuffled)}
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
        """True position [m] and quaternion (x, y, z, w) of a block in world.

        The position is the middle of its extents, which is not the centre of mass of a prism.
        """
        position, quaternion = pybullet.getBasePositionAndOrientation(
            self._bodies[name], physicsClientId=self.client
        )
        if above := self._blocks[name].centre_above_body:
            up = rotation_from_quaternion(quaternion)[:, 2]
            position = np.add(position, above * up).tolist()
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

    def add_block(self, block: Block, position_world: NDArray[np.float64]) -> None:
        """Puts one more block down, as :meth:`reset` does; its label is the lowest free one."""
        name = block.name
        self._bodies[name] = create_block(self.client, block, position_world, 0.0)
        self._blocks[name] = block
        taken = set(self._labels.values())
        self._labels[name] = next(label for label in itertools.count(1) if label not in taken)

    def move_block(
        self,
        name: str,
        position_world: tuple[float, float, float],
        quaternion: tuple[float, float, float, float],
    ) -> None:
        """Puts a block elsewhere, at rest; the pose is as :meth:`block_pose` gives it."""
        up = rotation_from_quaternion(quaternion)[:, 2]
        body, below = self._bodies[name], self._blocks[name].centre_above_body * up
        pybullet.resetBasePositionAndOrientation(
            body, np.subtract(position_world, below), quaternion, physicsClientId=self.client
        )
        pybullet.resetBaseVelocity(body, (0.0,) * 3, (0.0,) * 3, physicsClientId=self.client)

    def remove_block(self, name: str) -> None:
        """Takes a block away."""
        del self._labels[name], self._blocks[name]
        self.remove_body(self._bodies.pop(name))

    def remove_body(self, body: int) -> None:
        """Takes a body away; the next one may get its number, so the cameras forget its looks."""
        pybullet.removeBody(body, physicsClientId=self.client)
        for camera in self._cameras:
            camera.forget(body)

    def move_camera(self, number: int, position: Vector, target: Vector) -> None:
        """Puts one of the scene's cameras elsewhere, upright, and has it look at a target [m].

        Raises:
            SceneError: if it cannot be there, or sees none of the places; it is then where it was.
        """
        cameras = list(self.config.cameras)
        cameras[number] = replace(cameras[number], position_world=position, target_world=target)
        config = replace(self.config, cameras=tuple(cameras))
        check_scene(config)
        self.config = config
        self._cameras[number].move(cameras[number])

    def render(self, camera: int = 0) -> Frame:
        """What one of the scene's cameras sees now, by its number."""
        labels = {self._bodies[name]: self._labels[name] for name in self.names}
        return self._cameras[camera].render(labels)

    def _build(self) -> None:
        """Table, camera and arm, and no blocks, in an empty physics server."""
        arm = self.arm
        pybullet.resetSimulation(physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=self.timestep, numSolverIterations=100, physicsClientId=self.client
        )
        pybullet.setGravity(0.0, 0.0, -9.81, physicsClientId=self.client)
        self.table = create_table(self.client)
        self.obstacles: dict[str, int] = {}
        self._create_obstacles(lie_still=True)
        self._cameras = tuple(
            CameraRenderer(self.client, camera, self.config.light) for camera in self.config.cameras
        )
        self._bodies: dict[str, int] = {}
        self._blocks: dict[str, Block] = {}
        self._labels: dict[str, int] = {}
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
        couple_fingers(self.client, self.robot, *(by_name[name][0] for name in arm.finger_joints))
        self._send_home()
        self._create_obstacles(lie_still=False)

    def _create_obstacles(self, lie_still: bool) -> None:
        for item in self.config.obstacles:
            if item.lies_still == lie_still:
                self.obstacles[item.name] = create_obstacle(self.client, item)

    def _check_scene(self) -> None:
        """Raises SceneError for what only the bodies show of a scene."""
        home = self.arm.home_positions
        for name, low, position, high in zip(self.arm.joints, self.lower, home, self.upper):
            if not low - 1e-6 <= position <= high + 1e-6:
                raise SceneError(
                    "arm.home",
                    f"has {name} at {position:g}; {low:g} to {high:g} are possible",
                )
        if self.config.arm.home:
            check_arm_is_free(self.client, self.robot, self.table)
        check_obstacles_are_free(self.client, self.config, self.robot, self.obstacles)

    def _send_home(self) -> None:
        home = self.arm.home_positions
        for index, position in zip(self.joint_indices, home):
            pybullet.resetJointState(self.robot, index, position, 0.0, physicsClientId=self.client)
        self.command(home)
