# SPDX-License-Identifier: Apache-2.0
"""A recording's scene in MuJoCo, with what a controller needs of ``sim_node.World``."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim_node.simulated_arms import SIMULATED_ARMS

from .arm_links import Link
from .model import CONTROL_STEP, FINGER_DRIVE, SUBSTEPS, mjcf
from .recording import Recording

Array = NDArray[np.float64]

#: Natural frequency of the arm's joints about their targets [1/s]: an error is gone in about
#: 10 ms, as with pybullet's motors (gain 0.4 a step of 1/240 s: 96/s).
_ARM_FREQUENCY = 100.0
#: Stiffness of a finger's drive [N/m]: full force from 4 mm of error on, where a block is pressed
#: with 10 mm; damped critically with finger and drive.
_FINGER_STIFFNESS = 5000.0


class MujocoWorld:
    """Arm and blocks as a recording found them.

    The arm's motors are a computed-torque controller within the URDF's torques: what a joint
    position controller with gravity compensation comes to; it knows nothing of what is held.

    Attributes:
        arm, lower, upper, max_effort, max_velocity, timestep, steps: as in :class:`sim_node.World`.
        names: of the blocks.
    """

    def __init__(self, recording: Recording, links: Sequence[Link], max_velocity: Array) -> None:
        self.arm = SIMULATED_ARMS[recording.robot]
        self.timestep = CONTROL_STEP
        self.steps = 0
        self.names = tuple(body.name for body in recording.blocks)
        text = mjcf(links, recording.bodies, self.arm.finger_joints)
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        by_joint = {link.joint: link for link in links if link.joint}
        moving = [by_joint[name] for name in self.arm.joints]
        self.lower = np.array([link.lower for link in moving])
        self.upper = np.array([link.upper for link in moving])
        self.max_effort = np.array([link.effort for link in moving])
        self.max_velocity = max_velocity
        joints = [self.model.joint(name) for name in self.arm.joints]
        self._q = np.array([joint.qposadr[0] for joint in joints])
        self._v = np.array([joint.dofadr[0] for joint in joints])
        self._motors = np.array([self.model.actuator(name).id for name in self.arm.joints])
        self._poses = np.array([self.model.joint(f"body:{name}").qposadr[0] for name in self.names])
        self._is_finger = np.isin(self.arm.joints, self.arm.finger_joints)
        self.data.qpos[self._q] = recording.start
        self._target, self._rate = recording.start.copy(), np.zeros(len(self._q))
        mujoco.mj_forward(self.model, self.data)
        mass = np.array([by_joint[name].mass + FINGER_DRIVE for name in self.arm.finger_joints])
        self._finger_damping = 2.0 * np.sqrt(_FINGER_STIFFNESS * mass)

    def limit_fingers(self, force: float) -> None:
        """From now on each finger presses with so much at most [N]."""
        self.max_effort = np.where(self._is_finger, force, self.max_effort)

    def command(self, positions: Array, velocities: Array | None = None) -> None:
        """Targets of the joints until the next command, shapes (n,), within the limits."""
        velocities = np.zeros_like(positions) if velocities is None else velocities
        self._target = np.clip(positions, self.lower, self.upper)
        self._rate = np.clip(velocities, -self.max_velocity, self.max_velocity)

    def step(self) -> None:
        """Advances by one time step of the controller."""
        for _ in range(SUBSTEPS):
            self._drive()
            mujoco.mj_step(self.model, self.data)
        self.steps += 1

    def joint_state(self) -> tuple[Array, Array, Array]:
        """Positions, velocities and efforts of the joints, shapes (n,)."""
        data = self.data
        return data.qpos[self._q].copy(), data.qvel[self._v].copy(), data.ctrl[self._motors].copy()

    def poses(self) -> Array:
        """Of the blocks, shape (b, 7): position [m] and quaternion (x, y, z, w) in world."""
        found = np.array([self.data.qpos[at : at + 7] for at in self._poses])
        return found[:, [0, 1, 2, 4, 5, 6, 3]]

    def _drive(self) -> None:
        """Motor torques for the next step of the physics.

        Arm: M (ω² e + 2 ω ė) + bias; finger: k e + d ė.
        """
        data, arm = self.data, ~self._is_finger
        error = self._target - data.qpos[self._q]
        rate = self._rate - data.qvel[self._v]
        wanted, inertial = np.zeros(self.model.nv), np.zeros(self.model.nv)
        wanted[self._v[arm]] = _ARM_FREQUENCY**2 * error[arm] + 2.0 * _ARM_FREQUENCY * rate[arm]
        mujoco.mj_mulM(self.model, data, inertial, wanted)
        effort = np.empty_like(error)
        effort[arm] = (inertial + data.qfrc_bias)[self._v[arm]]
        effort[~arm] = _FINGER_STIFFNESS * error[~arm] + self._finger_damping * rate[~arm]
        data.ctrl[self._motors] = np.clip(effort, -self.max_effort, self.max_effort)
