# SPDX-License-Identifier: Apache-2.0
"""The surfaces of bodies as triangles, made once for all bodies that look the same to pybullet."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Final

import numpy as np
import pybullet
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from ..meshes.wavefront import Mesh, corner_normals, read_obj

Array = NDArray[np.float64]

#: A round block's outline is this fine: off by 0.03 mm for a diameter of 45 mm.
SIDES: Final = 64
_SUBDIVISIONS: Final = 3


@dataclass(frozen=True)
class Surface:
    """Triangles in the frame of a body's link.

    Attributes:
        link: pybullet's number of the link, -1 for the base.
        points: vertices, shape (v, 3) [m].
        faces: the vertices of each triangle, clockwise as seen from outside, shape (f, 3).
        normals: outward at each corner, of unit length, shape (f, 3, 3).
        colors: of the faces, shape (f, 3), 0 to 255.
    """

    link: int
    points: Array
    faces: NDArray[np.int64]
    normals: Array
    colors: Array

    @cached_property
    def _planes(self) -> tuple[Array, Array]:
        """Outward normals, shape (f, 3), of any length, and each plane's offset along its own."""
        a, b, c = (self.points[self.faces[:, corner]] for corner in range(3))
        outward = np.cross(c - a, b - a)
        return outward, np.einsum("fi,fi->f", outward, a)

    def faces_to(self, eye: Array) -> NDArray[np.bool_]:
        """Which faces show their outside to an eye in the link's frame, shape (3,) -> (f,)."""
        outward, offsets = self._planes
        return np.asarray(outward @ eye > offsets)


def surfaces_of(client: int, body: int) -> tuple[Surface, ...]:
    """The surfaces of a body; what is fully transparent has none.

    Raises:
        OSError: if a mesh cannot be read.
        ValueError: for a shape that cannot be drawn.
    """
    found = []
    for shape in pybullet.getVisualShapeData(body, physicsClientId=client):
        link, kind, size, file, position, quaternion, rgba = shape[1:8]
        if rgba[3] == 0.0:
            continue
        if link == -1:  # pybullet gives it in the frame of the inertia there
            inertial = pybullet.getDynamicsInfo(body, -1, physicsClientId=client)
            position, quaternion = pybullet.multiplyTransforms(
                *pybullet.invertTransform(inertial[3], inertial[4]), position, quaternion
            )
        found.append(_surface(link, kind, size, file.decode(), position, quaternion, rgba[:3]))
    return tuple(found)


# A reset builds the world anew, of bodies that look as those before did: 12 ms for the arm's
# meshes. The key is all that a surface is made of; an arm has about a dozen of them, a block one.
@lru_cache(maxsize=128)
def _surface(
    link: int,
    kind: int,
    size: tuple[float, ...],
    file: str,
    position: tuple[float, ...],
    quaternion: tuple[float, ...],
    color: tuple[float, ...],
) -> Surface:
    """The surface of one shape, which stands at a pose in the frame of its link.

    Args:
        size, file: see :func:`_shape`.
        color: 0 to 1.
    """
    points, normals, colors = _shape(kind, size, file)
    turn = Rotation.from_quat(quaternion)
    vertices, faces = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
    surface = Surface(
        link,
        turn.apply(vertices) + np.array(position),
        faces.reshape(-1, 3)[:, ::-1],
        turn.apply(normals.reshape(-1, 3)).reshape(normals.shape)[:, ::-1],
        colors * np.array(color),
    )
    for shared in (surface.points, surface.faces, surface.normals, surface.colors):
        shared.setflags(write=False)
    return surface


def _shape(kind: int, size: tuple[float, ...], file: str) -> tuple[Array, Array, Array]:
    """Corners, counter-clockwise, normals and colours of a shape in its own frame."""
    if kind == pybullet.GEOM_MESH:
        points, normals, colors = _of_mesh(file)
        scale = np.array(size)
        return points * scale, _unit(normals / scale), colors
    if kind == pybullet.GEOM_BOX:
        points = box() * np.array(size)
        normals = flat_normals(points)
    elif kind == pybullet.GEOM_SPHERE:
        normals = sphere()
        points = size[0] * normals
    elif kind == pybullet.GEOM_CYLINDER:
        points, normals = cylinder()
        points = points * np.array([size[1], size[1], size[0]])
    else:
        raise ValueError(f"a visual shape of pybullet's kind {kind} cannot be drawn")
    return points, normals, np.full((len(points), 3), 255.0)


@lru_cache(maxsize=64)
def _of_mesh(file: str) -> tuple[Array, Array, Array]:
    path = Path(file)
    mesh = read_obj(path)
    return mesh.vertices[mesh.faces], corner_normals(mesh), _mesh_colors(mesh, path.parent)


def _mesh_colors(mesh: Mesh, folder: Path) -> Array:
    """The texture's colours at the faces, shape (f, 3); white without one."""
    colors = np.full((len(mesh.faces), 3), 255.0)
    textured = np.isfinite(mesh.texture[:, 0])
    if mesh.image and textured.any():
        image = np.asarray(Image.open(folder / mesh.image).convert("RGB"), dtype=float)
        height, width = image.shape[:2]
        places = np.mod(mesh.texture[textured], 1.0)
        columns = np.minimum((places[:, 0] * width).astype(int), width - 1)
        rows = np.minimum(((1.0 - places[:, 1]) * height).astype(int), height - 1)
        colors[textured] = image[rows, columns]
    return colors


def box() -> Array:
    """A cube of edge 1 around the origin, shape (12, 3, 3)."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    return convex(corners)


@lru_cache(maxsize=1)
def cylinder() -> tuple[Array, Array]:
    """Corners and normals of a cylinder of radius 1 and length 1 about z."""
    angles = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(SIDES)])
    up = np.array([0.0, 0.0, 0.5])
    following = np.roll(circle, -1, axis=0)
    low, low_next, high, high_next = circle - up, following - up, circle + up, following + up
    side = np.concatenate(
        [np.stack([low, low_next, high_next], 1), np.stack([low, high_next, high], 1)]
    )
    around = np.concatenate(
        [np.stack([circle, following, following], 1), np.stack([circle, following, circle], 1)]
    )
    top = np.stack([np.broadcast_to(up, circle.shape), high, high_next], 1)
    bottom = np.stack([np.broadcast_to(-up, circle.shape), low_next, low], 1)
    points = np.concatenate([side, top, bottom])
    normals = np.concatenate([around, flat_normals(top), flat_normals(bottom)])
    return points, normals


@lru_cache(maxsize=1)
def sphere() -> Array:
    """Corners of a sphere of radius 1, which are their normals, too."""
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    corners = np.array(
        [p for s in (-1, 1) for t in (-golden, golden) for p in ((0, s, t), (s, t, 0), (t, 0, s))],
        dtype=float,
    )
    points = convex(_unit(corners))
    for _ in range(_SUBDIVISIONS):
        a, b, c = points[:, 0], points[:, 1], points[:, 2]
        ab, bc, ca = _unit(a + b), _unit(b + c), _unit(c + a)
        points = np.concatenate(
            [
                np.stack(corner, 1)
                for corner in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))
            ]
        )
    return points


def convex(corners: Array) -> Array:
    """The hull of points around the origin as triangles, counter-clockwise, shape (f, 3, 3)."""
    points = corners[ConvexHull(corners).simplices]
    outward = np.einsum(
        "fi,fi->f",
        np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]),
        points.mean(axis=1),
    )
    points[outward < 0.0] = points[outward < 0.0][:, ::-1]
    return points


def flat_normals(points: Array) -> Array:
    """The normal of each triangle at its three corners, shape (f, 3, 3)."""
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    return np.repeat(_unit(normals)[:, None], 3, axis=1)


def _unit(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)
