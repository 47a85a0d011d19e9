# SPDX-License-Identifier: Apache-2.0
"""Whether what is seen over a block in the picture is on it, or behind it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from scene_graph import BOX

from .unit_bodies import LOW, TURN, UNITS, WIDE

Array = NDArray[np.float64]

#: What stands on a block hides of its top half of its own width and half of that of the top, less
#: where it stands further back: at least this part; what is behind it hides nothing. For a camera
#: that looks down on it by this tangent or more.
HIDES: Final = 0.45
LEAST_STEEP: Final = 0.08
#: Nothing stands on a box whose outline ends where its top does, to these parts of what the
#: narrowest block [m] would hide of it, for a camera that looks down on it by this tangent or more.
WHOLE: Final = (-0.25, 0.1)
NARROWEST: Final = 0.025
STEEP: Final = 0.2


def seen_behind(
    values: Array,
    shapes: Sequence[str],
    below: NDArray[np.intp],
    outlines: Sequence[Array],
    scale: Array,
    camera: PinholeCamera,
) -> NDArray[np.bool_]:
    """Which of N blocks hide less of the top of the one below than what stands there, shape (N,).

    What stands on a block hides its top from the front edge of its own lower end to the back; what
    is behind it ends where that top does.

    Args:
        values: parameters of the blocks, see :mod:`.unit_bodies`, shape (N, 7).
        below: the block below each in its tower, -1 for the lowest, shape (N,).
        outlines: points around each block, shape (n, 2) [px].
        scale: of the picture at each block, shape (N,) [px/m].
    """
    behind = np.zeros(len(values), bool)
    for upper, lower in enumerate(below):
        if lower < 0:
            continue
        top, steep = _top(values[lower], shapes[lower], camera)
        points = outlines[upper]
        left, right = np.quantile(points[:, 0], [0.3, 0.7])
        middle = (points[:, 0] >= left) & (points[:, 0] <= right)
        ends = points[middle & (points[:, 1] > np.median(points[:, 1]))]
        # The upper boundary of the top is that of its convex outline.
        back = _upper_edge(camera.project(top), ends[:, 0])
        inside = np.isfinite(back)
        if not inside.any() or steep < LEAST_STEEP:
            continue
        hides = float(np.median(ends[inside, 1] - back[inside])) / scale[upper]
        width = 0.5 * (values[upper, WIDE] + values[lower, WIDE])
        behind[upper] = hides < HIDES * steep * width
    return behind


def top_is_seen(
    values: Array, shape: str, outline: Array, scale: float, camera: PinholeCamera
) -> bool:
    """Whether the top of a block is seen up to its back, so that nothing stands on it.

    Args:
        values: its parameters, shape (7,).
        outline: points around it, shape (n, 2) [px].
        scale: of the picture there [px/m].
    """
    top, steep = _top(values, shape, camera)
    if shape != BOX or steep < STEEP:
        return False
    left, right = np.quantile(outline[:, 0], [0.3, 0.7])
    middle = (outline[:, 0] >= left) & (outline[:, 0] <= right)
    ends = outline[middle & (outline[:, 1] < np.median(outline[:, 1]))]
    hides = float(np.nanmedian(ends[:, 1] - _upper_edge(camera.project(top), ends[:, 0]))) / scale
    share = hides / (steep * 0.5 * (values[WIDE] + NARROWEST))
    return WHOLE[0] < share < WHOLE[1]


def _top(values: Array, shape: str, camera: PinholeCamera) -> tuple[Array, float]:
    """Corners of a block's top, (n, 3) [m], and by which tangent the camera looks down on it."""
    size = values[WIDE:LOW]
    corners = UNITS[shape] * size
    corners = corners[corners[:, 2] > 0.0]
    c, s = np.cos(values[TURN]), np.sin(values[TURN])
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    top = corners @ turn + [*values[:2], values[LOW] + 0.5 * size[2]]
    off = camera.position_world - top.mean(axis=0)
    return top, float(off[2] / np.hypot(*off[:2]))


def _upper_edge(corners: Array, columns: Array) -> Array:
    """The row of a convex outline's upper boundary at columns, NaN beside it, (n, 2) and (k,)."""
    hull = cv2.convexHull(corners.astype(np.float32))[:, 0].astype(np.float64)
    rows = np.full((len(hull), len(columns)), np.nan)
    for index, (begin, end) in enumerate(zip(hull, np.roll(hull, -1, axis=0))):
        if begin[0] > end[0]:
            begin, end = end, begin
        within = (columns >= begin[0]) & (columns <= end[0]) & (end[0] > begin[0])
        share = (columns[within] - begin[0]) / (end[0] - begin[0])
        rows[index, within] = begin[1] + share * (end[1] - begin[1])
    rows = np.where(np.isnan(rows), np.inf, rows).min(axis=0)
    return np.where(np.isinf(rows), np.nan, rows)
