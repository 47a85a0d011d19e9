# SPDX-License-Identifier: Apache-2.0
"""Somebody bumps into the arm."""

from __future__ import annotations

from typing import Final

import pybullet

from .disturbance import ALONG_Y, Disturbance, Stage, along, unit
from .hand import hand_link
from .request import Request

#: Panda's wrist gives way by some tenths of a radian.
DEFAULT_FORCE: Final = 100.0
DEFAULT_SECONDS: Final = 0.1


class Nudge(Disturbance):
    """A force on the arm's hand, against which its motors hold with the torques they have."""

    uses = frozenset({"force", "direction", "seconds"})

    def __init__(self, request: Request) -> None:
        self._force = request.force or DEFAULT_FORCE
        self._direction = unit(request.direction, ALONG_Y)
        self.seconds = request.seconds or DEFAULT_SECONDS
        self.sentence = (
            f"the arm's hand is pushed with {self._force:g} N {along(self._direction)} for "
            f"{self.seconds:g} s"
        )

    def act(self, stage: Stage) -> None:
        """Pushes at the middle of the hand."""
        world = stage.world
        link = hand_link(world)
        state = pybullet.getLinkState(world.robot, link, physicsClientId=world.client)
        pybullet.applyExternalForce(
            world.robot,
            link,
            [self._force * share for share in self._direction],
            state[0],
            pybullet.WORLD_FRAME,
            physicsClientId=world.client,
        )
