# SPDX-License-Identifier: Apache-2.0
"""What the depth of one block's pixels says about it.

What is seen of an upright block from the front is exact across the surface (depth) and known to a
pixel along it (edges of the mask). So faces are measured by depth, and the position of an edge is
kept as the interval between the last pixel that shows the face and the first that does not;
:mod:`perception_node.blocks.pose` joins these intervals for the blocks of a scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A point further than this from a surface is not of it [m].
SURFACE_TOLERANCE: Final = 0.002
#: How far a block's points may be from its surface, at the 80th percentile [m].
FLATNESS: Final = 0.0018
#: Least number of points that make a face.
MIN_FACE_POINTS: Final = 4


@dataclass(frozen=True)
class Interval:
    """What is known of a coordinate [m]: it is between ``low`` and ``high``."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        """Halfway between the two."""
        return 0.5 * (self.low + self.high)


class NoSurfaceError(ValueError):
    """Points that are known, but lie on no block that stands upright."""


@dataclass(frozen=True)
class BlockSurface:
    """What the depth of one block's pixels says about it. Lengths in m, frame world.

    The block's own frame is world turned by ``yaw`` about z: its x axis points out of the front.

    Attributes:
        shape: ``box``, ``cylinder`` or ``sphere``.
        yaw: of the front's normal about world z [rad]; 0 for round shapes.
        front: x of the front face in the block's frame; for round shapes of the nearest point.
        left, right: y of the sides in the block's frame.
        bottom, top: z of the lower and upper end.
        tilt: angle between the front face and the vertical [rad].

    Raises:
        NoSurfaceError: if a value is not finite.
    """

    shape: str
    yaw: float
    front: float
    left: Interval
    right: Interval
    bottom: Interval
    top: Interval
    tilt: float = 0.0

    def __post_init__(self) -> None:
        values = (self.yaw, self.front, self.left.middle, self.right.middle, self.bottom.middle)
        if not np.isfinite([*values, self.top.middle, self.tilt]).all():
            raise NoSurfaceError("its depth does not form the surface of an upright block")


def block_frame(yaw: float) -> Array:
    """R, shape (3, 3): ``points_world @ R`` are coordinates in a frame turned by ``yaw`` [rad]."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
