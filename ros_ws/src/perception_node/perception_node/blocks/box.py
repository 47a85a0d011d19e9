# SPDX-License-Identifier: Apache-2.0
"""Measures a block as an upright box: its faces by depth, its edges by the outline of its front."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX

from .surface import MIN_FACE_POINTS, SURFACE_TOLERANCE, BlockSurface, Interval, block_frame
from .view import BlockView

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def measure_box(view: BlockView, yaw: float, front: float, tilt: float) -> BlockSurface:
    """The block as a box with this front: its edges, and the faces behind them where they are seen.

    Args:
        yaw, front, tilt: the front face, see :class:`BlockSurface`.
    """
    mask, in_frame = view.mask, view.points @ block_frame(yaw)
    with np.errstate(invalid="ignore"):
        behind = mask & (in_frame[..., 0] < front - SURFACE_TOLERANCE)
    unknown = mask & np.isnan(in_frame[..., 0])
    if unknown.any():  # a pixel without depth is of the face that most of its neighbours are of
        near_behind = cv2.boxFilter(behind.astype(np.float32), -1, (3, 3))
        near_front = cv2.boxFilter((mask & ~behind & ~unknown).astype(np.float32), -1, (3, 3))
        behind |= unknown & (near_behind > near_front)
    left, right, bottom, top = _edges(mask & ~behind, view, yaw, front)
    rest = in_frame[behind & ~unknown]
    inside = (rest[:, 1] > left.high + SURFACE_TOLERANCE) & (
        rest[:, 1] < right.low - SURFACE_TOLERANCE
    )
    top = _face_offset(rest[inside, 2], top) or top
    below = rest[rest[:, 2] < top.low - SURFACE_TOLERANCE, 1]
    left = _face_offset(below, left) or left
    right = _face_offset(below, right) or right
    return BlockSurface(BOX, yaw, front, left, right, bottom, top, tilt)


def _face_offset(offsets: Array, edge: Interval) -> Interval | None:
    """Offset of the face that begins at an edge, by the points that have nearly its offset [m]."""
    near = offsets[
        (offsets > edge.low - SURFACE_TOLERANCE) & (offsets < edge.high + SURFACE_TOLERANCE)
    ]
    if len(near) < MIN_FACE_POINTS or np.std(near) > SURFACE_TOLERANCE:
        return None
    middle, doubt = float(np.median(near)), 1e-4 + 2.0 * float(np.std(near)) / np.sqrt(len(near))
    return Interval(middle - doubt, middle + doubt)


def _edges(
    face: Mask, view: BlockView, yaw: float, front: float
) -> tuple[Interval, Interval, Interval, Interval]:
    """Left, right, bottom and top edge of the pixels of an upright plane, in the block's frame.

    Args:
        face: the pixels, shape (h, w) of the view.
        yaw, front: the plane.
    """
    if not face.any():
        unknown = Interval(np.nan, np.nan)
        return unknown, unknown, unknown, unknown
    rays, origin = view.rays @ block_frame(yaw), view.origin @ block_frame(yaw)
    distance = (front - origin[0]) / rays[..., 0]
    y, z = origin[1] + rays[..., 1] * distance, origin[2] + rays[..., 2] * distance
    crop = face
    if y[0, -1] < y[0, 0]:
        y, z, crop = y[:, ::-1], z[:, ::-1], crop[:, ::-1]
    used = np.flatnonzero(crop.any(1))
    first = crop.argmax(1)[used]
    last = crop.shape[1] - 1 - crop[:, ::-1].argmax(1)[used]
    left = _joined(y[used, first - 1], y[used, first])
    right = _joined(y[used, last], y[used, last + 1])
    used = np.flatnonzero(crop.any(0))
    first = crop.argmax(0)[used]
    last = crop.shape[0] - 1 - crop[::-1].argmax(0)[used]
    top = _joined(z[first, used], z[first - 1, used])
    bottom = _joined(z[last + 1, used], z[last, used])
    return left, right, bottom, top


def _joined(lows: Array, highs: Array) -> Interval:
    """Where an edge is, after what every row says: their intersection, or with noise the median."""
    low, high = float(lows.max()), float(highs.min())
    if low <= high:
        return Interval(low, high)
    return Interval(float(np.median(lows)), float(np.median(highs)))


def box_residual(box: BlockSurface, points: Array) -> float:
    """How far the points are from the nearest face, at the 80th percentile [m]."""
    x, y, z = (points @ block_frame(box.yaw)).T
    offsets = [x - box.front, y - box.left.middle, y - box.right.middle, z - box.top.middle]
    nearest = np.abs(offsets).min(axis=0)
    return float(np.partition(nearest, int(0.8 * len(nearest)))[int(0.8 * len(nearest))])
