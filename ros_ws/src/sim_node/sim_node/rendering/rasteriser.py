# SPDX-License-Identifier: Apache-2.0
"""Triangles to pixels, all of them at once, in arrays.

A pixel belongs to the triangles that its centre lies in, and shows the nearest of them: coverage
and depth are exact, without any approximation of edges. The work is proportional to what is
covered: each triangle becomes the rows that it touches, each row the pixels between two edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Canvas:
    """What has been drawn so far.

    Attributes:
        inverse_depth: 1 / distance along the optical axis, shape (height * width,) [1/m]; 0 where
            nothing is.
        rgb: shape (height * width, 3), 0 to 255.
        labels: shape (height * width,).
    """

    width: int
    height: int
    inverse_depth: Array
    rgb: NDArray[np.uint8]
    labels: NDArray[np.uint16]

    @classmethod
    def empty(cls, width: int, height: int) -> Canvas:
        """Nothing anywhere: white, as far as can be."""
        size = width * height
        return cls(
            width,
            height,
            np.zeros(size),
            np.full((size, 3), 255, np.uint8),
            np.zeros(size, np.uint16),
        )

    def copy(self) -> Canvas:
        """One that can be drawn on while this one stays."""
        return Canvas(
            self.width,
            self.height,
            self.inverse_depth.copy(),
            self.rgb.copy(),
            self.labels.copy(),
        )


@dataclass(frozen=True)
class Triangles:
    """What is to be drawn, seen from the camera.

    Attributes:
        points: vertices in the optical frame (x right, y down, z forward), shape (v, 3) [m].
        faces: the vertices of each triangle, clockwise in the picture as seen from outside,
            shape (f, 3).
        shade: how bright each corner is, shape (f, 3), 1 for the colour itself.
        colors: shape (f, 3), 0 to 255.
        labels: shape (f,).
    """

    points: Array
    faces: NDArray[np.int64]
    shade: Array
    colors: Array
    labels: NDArray[np.uint16]


def draw(canvas: Canvas, triangles: Triangles, intrinsics: Array, near: float) -> None:
    """Draws triangles onto a canvas where they are nearer than what is there.

    Args:
        intrinsics: K, shape (3, 3) [px], of pixels whose centres have whole coordinates.
        near: what is nearer than this is cut off [m].
    """
    triangles = _clipped(triangles, near)
    x, y, z = triangles.points.T
    inverse = 1.0 / z
    u = intrinsics[0, 0] * x * inverse + intrinsics[0, 2]
    v = intrinsics[1, 1] * y * inverse + intrinsics[1, 2]
    u, v = u[triangles.faces.T], v[triangles.faces.T]  # of the corners, shape (3, f)
    area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0])
    facing = np.flatnonzero(area > 0.0)
    u, v = u[:, facing], v[:, facing]
    top = np.maximum(np.ceil(_least(v)), 0.0)
    bottom = np.minimum(np.floor(-_least(-v)), canvas.height - 1.0)
    left = np.maximum(np.ceil(_least(u)), 0.0)
    right = np.minimum(np.floor(-_least(-u)), canvas.width - 1.0)
    touching = np.flatnonzero((top <= bottom) & (left <= right))
    chosen = facing[touching]
    if not len(chosen):
        return
    u, v, top, area = u[:, touching], v[:, touching], top[touching], area[chosen]
    rows = (bottom[touching] - top).astype(np.int64) + 1
    # Edge i lies opposite to corner i: inside, a x + b y + c >= 0 for all three.
    a, b = v[[1, 2, 0]] - v[[2, 0, 1]], u[[2, 0, 1]] - u[[1, 2, 0]]
    c = u[[1, 2, 0]] * v[[2, 0, 1]] - u[[2, 0, 1]] * v[[1, 2, 0]]
    # Inverse depth and shade are linear in the picture: their change along x, along y, at 0.
    depth_plane = _plane(inverse[triangles.faces[chosen].T] / area, a, b, c)
    shade_plane = _plane(triangles.shade[chosen].T / area, a, b, c)

    face = np.repeat(np.arange(len(chosen)), rows)
    line = top[face] + (np.arange(len(face)) - (np.cumsum(rows) - rows)[face])
    begin, end = np.zeros(len(face)), np.full(len(face), canvas.width - 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        for slope, across, rest in zip(a, b, c):
            slope, rest = slope[face], (across[face] * line + rest[face])
            crossing = -rest / slope
            np.maximum(begin, crossing, out=begin, where=slope > 0.0)
            np.minimum(end, crossing, out=end, where=slope < 0.0)
            end[(slope == 0.0) & (rest < 0.0)] = -1.0
    begin, end = np.ceil(begin), np.floor(end)
    kept = np.flatnonzero(end >= begin)
    face, line, begin = face[kept], line[kept], begin[kept]
    counts = (end[kept] - begin).astype(np.int64) + 1

    start = np.cumsum(counts) - counts
    row = np.repeat(np.arange(len(kept)), counts)
    pixel = np.arange(len(row)) + (line * canvas.width + begin - start).astype(np.int64)[row]
    # On its line: the value at the line's first pixel of the picture, and the change along it.
    depth = np.arange(len(row)) * depth_plane[0][face][row]
    depth += _at(depth_plane, face, line, begin - start)[row]
    nearer = np.flatnonzero(depth > canvas.inverse_depth[pixel])
    pixel, depth = pixel[nearer], depth[nearer]
    np.maximum.at(canvas.inverse_depth, pixel, depth)
    shown = np.flatnonzero(depth == canvas.inverse_depth[pixel])
    pixel, number = pixel[shown], nearer[shown]
    row = row[number]
    shade = number * shade_plane[0][face][row] + _at(shade_plane, face, line, begin - start)[row]
    original = chosen[face][row]
    colors = triangles.colors[original] * shade[:, None]
    canvas.rgb[pixel] = np.minimum(colors, 255.0).astype(np.uint8)
    canvas.labels[pixel] = triangles.labels[original]


def _least(corners: Array) -> Array:
    """The least of three numbers, shape (3, f) -> (f,)."""
    return np.asarray(np.minimum(np.minimum(corners[0], corners[1]), corners[2]))


def _plane(weights: Array, a: Array, b: Array, c: Array) -> tuple[Array, Array, Array]:
    """What three edge functions make, weighted, shapes (3, f) -> (f,) each."""
    x, y, rest = ((weights * edge) for edge in (a, b, c))
    return x[0] + x[1] + x[2], y[0] + y[1] + y[2], rest[0] + rest[1] + rest[2]


def _at(plane: tuple[Array, Array, Array], face: NDArray[np.int64], line: Array, x: Array) -> Array:
    """A plane's value on lines of its faces, at x."""
    return plane[0][face] * x + plane[1][face] * line + plane[2][face]


def _clipped(triangles: Triangles, near: float) -> Triangles:
    """What of the triangles lies in front of the plane z = near."""
    behind = triangles.points[:, 2] < near
    if not behind.any():
        return triangles
    count = behind[triangles.faces].sum(axis=1)
    whole = np.flatnonzero(count == 0)
    points, faces, shades = [triangles.points], [triangles.faces[whole]], [triangles.shade[whole]]
    origin, size = [whole], len(triangles.points)
    for index in np.flatnonzero((count == 1) | (count == 2)):
        corners = np.column_stack(
            [triangles.points[triangles.faces[index]], triangles.shade[index]]
        )
        polygon: list[Array] = []
        for here, there in zip(corners, np.roll(corners, -1, axis=0)):
            if here[2] >= near:
                polygon.append(here)
            if (here[2] < near) != (there[2] < near):
                share = (near - here[2]) / (there[2] - here[2])
                polygon.append(here + share * (there - here))
        fan = np.array([[0, i, i + 1] for i in range(1, len(polygon) - 1)])
        points.append(np.array(polygon)[:, :3])
        shades.append(np.array(polygon)[fan, 3])
        faces.append(size + fan)
        origin.append(np.full(len(fan), index))
        size += len(polygon)
    kept = np.concatenate(origin)
    together = np.concatenate(points)
    # No face has them any more; they must only not divide by zero.
    together[:, 2] = np.maximum(together[:, 2], near)
    return Triangles(
        together,
        np.concatenate(faces),
        np.concatenate(shades),
        triangles.colors[kept],
        triangles.labels[kept],
    )
