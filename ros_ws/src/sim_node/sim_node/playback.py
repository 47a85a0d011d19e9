# SPDX-License-Identifier: Apache-2.0
"""A trajectory under way: what the motors are told at each step of the physics."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from .trajectory import Trajectory

#: A trajectory is sampled for so many steps at once: one step alone costs 30 times its share.
_AHEAD: Final = 60


class Playback:
    """Samples a trajectory step by step.

    Args:
        trajectory: what is followed.
        begins: the step of the physics at which it starts; may have passed.
        timestep: of the physics [s].
    """

    def __init__(self, trajectory: Trajectory, begins: int, timestep: float) -> None:
        self.trajectory, self._begins, self._timestep = trajectory, begins, timestep
        # For the steps from the first one, counted from the trajectory's beginning.
        self._targets: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        self._first_target = 0

    def elapsed(self, step: int) -> float:
        """Since the trajectory's start [s]; of whole steps, so that it is the same every time."""
        return (step - self._begins) * self._timestep

    def is_over(self, step: int) -> bool:
        """Whether the trajectory has ended by then."""
        return self.elapsed(step) > self.trajectory.duration

    def target(self, step: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities that the motors are told then, shapes (n,)."""
        own = step - self._begins
        if not 0 <= own - self._first_target < len(self._targets):
            self._first_target = own
            times = np.arange(own, own + _AHEAD, dtype=np.float64) * self._timestep
            self._targets = list(zip(*self.trajectory.samples(times)))
        return self._targets[own - self._first_target]
