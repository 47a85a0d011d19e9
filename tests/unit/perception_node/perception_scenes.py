# SPDX-License-Identifier: Apache-2.0
"""Scenes for tests of perception: ray-cast solids, whose geometry is known exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from scene_graph import ROW_OF_THREE

Array = NDArray[np.float64]

PLACES = ROW_OF_THREE


def looking_camera(size: int = 256) -> PinholeCamera:
    """A camera in front of the places, as the simulator's but described here on its own."""
    position, target = np.array([1.45, 0.0, 0.40]), np.array([0.5, 0.0, 0.155])
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = position
    focal = 0.5 * size / np.tan(0.26)
    middle = 0.5 * size - 0.5
    intrinsics = np.array([[focal, 0.0, middle], [0.0, focal, middle], [0.0, 0.0, 1.0]])
    return PinholeCamera(intrinsics, pose, size, size)


@dataclass(frozen=True)
class Solid:
    """A solid in world: centre [m], half extents [m] (radius and half height for round ones)."""

    shape: str
    centre: tuple[float, float, float]
    half: float | tuple[float, float, float] = 0.0225
    yaw: float = 0.0

    @property
    def halves(self) -> Array:
        """Half extents along its own axes, shape (3,) [m]; a round one's radius is the first."""
        return np.broadcast_to(np.asarray(self.half, dtype=float), 3)


def cast(solids: list[Solid], camera: PinholeCamera) -> tuple[Array, NDArray[np.uint16]]:
    """Depth along the optical axis [m] (0: nothing) and labels 1, 2, … of solids on a table."""
    rows, columns = np.indices((camera.height, camera.width))
    rays = camera.rays_world(np.stack([columns, rows], axis=-1))
    origin = camera.position_world
    depth = np.where(rays[..., 2] < 0, -origin[2] / np.minimum(rays[..., 2], -1e-9), np.inf)
    labels = np.zeros(depth.shape, np.uint16)
    for number, solid in enumerate(solids, start=1):
        distance = _hit(solid, origin, rays)
        nearer = distance < depth
        depth[nearer], labels[nearer] = distance[nearer], number
    return np.where(np.isfinite(depth), depth, 0.0), labels


def _hit(solid: Solid, origin: Array, rays: Array) -> Array:
    """Distance along each ray to the first point of a solid, infinite where it misses."""
    c, s = np.cos(solid.yaw), np.sin(solid.yaw)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    start, directions = (origin - solid.centre) @ turn, rays @ turn
    directions = np.where(np.abs(directions) < 1e-12, 1e-12, directions)
    half = solid.halves
    if solid.shape == "sphere":
        return _quadratic(start, directions, half[0])[0]
    near, far = (-half - start) / directions, (half - start) / directions
    enter, leave = np.minimum(near, far), np.maximum(near, far)
    if solid.shape == "cylinder":
        round_enter, round_leave = _quadratic(start[:2], directions[..., :2], half[0])
        first = np.maximum(enter[..., 2], round_enter)
        last = np.minimum(leave[..., 2], round_leave)
    else:
        first, last = enter.max(-1), leave.min(-1)
    return np.where((first < last) & (first > 0), first, np.inf)


def _quadratic(start: Array, directions: Array, radius: float) -> tuple[Array, Array]:
    """Where rays enter and leave a ball (3-D) or a disc (2-D) about the origin."""
    a = np.sum(directions**2, axis=-1)
    b = np.sum(directions * start, axis=-1)
    root = b**2 - a * (start @ start - radius**2)
    hits = root > 0
    root = np.sqrt(np.where(hits, root, 0.0))
    return np.where(hits, (-b - root) / a, np.inf), np.where(hits, (-b + root) / a, -np.inf)


def piled(place: int, sizes: list[tuple[float, float, float]], yaws: list[float]) -> list[Solid]:
    """Boxes of these sizes [m] and yaws [rad] on one another at a place."""
    x, y, level = PLACES[place]
    boxes = []
    for (width, depth, height), yaw in zip(sizes, yaws):
        half = (0.5 * width, 0.5 * depth, 0.5 * height)
        boxes.append(Solid("box", (x, y, level + half[2]), half, yaw))
        level += height
    return boxes


def tower(
    place: int, shapes: list[str], yaw: float = 0.0, offset: tuple[float, float] = (0.0, 0.0)
) -> list[Solid]:
    """Solids standing on one another at a place."""
    x, y, z = PLACES[place]
    return [
        Solid(shape, (x + offset[0], y + offset[1], z + 0.045 * level + 0.0225), yaw=yaw)
        for level, shape in enumerate(shapes)
    ]
