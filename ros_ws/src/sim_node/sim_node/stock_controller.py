# SPDX-License-Identifier: Apache-2.0
"""Two controllers, one of the arm and one of its gripper, by the rules of ros2_control's.

Each is what a joint_trajectory_controller with the joints of its group and default parameters
does; see :mod:`sim_node.stock_rules` for what it refuses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .controller import FollowsTrajectories
from .playback import Playback
from .stock_rules import check_stock_rules
from .trajectory import JointLimits, Trajectory, belated, check_jump
from .world import World

Array = NDArray[np.float64]

ARM_TOPIC: Final = "joint_trajectory"
GRIPPER_TOPIC: Final = "gripper_trajectory"


class StockController:
    """Follows trajectories of some of the joints.

    Where a trajectory starts later, the joints go on from their present state to its first point
    by then; one that has started already is joined in its middle. Besides the controller's rules,
    the arm itself refuses what its hardware cannot do: jumps, speeds and positions out of limits.

    Args:
        joints: which; names.
    """

    def __init__(self, world: World, joints: Sequence[str]) -> None:
        self._world, self.joints = world, tuple(joints)
        own = [world.arm.joints.index(name) for name in joints]
        self._own = np.array(own)
        self._limits = JointLimits(
            self.joints, world.lower[own], world.upper[own], world.max_velocity[own]
        )
        self._tolerance = world.arm.start_tolerance[own]
        self._playback: Playback | None = None
        self._hold = world.arm.home_positions[own]

    @property
    def moving(self) -> bool:
        """Whether a trajectory is being followed."""
        return self._playback is not None

    def follow(
        self,
        names: Sequence[str],
        times: Array,
        positions: Array,
        velocities: Array | None,
        begins: int | None = None,
    ) -> Trajectory:
        """Starts a trajectory in place of the running one, by then or at once.

        Args:
            names, times, positions, velocities: as of :class:`Trajectory`.
            begins: the step of the physics that its stamp means; None: it has none.

        Raises:
            TrajectoryError: if it is refused; the running one goes on.
        """
        world, now = self._world, self._world.steps
        lead = 0.0 if begins is None else (begins - now) * world.timestep
        check_stock_rules(names, self.joints, times, velocities, -lead)
        state, speed, _ = world.joint_state()
        state, speed = state[self._own], speed[self._own]
        if lead + times[0] > 0.0:
            order = [self.joints.index(name) for name in names]
            times = np.concatenate([[0.0], times + lead])
            positions = np.vstack([state[order], positions])
            if velocities is not None:
                velocities = np.vstack([speed[order], velocities])
            begins = now
        unheld = np.full(len(self.joints), np.inf)
        trajectory = Trajectory(names, times, positions, velocities, self._limits, state, unheld)
        playback = Playback(trajectory, now if begins is None else begins, world.timestep)
        check_jump(playback.target(now)[0], state, self._tolerance, self.joints, belated(-lead))
        self._playback = playback
        return trajectory

    def stop(self) -> None:
        """A trajectory without points stops nothing.

        Raises:
            TrajectoryError: always, as the controller's rules say.
        """
        check_stock_rules(self.joints, self.joints, np.zeros(0), None, 0.0)

    def reset(self) -> None:
        """Forgets the trajectory and holds home."""
        self._playback, self._hold = None, self._world.arm.home_positions[self._own]

    def target(self) -> tuple[Array, Array]:
        """Positions and velocities that its motors are told now, shapes (n,)."""
        if self._playback is None:
            return self._hold, np.zeros_like(self._hold)
        return self._playback.target(self._world.steps)

    def end_what_is_over(self) -> None:
        """Holds the end of a trajectory that has ended."""
        if self._playback and self._playback.is_over(self._world.steps):
            self._hold = self._playback.trajectory.sample(np.inf)[0]
            self._playback = None


class TwoControllers:
    """One controller of the arm's joints and one of the fingers'."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.arm = StockController(world, world.arm.arm_joints)
        self.gripper = StockController(world, world.arm.finger_joints)

    @property
    def topics(self) -> dict[str, FollowsTrajectories]:
        """The controllers by the topics that command them."""
        return {ARM_TOPIC: self.arm, GRIPPER_TOPIC: self.gripper}

    def update(self) -> None:
        """Commands the motors for the next physics step."""
        self._world.command(*self.target())
        self.arm.end_what_is_over()
        self.gripper.end_what_is_over()

    def target(self) -> tuple[Array, Array]:
        """Positions and velocities that the motors are told now, shapes (n,)."""
        (arm, arm_rate), (fingers, finger_rate) = self.arm.target(), self.gripper.target()
        return np.concatenate([arm, fingers]), np.concatenate([arm_rate, finger_rate])

    def reset(self) -> None:
        """Forgets all trajectories and holds home, where the world's reset has put the arm."""
        self.arm.reset()
        self.gripper.reset()
