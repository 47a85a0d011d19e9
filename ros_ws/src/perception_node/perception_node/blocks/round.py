# SPDX-License-Identifier: Apache-2.0
"""Measures a block as a ball or an upright cylinder, by least squares through its points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scene_graph import CYLINDER, SPHERE

from .box import measure_box
from .surface import FLATNESS, MIN_FACE_POINTS, BlockSurface, Interval
from .view import BlockView

Array = NDArray[np.float64]


def measure_round(view: BlockView, points: Array, normals: Array) -> BlockSurface | None:
    """The block as a sphere or an upright cylinder, whichever fits better; None if neither does."""
    centre, radius, sphere_residual = _fit_ball(points)
    side = points[np.isfinite(normals[:, 0]) & (np.abs(normals[:, 2]) < 0.4)]
    axis, axis_radius, axis_residual = _fit_ball(side[:, :2])
    if min(sphere_residual, axis_residual) > FLATNESS:
        return None
    if sphere_residual < axis_residual:
        x, y, z = centre
        low, high = Interval(z - radius, z - radius), Interval(z + radius, z + radius)
        left, right = Interval(y - radius, y - radius), Interval(y + radius, y + radius)
        return BlockSurface(SPHERE, 0.0, x + radius, left, right, low, high)
    x, y = axis
    # Near its nearest line a cylinder is like the front of a box.
    strip = measure_box(view, 0.0, x + axis_radius, 0.0)
    left = Interval(y - axis_radius, y - axis_radius)
    right = Interval(y + axis_radius, y + axis_radius)
    return BlockSurface(CYLINDER, 0.0, strip.front, left, right, strip.bottom, strip.top)


def _fit_ball(points: Array) -> tuple[Array, float, float]:
    """Circle or sphere through points (n, d) by least squares.

    Returns:
        Centre, shape (d,), radius, and the 80th percentile of the residuals [m].
    """
    if len(points) < 3 * MIN_FACE_POINTS:
        return np.full(points.shape[1], np.nan), np.nan, np.inf
    mean = points.mean(0)
    centred = points - mean
    design = np.column_stack([2.0 * centred, np.ones(len(points))])
    solution, *_ = np.linalg.lstsq(design, np.sum(centred**2, axis=1), rcond=None)
    centre = solution[:-1]
    radius = float(np.sqrt(max(solution[-1] + centre @ centre, 0.0)))
    residual = np.abs(np.linalg.norm(centred - centre, axis=1) - radius)
    return mean + centre, radius, float(np.quantile(residual, 0.8))
