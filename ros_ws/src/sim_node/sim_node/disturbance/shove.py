# SPDX-License-Identifier: Apache-2.0
"""Somebody runs into the table."""

from __future__ import annotations

from typing import Final

import numpy as np
import pybullet

from .disturbance import ALONG_Y, Disturbance, Stage, along, unit
from .request import Request

#: Topples towers of two and more; from 8 m/s² on, single blocks slide.
DEFAULT_ACCELERATION: Final = 6.0
DEFAULT_SECONDS: Final = 0.3


class Shove(Disturbance):
    """The table, with arm and camera on it, is accelerated for half of the time and then stopped.

    All is seen from the table, as the camera on it sees it: there, a block of mass m feels the
    force -m·a of a table that accelerates by a, and friction is all that takes it along. After the
    time t the table stands still again, a·t²/4 away, which nobody on it can see.
    """

    uses = frozenset({"acceleration", "direction", "seconds"})

    def __init__(self, request: Request) -> None:
        self._acceleration = request.acceleration or DEFAULT_ACCELERATION
        self._direction = unit(request.direction, ALONG_Y, horizontal=True)
        self.seconds = request.seconds or DEFAULT_SECONDS
        self._done = 0
        self.sentence = (
            f"the table is shoved with {self._acceleration:g} m/s² {along(self._direction)} and "
            f"stopped again within {self.seconds:g} s"
        )

    def act(self, stage: Stage) -> None:
        """Lets every block feel the table's acceleration."""
        world = stage.world
        sign = -1.0 if self._done * world.timestep < 0.5 * self.seconds else 1.0
        self._done += 1
        felt = sign * self._acceleration * np.array(self._direction)
        for name in world.names:
            body, client = world.body(name), world.client
            mass = pybullet.getDynamicsInfo(body, -1, physicsClientId=client)[0]
            # Where pybullet has a body is its centre of mass.
            centre, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
            pybullet.applyExternalForce(
                body, -1, mass * felt, centre, pybullet.WORLD_FRAME, physicsClientId=client
            )
