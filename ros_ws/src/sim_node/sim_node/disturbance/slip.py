# SPDX-License-Identifier: Apache-2.0
"""The block in the hand slips out of it."""

from __future__ import annotations

from typing import Final

import pybullet

from ..world import World
from .disturbance import Disturbance, Stage, block_in_hand
from .hand import finger_links
from .request import RELEASE, DisturbanceError, Request

DEFAULT_SECONDS: Final = 0.5


class Slip(Disturbance):
    """For a while the fingers have no friction, as if they were oily; gravity does the rest.

    Fingers whose URDF asks for friction anchors are without them meanwhile: an anchor keeps a
    contact with the friction that it began with.
    """

    uses = frozenset({"seconds"})
    alone = True

    def __init__(self, request: Request) -> None:
        if request.when == RELEASE:
            raise DisturbanceError(
                "nothing can slip at a release, when the hand has become empty; take grasp or "
                "in_air"
            )
        self.seconds = request.seconds or DEFAULT_SECONDS
        self._before: dict[int, float] = {}
        self._anchored = False
        self._describe("the block in the hand")

    def begin(self, stage: Stage) -> None:
        """Takes the fingers' friction away."""
        self._describe(block_in_hand(stage))
        world = stage.world
        self._anchored = "friction_anchor" in world.arm.urdf.read_text(encoding="utf-8")
        for link in finger_links(world):
            info = pybullet.getDynamicsInfo(world.robot, link, physicsClientId=world.client)
            self._before[link] = info[1]
            _set_friction(world, link, 0.0, anchored=False)

    def end(self, stage: Stage) -> None:
        """Gives it back."""
        for link, friction in self._before.items():
            _set_friction(stage.world, link, friction, self._anchored)

    def _describe(self, block: str) -> None:
        self.sentence = f"{block} slips: the fingers have no friction for {self.seconds:g} s"


def _set_friction(world: World, link: int, friction: float, anchored: bool) -> None:
    pybullet.changeDynamics(
        world.robot,
        link,
        lateralFriction=friction,
        frictionAnchor=int(anchored),
        physicsClientId=world.client,
    )
