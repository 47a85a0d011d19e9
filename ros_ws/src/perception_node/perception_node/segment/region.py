# SPDX-License-Identifier: Apache-2.0
"""The part of a picture in which blocks can be, as points over the table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera

from .volume import Volume

Array = NDArray[np.float32]
Mask = NDArray[np.bool_]

#: A pixel without depth has that of the neighbour, as far as this, whose colour is most like it.
FILL_REACH: Final = 2
#: but only if their channels differ by less than this altogether [0..255].
FILL_LIKENESS: Final = 60.0


@dataclass(frozen=True)
class Region:
    """A rectangle of a picture.

    Attributes:
        box: where it is in the picture: rows, columns.
        rgb: shape (h, w, 3).
        depth: as measured, NaN where it is unknown, shape (h, w) [m].
        filled: the same, with the depth of a neighbour where none was measured, shape (h, w) [m].
        points: of the filled depth, in world, NaN without, shape (h, w, 3) [m].
        inside: pixels whose points are over or beside the places, shape (h, w).
    """

    box: tuple[slice, slice]
    rgb: NDArray[np.uint8]
    depth: Array
    filled: Array
    points: Array
    inside: Mask


def look_at(
    rgb: NDArray[np.uint8],
    depth: NDArray[np.floating],
    camera: PinholeCamera,
    volume: Volume,
) -> Region | None:
    """The part of a picture that shows a volume; None where none of it is in the picture.

    Args:
        rgb: shape (height, width, 3).
        depth: anything but a positive number means unknown, shape (height, width) [m].
    """
    pixels = camera.project(volume.corners())
    if not np.isfinite(pixels).all():  # the camera is in the volume: all of it may be seen
        pixels = np.array([[0, 0], [camera.width - 1, camera.height - 1]], dtype=np.float64)
    size = (camera.width, camera.height)
    first = np.clip(np.floor(pixels.min(axis=0)).astype(int), 0, size)
    last = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + 1, 0, size)
    if (last - first).min() < 3:
        return None
    box = slice(int(first[1]), int(last[1])), slice(int(first[0]), int(last[0]))
    part = np.ascontiguousarray(rgb[box])
    measured = depth[box].astype(np.float32)
    measured[~(measured > 0.0) | np.isinf(measured)] = np.nan
    filled = fill(measured, part)
    columns, rows = np.meshgrid(np.arange(first[0], last[0]), np.arange(first[1], last[1]))
    rays = camera.rays_world(np.stack([columns, rows], axis=-1)).astype(np.float32)
    points = camera.position_world.astype(np.float32) + rays * filled[..., None]
    with np.errstate(invalid="ignore"):
        across = points[..., :2]
        inside = ((across > volume.low[:2]) & (across < volume.high[:2])).all(axis=-1)
        inside &= points[..., 2] < volume.high[2]
    return Region(box, part, measured, filled, points, inside)


def fill(depth: Array, rgb: NDArray[np.uint8]) -> Array:
    """Gives pixels without depth that of the neighbour, near by, whose colour is most like theirs.

    Args:
        depth: NaN where it is unknown, shape (h, w) [m].
        rgb: shape (h, w, 3).
    """
    reach = FILL_REACH
    unknown = np.isnan(depth)
    near = cv2.dilate((~unknown).view(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1), np.uint8))
    rows, columns = np.nonzero(unknown & (near > 0))
    if len(rows) == 0:
        return depth
    wide = np.pad(depth, reach, constant_values=np.nan)
    colors = cv2.copyMakeBorder(rgb, reach, reach, reach, reach, cv2.BORDER_REPLICATE)
    own = rgb[rows, columns].astype(np.int32)
    best, least = np.full(len(rows), np.nan, np.float32), np.full(len(rows), FILL_LIKENESS)
    steps = range(-reach, reach + 1)
    for down, right in ((i, j) for i in steps for j in steps):
        at = rows + reach + down, columns + reach + right
        found = wide[at]
        # Of two that look alike the nearer one.
        difference = np.abs(colors[at].astype(np.int32) - own).sum(axis=1)
        difference = difference + 2.0 * np.hypot(down, right)
        better = ~np.isnan(found) & (difference < least)
        best[better], least[better] = found[better], difference[better]
    filled = depth.copy()
    filled[rows, columns] = best
    return filled
