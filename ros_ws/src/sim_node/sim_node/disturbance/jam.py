# SPDX-License-Identifier: Apache-2.0
"""The gripper jams."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from .disturbance import Disturbance, Stage
from .request import Request

DEFAULT_SECONDS: Final = 3.0


class Jam(Disturbance):
    """For a while the fingers' motors keep the command of the beginning, whatever comes after it.

    Open fingers stay open, and those that hold something go on squeezing it.
    """

    uses = frozenset({"seconds"})
    alone = True

    def __init__(self, request: Request) -> None:
        self.seconds = request.seconds or DEFAULT_SECONDS
        self.sentence = f"the gripper jams: the fingers follow no command for {self.seconds:g} s"
        self._kept: NDArray[np.float64] | None = None

    def begin(self, stage: Stage) -> None:
        """Keeps the command of now."""
        self._kept = stage.arm.target()[0]

    def act(self, stage: Stage) -> None:
        """Commands it again in place of the arm's own; only for the fingers."""
        assert self._kept is not None
        arm = stage.world.arm
        is_finger = np.isin(arm.joints, arm.finger_joints)
        positions, velocities = stage.arm.target()
        stage.world.command(
            np.where(is_finger, self._kept, positions), np.where(is_finger, 0.0, velocities)
        )
