# SPDX-License-Identifier: Apache-2.0
"""Measures the blocks of a picture one by one, from the depth of their pixels."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError, NotUprightError
from perception_node.segment import Segments

from .box import box_residual, measure_box
from .front import front_plane
from .normals import surface_normals
from .round import measure_round
from .surface import FLATNESS, MIN_FACE_POINTS, BlockSurface, NoSurfaceError
from .view import BlockView

Mask = NDArray[np.bool_]

#: Least share of a block's pixels that must have depth.
MIN_DEPTH_SHARE: Final = 0.6


def measure_blocks(
    segments: Segments, depth: NDArray[np.floating], camera: PinholeCamera
) -> tuple[BlockSurface, ...]:
    """What the depth says about each block, in the order of the segments.

    Args:
        depth: along the optical axis, shape (height, width) [m].

    Raises:
        BadImageError: if too little depth of a block is known; the sentence names its label.
        NotUprightError: if enough is known, but it is no block that stands upright.
    """
    surfaces = []
    for index, segment in enumerate(segments):
        try:
            surfaces.append(measure_block(segment.part, depth, camera))
        except BadImageError as error:
            raise BadImageError(
                f"the depth of the object with label {segment.label} cannot be used: {error}; "
                "check the depth camera"
            ) from error
        except NoSurfaceError as error:
            raise NotUprightError(
                "lies on its side or leans: no upright face of it is seen; put it upright, or "
                "check the depth camera if it is",
                index,
            ) from error
    return tuple(surfaces)


def measure_block(mask: Mask, depth: NDArray[np.floating], camera: PinholeCamera) -> BlockSurface:
    """Measures the block that a mask shows.

    Args:
        mask: the block's pixels, shape (height, width).
        depth: along the optical axis, shape (height, width) [m]; anything but a positive number
            means unknown.

    Raises:
        BadImageError: if too little depth is known to say anything; the sentence goes on from the
            block's name.
        NoSurfaceError: if no surface of an upright block goes through the points.
    """
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    if len(rows) == 0:
        raise BadImageError("it has no pixels")
    view = BlockView.around(mask, depth, camera, rows, columns)
    valid = view.mask & np.isfinite(view.points[..., 0])
    known = np.count_nonzero(valid)
    share = known / np.count_nonzero(view.mask)
    if share < MIN_DEPTH_SHARE or known < 3 * MIN_FACE_POINTS:
        raise BadImageError(f"only {share:.0%} of its pixels have depth")
    points = view.points[valid]
    normals = surface_normals(view.points, view.origin)[valid]
    yaw, front, tilt = front_plane(points, normals)
    box = measure_box(view, yaw, front, tilt)
    if box_residual(box, points) <= FLATNESS:
        return box
    return measure_round(view, points, normals) or box
