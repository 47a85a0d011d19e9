# SPDX-License-Identifier: Apache-2.0
"""Whether a picture shows the arm where its joints say that it is.

What is nearer than the arm hides it, and where depth is not known nothing is: neither contradicts
it. Two things do:

- The picture shows it where only a mirrored camera would. Of each pixel (u, v) at which the arm's
  surface has the depth z, the picture's depth is compared with z there and at (width - 1 - u, v).
  Pixels at which only one of the two agrees tell one from the other, as pairs do in McNemar's test;
  those of an arm that is its own mirror image tell nothing.
- One sees through most of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from ..camera import PinholeCamera
from ..errors import BadImageError, with_topics_of
from ..observation import MAX_DEPTH, Observation
from .shape import ArmShape, SeenArm

#: Depth within this is that of the arm: its shapes may be boxes around what it looks like [m].
TOLERANCE: Final = 0.05
#: One sees through it where depth is further by this: cameras may err by some hundredths [m].
_THROUGH: Final = 0.1
#: What is narrower than this is the edge of something [px of the grid].
_SPOT: Final = np.ones((3, 3), np.uint8)
#: Fewer pixels than these are no evidence that the picture is mirrored, and neither is a smaller
#: share of those at which a mirrored camera would see the arm.
_MIRRORED_LEAST: Final = 24
_MIRRORED_SHARE: Final = 0.01
#: So large a share of the mirrored arm has to be seen where nothing is before it.
_MIRRORED_WHOLE: Final = 0.6
#: So many times as many pixels have to say so as say that it is not.
_MIRRORED_RATIO: Final = 6
#: So many pixels have to be known, and through so large a share of them one has to see.
_THROUGH_LEAST: Final = 400
_THROUGH_SHARE: Final = 0.75
#: Joints that differ by less leave the arm where it was [rad, m].
_SAME: Final = 0.003

MIRRORED: Final = (
    "the arm is seen where only a mirrored camera would see it: switch off mirroring in the "
    "camera's driver, or check that camera/extrinsics and joint_states are of this camera and arm"
)
ELSEWHERE: Final = (
    "the arm is not seen where its joints say that it is ({share:.0%} of it are seen through): the "
    "camera was moved, or camera/extrinsics are another one's; calibrate the camera, or check its "
    "depth and joint_states"
)


@dataclass(frozen=True)
class Evidence:
    """How many pixels say what of an arm.

    Attributes:
        met, through: of those at which it is to be, far from its outline: it is seen; what is seen
            is further away.
        mirrored_met, mirrored_open: of those at which a mirrored camera would see it, far from its
            outline: it is seen; nothing nearer is.
        here, mirrored: it is seen only where it is to be; only where a mirrored camera sees it.
    """

    met: int
    through: int
    mirrored_met: int
    mirrored_open: int
    here: int
    mirrored: int

    @property
    def share_through(self) -> float:
        """Of the pixels with depth at which nothing hides the arm, those at which it is not."""
        return self.through / max(1, self.met + self.through)

    @property
    def problem(self) -> str:
        """What contradicts the calibration, and what to do; empty where nothing surely does."""
        least = max(
            _MIRRORED_LEAST, _MIRRORED_SHARE * self.mirrored_met, _MIRRORED_RATIO * self.here
        )
        is_whole = self.mirrored_met >= _MIRRORED_WHOLE * self.mirrored_open
        if self.mirrored >= least and is_whole:
            return MIRRORED
        known = self.met + self.through
        if known >= _THROUGH_LEAST and self.share_through >= _THROUGH_SHARE:
            return ELSEWHERE.format(share=self.share_through)
        return ""


def evidence_of(arm: SeenArm, depth: NDArray[np.floating]) -> Evidence:
    """What a picture says of an arm.

    Args:
        depth: along the optical axis, shape (h, w) [m]; 0 or NaN where it is not known.
    """
    if not arm.depth.size:
        return Evidence(0, 0, 0, 0, 0, 0)
    seen = depth[arm.rows[:, None], arm.columns]
    reflected, inner = arm.depth[:, ::-1], arm.inner[:, ::-1]
    with np.errstate(invalid="ignore"):
        agrees = np.abs(seen - arm.depth) < TOLERANCE
        mirrored = np.abs(seen - reflected) < TOLERANCE
        through = (seen >= arm.depth + _THROUGH) & (seen < MAX_DEPTH)
        nearer = (seen > 0.0) & (seen <= reflected - TOLERANCE)
    return Evidence(
        *(
            int(np.count_nonzero(pixels))
            for pixels in (
                *(agrees & arm.inner, through & arm.inner),
                *(mirrored & inner, inner & ~nearer),
            )
        ),
        *(_within(pixels) for pixels in (agrees & ~mirrored, mirrored & ~agrees)),
    )


def _within(pixels: NDArray[np.bool_]) -> int:
    """How many there are without thin lines, as along the edges of what is seen, shape (m, n)."""
    return int(cv2.morphologyEx(pixels.astype(np.uint8), cv2.MORPH_OPEN, _SPOT).sum())


class ArmSight:
    """Looks for an arm in pictures. Keeps where it is seen as long as it stays there.

    Args:
        shape: of the arm.
        world_frame: in whose origin its root link stands, beside the frame of that link itself.
    """

    def __init__(self, shape: ArmShape, world_frame: str = "world") -> None:
        self._shape, self._world_frame = shape, world_frame
        self._known: dict[str, tuple[PinholeCamera, Mapping[str, float], SeenArm]] = {}

    def check(
        self, camera: str, observation: Observation, positions: Mapping[str, float], frame: str
    ) -> None:
        """Raises BadImageError where a picture surely contradicts the arm.

        Nothing is said of a picture without depth, of joints of which one is not told, or where the
        arm stands elsewhere than in the origin of the frame.

        Args:
            camera: its name.
            positions: of the joints when it was taken, by their names [rad, m].
            frame: in which the camera's pose is.
        """
        if frame not in (self._world_frame, self._shape.root):
            return
        told = self._shape.posed(positions)
        if observation.depth is None or observation.camera is None or told is None:
            return
        arm = self.seen_by(camera, observation.camera, told)
        if problem := evidence_of(arm, observation.depth).problem:
            raise BadImageError(with_topics_of(camera, problem))

    def seen_by(self, name: str, camera: PinholeCamera, positions: Mapping[str, float]) -> SeenArm:
        """Where the arm is in the picture of a camera; positions as :meth:`ArmShape.posed`."""
        known = self._known.get(name)
        if known is None or known[0] is not camera or _apart(known[1], positions) > _SAME:
            known = (camera, positions, self._shape.seen_by(camera, positions))
            self._known[name] = known
        return known[2]


def _apart(one: Mapping[str, float], other: Mapping[str, float]) -> float:
    return max((abs(value - other[name]) for name, value in one.items()), default=0.0)
