# SPDX-License-Identifier: Apache-2.0
"""The front of a block: the upright plane with most of its points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .surface import MIN_FACE_POINTS, SURFACE_TOLERANCE, block_frame

Array = NDArray[np.float64]


def front_plane(points: Array, normals: Array) -> tuple[float, float, float]:
    """Yaw, offset and tilt of the upright plane with most points; arrays (n, 3)."""
    upright = np.isfinite(normals[:, 0]) & (np.abs(normals[:, 2]) < 0.5)
    if np.count_nonzero(upright) < MIN_FACE_POINTS:
        return 0.0, float(np.quantile(points[:, 0], 0.8)), 0.0
    angles = np.arctan2(normals[upright, 1], normals[upright, 0])
    # The faces of a box are a quarter turn apart: four times the angle is the same for all.
    quarter = float(np.angle(np.mean(np.exp(4j * angles)))) / 4.0
    turns = np.round((angles - quarter) / (np.pi / 2)).astype(int) % 4
    turn = int(np.bincount(turns, minlength=4).argmax())
    yaw = quarter + turn * np.pi / 2
    points = points[upright][turns == turn]
    front = float(np.median(points @ block_frame(yaw)[:, 0]))
    tilt, tolerance = 0.0, 2.0 * SURFACE_TOLERANCE
    for _ in range(3):
        x, y, z = (points @ block_frame(yaw)).T
        near = np.abs(x - front) < tolerance
        if np.count_nonzero(near) < MIN_FACE_POINTS:
            break
        x, y, z = x[near] - front, y[near] - y[near].mean(), z[near] - z[near].mean()
        across, along = _slopes(x, y, z)
        yaw -= float(np.arctan(across))
        tilt = float(np.abs(np.arctan(along)))
        front = float((points[near] @ block_frame(yaw)[:, 0]).mean())
        # As narrow as the depth's noise allows, so that the ends of other faces drop out.
        noise = float((x - across * y - along * z).std())
        tolerance = float(np.clip(4.0 * noise, 2e-4, tolerance))
    return float((yaw + np.pi) % (2.0 * np.pi) - np.pi), front, tilt


def _slopes(x: Array, y: Array, z: Array) -> tuple[float, float]:
    """Least squares x = across·y + along·z + constant, for y and z of zero mean, shapes (n,)."""
    yy, yz, zz, xy, xz = y @ y, y @ z, z @ z, x @ y, x @ z
    determinant = yy * zz - yz * yz
    if determinant <= 1e-6 * (yy + zz + 1e-12) ** 2:
        return 0.0, 0.0
    return float((xy * zz - xz * yz) / determinant), float((xz * yy - xy * yz) / determinant)
