# SPDX-License-Identifier: Apache-2.0
"""Follows joint trajectories in simulated time, like ros2_control's joint_trajectory_controller."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .playback import Playback
from .trajectory import JointLimits, Trajectory, TrajectoryError, belated, check_jump
from .world import World


class FollowsTrajectories(Protocol):
    """A controller as the topic that commands it sees it."""

    def follow(
        self,
        names: Sequence[str],
        times: NDArray[np.float64],
        positions: NDArray[np.float64],
        velocities: NDArray[np.float64] | None,
        begins: int | None = None,
    ) -> Trajectory:
        """Starts a trajectory in place of the running one; raises TrajectoryError if refused."""

    def stop(self) -> None:
        """What a trajectory without points asks for; raises TrajectoryError if refused."""


class CommandsMotors(Protocol):
    """What commands all motors of an arm and its gripper, be it one controller or several."""

    @property
    def topics(self) -> dict[str, FollowsTrajectories]:
        """The controllers by the topics that command them."""

    def update(self) -> None:
        """Commands the motors for the next physics step."""

    def target(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities that the motors are told now, shapes (n,)."""

    def reset(self) -> None:
        """Forgets all trajectories and holds home, where the world's reset has put the arm."""


class ArmController:
    """Sends the sampled trajectory to the world's motors, one command a physics step.

    One controller of all joints, the fingers included, and of this project's own rules: one
    without points stops the arm. A belated trajectory is taken up where it should be by now.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self.limits = JointLimits(world.arm.joints, world.lower, world.upper, world.max_velocity)
        self._playback: Playback | None = None
        self._hold = self._world.arm.home_positions

    @property
    def topics(self) -> dict[str, FollowsTrajectories]:
        """See :class:`CommandsMotors`."""
        return {"joint_trajectory": self}

    @property
    def moving(self) -> bool:
        """Whether a trajectory is being followed."""
        return self._playback is not None

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
                One that has passed: it is taken up in its midst. None: now.

        Raises:
            TrajectoryError: if it is refused; the running one goes on.
        """
        state, _, _ = self._world.joint_state()
        now, tolerance = self._world.steps, self._world.arm.start_tolerance
        begins = now if begins is None else begins
        late = (now - begins) * self._world.timestep
        first = tolerance if late <= 0.0 else np.full(len(tolerance), np.inf)
        trajectory = Trajectory(names, times, positions, velocities, self.limits, state, first)
        playback = Playback(trajectory, begins, self._world.timestep)
        if late > 0.0:
            if late > trajectory.duration:
                raise TrajectoryError(f"it ended {late - trajectory.duration:.3g} s ago")
            check_jump(playback.target(now)[0], state, tolerance, self.limits.names, belated(late))
        if begins > now:
            self._hold_still()
        self._playback = playback
        return trajectory

    def stop(self) -> None:
        """Holds the present position of the arm; the fingers keep their target."""
        self._hold_still()
        self._playback = None

    def reset(self) -> None:
        """Forgets the trajectory and holds home, where the world's reset has put the arm."""
        self._playback, self._hold = None, self._world.arm.home_positions

    def update(self) -> None:
        """Commands the motors for the next physics step."""
        self._world.command(*self.target())
        if self._playback and self._playback.is_over(self._world.steps):
            self._hold = self._playback.trajectory.sample(np.inf)[0]
            self._playback = None

    def target(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities that the motors are told now, shapes (n,)."""
        step = self._world.steps
        if self._playback is None or self._playback.elapsed(step) < 0.0:
            return self._hold, np.zeros_like(self._hold)
        return self._playback.target(step)

    def _hold_still(self) -> None:
        """Holds what an arm that moves has reached; one that rests keeps its target."""
        if self._playback is None:
            return
        positions, _, _ = self._world.joint_state()
        arm = self._world.arm
        is_finger = np.isin(arm.joints, arm.finger_joints)
        self._hold = np.where(is_finger, self.target()[0], positions)
