# SPDX-License-Identifier: Apache-2.0
"""The arm of a simulated world, whatever commands its motors, as the executive hears it."""

from __future__ import annotations

import numpy as np

from motion_node.execution.arm_state import ArmState, ArmStateBox
from motion_node.robots import PANDA
from motion_node.robots.joints import JointValues
from sim_node.controller import CommandsMotors
from sim_node.world import World


class PhysicalArm:
    """Whoever waits for its state makes the world's time go on."""

    closed, problem = False, ""

    def __init__(self, world: World, motors: CommandsMotors) -> None:
        self._world, self._motors = world, motors
        self._box = ArmStateBox(self.now)
        self._put()

    def now(self) -> float:
        return float(self._world.time)

    def newest(self) -> ArmState | None:
        return self._box.newest()

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        for _ in range(4):
            self._motors.update()
            self._world.step()
        self._put()
        return self._box.wait(after, timeout)

    def observe(self, fingers: np.ndarray) -> None:
        """Is told where the fingers are before anybody else hears of it [m]."""

    def _put(self) -> None:
        joints = np.split(self._world.joint_state()[0], [len(PANDA.arm_joints)])
        self.observe(joints[1])
        self._box.put(self._world.time, JointValues(*joints))
