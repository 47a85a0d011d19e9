# SPDX-License-Identifier: Apache-2.0
"""A picture as it would be on an upright screen over the places, in one scale whatever the camera.

The screen stands on the middle of the row and faces the camera, so that a block has nearly the same
size in it from anywhere, through any lens, in any resolution: what learnt from pictures of one
camera can be used with others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError

from .volume import Volume

Array = NDArray[np.float64]

#: Edge of a pixel [m].
PITCH: Final = 0.002
#: What is shown beside the outer places, over the highest tower and under the table's surface [m].
BESIDE: Final = 0.1
OVER: Final = 0.03
UNDER: Final = 0.06
#: Sides are multiples of this [px].
MULTIPLE: Final = 16
#: Greatest side [px].
MOST: Final = 1024
#: A camera that looks down more steeply than this sees no fronts of blocks [rad].
STEEPEST: Final = 1.0
#: Pictures with more pixels than this for one of the view are blurred before [px].
FINER: Final = 1.5


@dataclass(frozen=True)
class FrontView:
    """How pixels of the view belong to those of a picture.

    Attributes:
        shape: height and width of the view [px].
        picture_from_view: homography of pixels (u, v, 1), shape (3, 3).
        finer: pixels of the picture for one of the view, along a side.
        feet: the row of the view at which a block's foot is that stands on the row of places, for
            each column, shape (width,) [px].
        aside: how far each column is from that of the nearest place, to the right, shape (width,)
            [px].
        steepness: tangent of the angle by which the camera looks down on the row.
    """

    shape: tuple[int, int]
    picture_from_view: Array
    finer: float
    feet: NDArray[np.float32]
    aside: NDArray[np.float32]
    steepness: float

    @classmethod
    def of(cls, camera: PinholeCamera, volume: Volume) -> FrontView:
        """The view that a camera has of the places of a volume.

        Raises:
            BadImageError: if it does not look at their front.
        """
        middle = np.array([*volume.feet.mean(axis=0), volume.floor])
        off = camera.position_world - middle
        distance = float(np.hypot(*off[:2]))
        steepness = float(off[2]) / max(distance, 1e-9)
        if distance < 0.1 or np.arctan(steepness) > STEEPEST:
            raise BadImageError(
                "the camera looks at the places from straight above, where the fronts of blocks "
                "are not seen; mask_source rgb needs a view from the side"
            )
        toward = np.array([*(off[:2] / distance), 0.0])
        right, up = np.array([-toward[1], toward[0], 0.0]), np.array([0.0, 0.0, 1.0])
        screen = _Screen(camera.position_world, middle, toward, right)
        feet = np.column_stack([volume.feet, np.full(len(volume.feet), volume.floor)])
        tops = feet + [0.0, 0.0, volume.high[2] - volume.floor]
        points = np.concatenate([screen.seen(feet), screen.seen(tops)])
        low, high = points.min(axis=0) - [BESIDE, UNDER], points.max(axis=0) + [BESIDE, OVER]
        size = (np.ceil((high - low) / (PITCH * MULTIPLE)) * MULTIPLE).astype(int)
        if size.max() > MOST:
            raise BadImageError(
                f"the places are spread over {high[0] - low[0]:.1f} m; mask_source rgb knows up to "
                f"{MOST * PITCH:.1f} m; check the parameter stack_positions and camera/extrinsics"
            )
        origin = middle + low[0] * right + high[1] * up
        turn = camera.world_from_optical[:3, :3].T
        axes = np.column_stack([PITCH * right, -PITCH * up, origin - camera.position_world])
        homography = camera.intrinsics @ turn @ axes
        centre = homography @ [0.5 * size[0], 0.5 * size[1], 1.0]
        finer = float(np.sqrt(abs(np.linalg.det(homography))) / abs(centre[2]) ** 1.5)
        columns = np.arange(size[0], dtype=np.float64)
        across = (screen.seen(feet) - low)[:, 0] / PITCH
        heights = (high[1] - screen.seen(feet)[:, 1]) / PITCH
        order = np.argsort(across)
        if len(feet) > 1:  # along the line of the row, beyond its ends as well
            line = np.polyfit(across, heights, 1)
            ground = np.polyval(line, columns)
        else:
            ground = np.full(len(columns), heights[0])
        nearest = np.abs(columns[:, None] - across[order]).argmin(axis=1)
        return cls(
            (int(size[1]), int(size[0])),
            homography,
            finer,
            ground.astype(np.float32),
            (columns - across[order][nearest]).astype(np.float32),
            steepness,
        )

    def taken(self, picture: NDArray[Any], nearest: bool = False) -> NDArray[Any]:
        """A picture in this view; beyond its edges 0.

        Args:
            picture: shape (height, width) or (height, width, 3).
            nearest: of labels, which have no values between them.
        """
        if self.finer > FINER and not nearest:
            picture = cv2.GaussianBlur(picture, (0, 0), 0.4 * self.finer)
        flags = (cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR) | cv2.WARP_INVERSE_MAP
        size = (self.shape[1], self.shape[0])
        return cv2.warpPerspective(picture, self.picture_from_view, size, flags=flags)

    def shown(self, values: NDArray[Any], size: tuple[int, int], nearest: bool = False) -> Any:
        """Values of the view's pixels at those of a picture of height and width; beyond them 0."""
        flags = cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR
        return cv2.warpPerspective(values, self.picture_from_view, (size[1], size[0]), flags=flags)

    def shown_part(
        self, values: NDArray[np.float32], box: tuple[slice, slice], size: tuple[int, int]
    ) -> tuple[tuple[slice, slice], NDArray[np.float32]]:
        """A part of the view as a part of a picture, and which; beyond it -1.

        Args:
            values: shape of the box.
            box: rows and columns of the view.
            size: height and width of the picture.
        """
        top, left = box[0].start, box[1].start
        ends = [[u, v] for u in (left, box[1].stop) for v in (top, box[0].stop)]
        corners = self.in_picture(np.array(ends, dtype=np.float64))
        limits = (size[1], size[0])
        first = np.clip(np.floor(corners.min(axis=0)).astype(int) - 1, 0, limits)
        last = np.clip(np.ceil(corners.max(axis=0)).astype(int) + 2, 0, limits)
        there = np.array([[1.0, 0.0, -first[0]], [0.0, 1.0, -first[1]], [0.0, 0.0, 1.0]])
        here = np.array([[1.0, 0.0, left], [0.0, 1.0, top], [0.0, 0.0, 1.0]])
        part = (slice(int(first[1]), int(last[1])), slice(int(first[0]), int(last[0])))
        width, height = int(last[0] - first[0]), int(last[1] - first[1])
        if width <= 0 or height <= 0:
            return part, np.zeros((max(height, 0), max(width, 0)), np.float32)
        shown = cv2.warpPerspective(
            values, there @ self.picture_from_view @ here, (width, height), borderValue=-1.0
        )
        return part, np.asarray(shown, np.float32)

    def in_picture(self, points: Array) -> Array:
        """Where points of the view are in the picture, (n, 2) -> (n, 2) [px]."""
        seen = np.column_stack([points, np.ones(len(points))]) @ self.picture_from_view.T
        return np.asarray(seen[:, :2] / seen[:, 2:])


@dataclass(frozen=True)
class _Screen:
    """The upright plane through the row's middle that faces the camera."""

    eye: Array
    middle: Array
    toward: Array
    right: Array

    def seen(self, points: Array) -> Array:
        """Where points are seen on it, to the right and up of its middle, (n, 3) -> (n, 2) [m]."""
        rays = points - self.eye
        ahead = np.minimum(rays @ self.toward, -1e-6)
        share = ((self.middle - self.eye) @ self.toward) / ahead
        hits = self.eye + rays * share[:, None] - self.middle
        return np.stack([hits @ self.right, hits[:, 2]], axis=-1)
