# SPDX-License-Identifier: Apache-2.0
"""Values of an arm's joints and of its gripper's, kept apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointValues:
    """Positions, or velocities, of all joints, at one moment or at many.

    Attributes:
        arm: of the arm's joints in the order of q, shape (..., n) [rad; per s].
        fingers: of the two fingers, shape (..., 2) [m; per s].
    """

    arm: Array
    fingers: Array

    def __getitem__(self, index: Any) -> JointValues:
        """The values at an index into the leading axes, as NumPy understands it."""
        return JointValues(self.arm[index], self.fingers[index])

    def joined(self) -> Array:
        """All values as :attr:`Arm.joint_names` names them, shape (..., n + 2), for messages."""
        return np.concatenate([self.arm, self.fingers], axis=-1)

    def furthest(self, other: JointValues) -> tuple[Array, Array]:
        """Largest distances of arm joints and of fingers to another's, shapes (...,) [rad, m]."""
        arm = np.abs(self.arm - other.arm).max(axis=-1)
        fingers = np.abs(self.fingers - other.fingers).max(axis=-1)
        return np.asarray(arm), np.asarray(fingers)
