# SPDX-License-Identifier: Apache-2.0
"""Follows joint trajectories in simulated time, like ros2_control's joint_trajectory_controller."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .trajectory import JointLimits, Trajectory, TrajectoryError
from .world import World

#: A trajectory is sampled for so many steps at once: one step alone costs 30 times its share.
_AHEAD: Final = 60


class ArmController:
    """Sends the sampled trajectory to the world's motors, one command a physics step."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.limits = JointLimits(world.arm.joints, world.lower, world.upper, world.max_velocity)
        self._trajectory: Trajectory | None = None
        self._begins = 0
        # For the steps from the first one, counted from the trajectory's beginning.
        self._targets: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        self._first_target = 0
        self._hold = self._world.arm.home_positions

    @property
    def moving(self) -> bool:
        """Whether a trajectory is being followed."""
        return self._trajectory is not None

    def follow(
        self,
        names: Sequence[str],
        times: NDArray[np.float64],
        positions: NDArray[np.float64],
        velocities: NDArray[np.float64] | None,
        begins: int | None = None,
    ) -> Trajectory:
        """Starts a trajectory in place of the running one; see :class:`Trajectory`.

        Args:
            begins: the step of the physics at which it starts; the arm holds still until then.
                None: now.

        Raises:
            TrajectoryError: if it is refused; the running one goes on.
        """
        start, _, _ = self._world.joint_state()
        trajectory = Trajectory(
            names, times, positions, velocities, self.limits, start, self._world.arm.start_tolerance
        )
        now = self._world.steps
        if begins is not None and begins < now:
            late = (now - begins) * self._world.timestep
            raise TrajectoryError(f"it was to start {late:.3g} s ago")
        if begins is not None and begins > now:
            self._hold_still()
        self._trajectory, self._begins = trajectory, now if begins is None else begins
        self._targets, self._first_target = [], 0
        return trajectory

    def stop(self) -> None:
        """Holds the present position of the arm; the fingers keep their target."""
        self._hold_still()
        self._trajectory = None

    def reset(self) -> None:
        """Forgets the trajectory and holds home, where the world's reset has put the arm."""
        self._trajectory, self._hold = None, self._world.arm.home_positions

    def update(self) -> None:
        """Commands the motors for the next physics step."""
        self._world.command(*self.target())
        if self._trajectory and self._elapsed > self._trajectory.duration:
            self._hold = self._trajectory.sample(np.inf)[0]
            self._trajectory = None

    def target(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities that the motors are told now, shapes (n,)."""
        if self._trajectory is None or self._elapsed < 0.0:
            return self._hold, np.zeros_like(self._hold)
        step = self._world.steps - self._begins
        if not 0 <= step - self._first_target < len(self._targets):
            self._first_target = step
            times = np.arange(step, step + _AHEAD, dtype=np.float64) * self._world.timestep
            self._targets = list(zip(*self._trajectory.samples(times)))
        return self._targets[step - self._first_target]

    @property
    def _elapsed(self) -> float:
        """Since the trajectory's start [s]; of whole steps, so that it is the same every time."""
        return (self._world.steps - self._begins) * self._world.timestep

    def _hold_still(self) -> None:
        """Holds what an arm that moves has reached; one that rests keeps its target."""
        if self._trajectory is None:
            return
        positions, _, _ = self._world.joint_state()
        arm = self._world.arm
        is_finger = np.isin(arm.joints, arm.finger_joints)
        self._hold = np.where(is_finger, self.target()[0], positions)
