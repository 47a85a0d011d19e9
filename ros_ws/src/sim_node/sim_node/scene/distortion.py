# SPDX-License-Identifier: Apache-2.0
"""Lens distortion, "plumb_bob", as sensor_msgs/CameraInfo and OpenCV have it.

With x, y = X/Z, Y/Z, r² = x² + y² and g = 1 + k1 r² + k2 r⁴ + k3 r⁶, a point is seen at

    x' = x g + 2 p1 x y + p2 (r² + 2 x²)
    y' = y g + p1 (r² + 2 y²) + 2 p2 x y
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ITERATIONS: Final = 30
#: A lens that is undone less exactly than this folds the picture.
_TOLERANCE: Final = 1e-9
#: So much a lens may shrink what is at the rim, and enlarge it.
_LEAST_SCALE: Final = 0.25
_MOST_SCALE: Final = 3.0


class FoldedPictureError(ValueError):
    """Two directions would be seen at one point of the picture, or none."""


def distorted(points: Array, coefficients: Sequence[float]) -> tuple[Array, Array]:
    """Where a lens shows directions, and how that changes with them.

    Args:
        points: x, y of directions (x, y, 1), shape (n, 2).
        coefficients: k1, k2, p1, p2, k3.

    Returns:
        x', y', shape (n, 2), and their derivatives by x, y, shape (n, 2, 2).
    """
    k1, k2, p1, p2, k3 = coefficients
    x, y = points.T
    r = x * x + y * y
    g = 1.0 + r * (k1 + r * (k2 + r * k3))
    slope = 2.0 * (k1 + r * (2.0 * k2 + r * 3.0 * k3))
    seen = np.column_stack(
        [
            x * g + 2.0 * p1 * x * y + p2 * (r + 2.0 * x * x),
            y * g + p1 * (r + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    )
    mixed = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y
    along_x = g + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x
    along_y = g + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x
    change = np.stack([np.column_stack([along_x, mixed]), np.column_stack([mixed, along_y])], 1)
    return seen, change


def undistorted(seen: Array, coefficients: Sequence[float]) -> tuple[Array, Array]:
    """The directions that a lens shows at points, by Newton's method.

    Args:
        seen: x', y', shape (n, 2).
        coefficients: k1, k2, p1, p2, k3.

    Returns:
        x, y, shape (n, 2), and how much the lens enlarges what is there, shape (n,).

    Raises:
        FoldedPictureError: the lens shows no direction there, or several.
    """
    points = seen.copy()
    with np.errstate(all="ignore"):
        for _ in range(_ITERATIONS):
            there, change = distorted(points, coefficients)
            off = there - seen
            if np.abs(off).max() < 0.01 * _TOLERANCE:
                break
            (a, b), (c, d) = change[:, 0].T, change[:, 1].T
            step = np.column_stack([d * off[:, 0] - b * off[:, 1], a * off[:, 1] - c * off[:, 0]])
            points = points - step / (a * d - b * c)[:, None]
        there, change = distorted(points, coefficients)
        (a, b), (c, d) = change[:, 0].T, change[:, 1].T
        area = a * d - b * c
        exact = np.abs(there - seen).max(axis=1) < _TOLERANCE
        # Neither turned over on the way from the middle, nor beyond: the linear part is positive.
        upright = exact & (area > _LEAST_SCALE**2) & (area < _MOST_SCALE**2) & (a + d > 0.0)
    if not upright.all():
        raise FoldedPictureError
    return points, np.sqrt(area)
