# SPDX-License-Identifier: Apache-2.0
"""Something is held in front of the camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import pybullet
from scipy.spatial.transform import Rotation

from ..scene import CameraConfig
from .disturbance import Disturbance, Stage
from .request import DisturbanceError, Request, Vector

DEFAULT_SECONDS: Final = 4.0
HAND: Final = "hand"
SHEET: Final = "sheet"


@dataclass(frozen=True)
class Slab:
    """A box of a thing: centre and half extents in the camera's optical frame [m]."""

    centre: Vector
    half_extents: Vector


#: Below the middle of the picture, where the blocks are [m].
_LOW: Final = 0.05
#: A palm with five fingers, and the forearm that it comes from on the right; z is from its middle.
_HAND: Final = (
    Slab((0.0, _LOW, 0.0), (0.050, 0.045, 0.014)),
    *(Slab((-0.090, _LOW + y, 0.0), (0.040, 0.009, 0.009)) for y in (-0.035, -0.012, 0.012, 0.035)),
    Slab((-0.015, _LOW - 0.070, 0.0), (0.012, 0.030, 0.011)),
    Slab((0.250, _LOW, 0.0), (0.200, 0.032, 0.028)),
)
_SKIN: Final = (0.82, 0.62, 0.50, 1.0)
_PAPER: Final = (0.92, 0.91, 0.88, 1.0)
#: How far from the camera, as a share of the way to what it looks at.
_NEARNESS: Final = 0.45
#: How much larger than the picture a sheet is.
_MARGIN: Final = 1.3


class Cover(Disturbance):
    """A person's hand, or a sheet of paper that hides all: seen, but touching nothing."""

    uses = frozenset({"what", "seconds"})

    def __init__(self, request: Request) -> None:
        self._what = request.what or HAND
        if self._what not in (HAND, SHEET):
            raise DisturbanceError(f"what is {self._what!r}; there are {HAND} and {SHEET}")
        self.seconds = request.seconds or DEFAULT_SECONDS
        self.sentence = f"a {self._what} is in front of the camera for {self.seconds:g} s"
        self._body = -1

    def begin(self, stage: Stage) -> None:
        """Holds it there."""
        client, camera = stage.world.client, stage.world.config.camera
        pose = camera.world_from_optical
        distance = _NEARNESS * float(
            np.linalg.norm(np.subtract(camera.target_world, camera.position_world))
        )
        slabs = _HAND if self._what == HAND else (_sheet(camera, distance),)
        color = _SKIN if self._what == HAND else _PAPER
        looks = pybullet.createVisualShapeArray(
            [pybullet.GEOM_BOX] * len(slabs),
            halfExtents=[slab.half_extents for slab in slabs],
            visualFramePositions=[slab.centre for slab in slabs],
            rgbaColors=[color] * len(slabs),
            physicsClientId=client,
        )
        self._body = pybullet.createMultiBody(
            0.0,
            -1,
            looks,
            pose[:3, 3] + distance * pose[:3, 2],
            Rotation.from_matrix(pose[:3, :3]).as_quat(),
            physicsClientId=client,
        )

    def end(self, stage: Stage) -> None:
        """Takes it away."""
        stage.world.remove_body(self._body)


def _sheet(camera: CameraConfig, distance: float) -> Slab:
    half_height = _MARGIN * distance * float(np.tan(0.5 * camera.vertical_fov))
    return Slab((0.0, 0.0, 0.0), (half_height * camera.width / camera.height, half_height, 0.001))
