# SPDX-License-Identifier: Apache-2.0
"""Measures one block from the depth of its pixels: shape, faces, edges.

What is seen of an upright block from the front is exact across the surface (depth) and known to a
pixel along it (edges of the mask). So faces are measured by depth, and the position of an edge is
kept as the interval between the last pixel that shows the face and the first that does not;
:mod:`perception_node.block_poses` joins these intervals for the blocks of a scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, CYLINDER, SPHERE

from .camera_model import PinholeCamera
from .errors import BadImageError
from .surfaces import surface_normals

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: A point further than this from a surface is not of it [m].
SURFACE_TOLERANCE: Final = 0.002
#: How far a box's points may be from its faces, at the 80th percentile [m].
FLATNESS: Final = 0.0018
#: Least number of points that make a face.
MIN_FACE_POINTS: Final = 4
#: Least share of a block's pixels that must have depth.
MIN_DEPTH_SHARE: Final = 0.6


@dataclass(frozen=True)
class Interval:
    """What is known of a coordinate [m]: it is between ``low`` and ``high``."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class BlockSurface:
    """What the depth of one block's pixels says about it. Lengths in m, frame world.

    The block's own frame is world turned by ``yaw`` about z: its x axis points out of the front.

    Attributes:
        shape: ``box``, ``cylinder`` or ``sphere``.
        yaw: of the front's normal about world z [rad]; 0 for round shapes.
        front: x of the front face in the block's frame; for round shapes of the nearest point.
        left, right: y of the sides in the block's frame.
        bottom, top: z of the lower and upper end.
        tilt: angle between the front face and the vertical [rad].
    """

    shape: str
    yaw: float
    front: float
    left: Interval
    right: Interval
    bottom: Interval
    top: Interval
    tilt: float = 0.0

    def __post_init__(self) -> None:
        values = (self.yaw, self.front, self.left.middle, self.right.middle, self.bottom.middle)
        if not np.isfinite([*values, self.top.middle, self.tilt]).all():
            raise BadImageError("its depth does not form a surface")


def block_frame(yaw: float) -> Array:
    """R, shape (3, 3): ``points_world @ R`` are coordinates in a frame turned by ``yaw`` [rad]."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def measure_block(mask: Mask, depth: NDArray[np.floating], camera: PinholeCamera) -> BlockSurface:
    """Measures the block that a mask shows.

    Args:
        mask: the block's pixels, shape (height, width).
        depth: along the optical axis, shape (height, width) [m]; anything but a positive number
            means unknown.

    Raises:
        BadImageError: if too little depth is known to say anything; the sentence goes on from the
            block's name.
    """
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    if len(rows) == 0:
        raise BadImageError("it has no pixels")
    view = _View.around(mask, depth, camera, rows, columns)
    valid = view.mask & np.isfinite(view.points[..., 0])
    known = np.count_nonzero(valid)
    share = known / np.count_nonzero(view.mask)
    if share < MIN_DEPTH_SHARE or known < 3 * MIN_FACE_POINTS:
        raise BadImageError(f"only {share:.0%} of its pixels have depth")
    points = view.points[valid]
    normals = surface_normals(view.points, view.origin)[valid]
    yaw, front, tilt = _front_plane(points, normals)
    box = _measure_box(view, yaw, front, tilt)
    if _box_residual(box, points) <= FLATNESS:
        return box
    return _measure_round(view, points, normals) or box


@dataclass(frozen=True)
class _View:
    """The part of the image around a block, with one pixel more on every side.

    Attributes:
        mask: shape (h, w).
        rays: directions of the pixels in world, also of those outside the image, shape (h, w, 3).
        points: in world, NaN without depth, shape (h, w, 3) [m].
        origin: the camera's centre in world, shape (3,) [m].
    """

    mask: Mask
    rays: Array
    points: Array
    origin: Array

    @classmethod
    def around(
        cls,
        mask: Mask,
        depth: NDArray[np.floating],
        camera: PinholeCamera,
        rows: NDArray[np.intp],
        columns: NDArray[np.intp],
    ) -> _View:
        """``rows`` and ``columns`` are those that show the block, in order."""
        top, bottom, left, right = rows[0] - 1, rows[-1] + 2, columns[0] - 1, columns[-1] + 2
        u, v = np.meshgrid(np.arange(left, right), np.arange(top, bottom))
        rays = camera.rays_world(np.stack([u, v], axis=-1))
        height, width = mask.shape
        inside = np.s_[max(top, 0) : min(bottom, height), max(left, 0) : min(right, width)]
        shifted = np.s_[
            inside[0].start - top : inside[0].stop - top,
            inside[1].start - left : inside[1].stop - left,
        ]
        part = np.zeros(u.shape, bool)
        part[shifted] = mask[inside]
        distance = np.full(u.shape, np.nan)
        distance[shifted] = depth[inside]
        distance[~(distance > 0.0) | np.isinf(distance)] = np.nan
        origin = camera.position_world
        return cls(part, rays, origin + rays * distance[..., None], origin)


def _front_plane(points: Array, normals: Array) -> tuple[float, float, float]:
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


def _measure_box(view: _View, yaw: float, front: float, tilt: float) -> BlockSurface:
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
    face: Mask, view: _View, yaw: float, front: float
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


def _box_residual(box: BlockSurface, points: Array) -> float:
    """How far the points are from the nearest face, at the 80th percentile [m]."""
    x, y, z = (points @ block_frame(box.yaw)).T
    offsets = [x - box.front, y - box.left.middle, y - box.right.middle, z - box.top.middle]
    nearest = np.abs(offsets).min(axis=0)
    return float(np.partition(nearest, int(0.8 * len(nearest)))[int(0.8 * len(nearest))])


def _measure_round(view: _View, points: Array, normals: Array) -> BlockSurface | None:
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
    strip = _measure_box(view, 0.0, x + axis_radius, 0.0)
    left = Interval(y - axis_radius, y - axis_radius)
    right = Interval(y + axis_radius, y + axis_radius)
    return BlockSurface(CYLINDER, 0.0, strip.front, left, right, strip.bottom, strip.top)


def _fit_ball(points: Array) -> tuple[Array, float, float]:
    """Circle or sphere through points (n, d), by least squares: centre, radius, median residual."""
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
