# SPDX-License-Identifier: Apache-2.0
"""Surface normals of a depth image."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def surface_normals(points_world: Array, camera_position_world: Array) -> Array:
    """Unit normals that look towards the camera.

    The cross product of the smoothed (Sobel) derivatives along columns and rows. Pixels whose 3x3
    neighbourhood holds a point without depth, or a jump in depth, get NaN or a mixed normal; those
    who use the normals must expect both.

    Args:
        points_world: shape (height, width, 3) [m], NaN where there is no depth.
        camera_position_world: shape (3,) [m].

    Returns:
        Shape (height, width, 3).
    """
    along_columns = cv2.Sobel(points_world, cv2.CV_64F, 1, 0, ksize=3)
    along_rows = cv2.Sobel(points_world, cv2.CV_64F, 0, 1, ksize=3)
    normals = np.cross(along_columns, along_rows)
    with np.errstate(invalid="ignore", divide="ignore"):
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        away = np.sum(normals * (points_world - camera_position_world), axis=-1) > 0
    normals[away] *= -1.0
    return normals
