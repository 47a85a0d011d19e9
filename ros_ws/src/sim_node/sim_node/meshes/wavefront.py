# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes in Wavefront files (.obj): as much of the format as visual meshes use."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

#: Corners share a normal where their faces meet at less than this angle, else the edge is sharp.
_SHARP_COSINE = np.cos(np.radians(40.0))


@dataclass(frozen=True)
class Mesh:
    """Triangles with one place in the texture each.

    Attributes:
        vertices: shape (v, 3) [m].
        faces: indices of vertices, counter-clockwise from outside, shape (f, 3).
        parts: number of the material of each face, shape (f,).
        texture: coordinates in the texture, shape (f, 2); NaN for a face without.
        image: file name of the texture, empty if there is none.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    parts: NDArray[np.int64]
    texture: NDArray[np.float64]
    image: str


def read_obj(path: Path) -> Mesh:
    """Reads a mesh; vertices at the same point become one, polygons become fans of triangles.

    Normals are not read: :func:`write_obj` makes them anew.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if it is no Wavefront file.
    """
    vertices: list[list[float]] = []
    places: list[list[float]] = []
    faces: list[list[int]] = []
    parts: list[int] = []
    texture: list[NDArray[np.float64]] = []
    materials: dict[str, int] = {}
    material, image = 0, ""
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in file:
            match line.split():
                case ["v", x, y, z, *_]:
                    vertices.append([float(x), float(y), float(z)])
                case ["vt", u, v, *_]:
                    places.append([float(u), float(v)])
                case ["usemtl", name, *_]:
                    material = materials.setdefault(name, len(materials))
                case ["mtllib", name, *_]:
                    image = _texture_of(path.parent / name) or image
                case ["f", *corners]:
                    indices = [corner.split("/") for corner in corners]
                    points = [_index(item[0], len(vertices)) for item in indices]
                    of_texture = [
                        places[_index(item[1], len(places))]
                        for item in indices
                        if len(item) > 1 and item[1]
                    ]
                    for second, third in itertools.pairwise(points[1:]):
                        faces.append([points[0], second, third])
                        parts.append(material)
                        texture.append(
                            np.mean(of_texture, axis=0) if of_texture else np.full(2, np.nan)
                        )
    if not faces:
        raise ValueError(f"{path} holds no faces")
    distinct, index = np.unique(np.array(vertices), axis=0, return_inverse=True)
    return Mesh(distinct, index.ravel()[np.array(faces)], np.array(parts), np.array(texture), image)


def write_obj(mesh: Mesh, path: Path) -> None:
    """Writes a mesh with normals that are smooth but across sharp edges, and its material."""
    normals = corner_normals(mesh)
    lines = []
    if mesh.image:
        path.with_suffix(".mtl").write_text(f"newmtl link\nmap_Kd {mesh.image}\n")
        lines = [f"mtllib {path.with_suffix('.mtl').name}", "usemtl link"]
    lines += ["v {:.6f} {:.6f} {:.6f}".format(*vertex) for vertex in mesh.vertices]
    lines += ["vn {:.4f} {:.4f} {:.4f}".format(*normal) for normal in normals.reshape(-1, 3)]
    textured: NDArray[np.bool_] = np.isfinite(mesh.texture[:, 0])
    lines += ["vt {:.6f} {:.6f}".format(*place) for place in mesh.texture[textured]]
    place_numbers = np.cumsum(textured)
    for number, face in enumerate(mesh.faces):
        place = str(place_numbers[number]) if textured[number] else ""
        corners = (f"{vertex + 1}/{place}/{3 * number + i + 1}" for i, vertex in enumerate(face))
        lines.append("f " + " ".join(corners))
    path.write_text("\n".join(lines) + "\n")


def face_normals(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Outward normals, shape (f, 3), as long as twice the face's area [m²]."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def corner_normals(mesh: Mesh) -> NDArray[np.float64]:
    """Unit normals at the corners of each face, shape (f, 3, 3).

    The mean over the faces around the vertex, weighted by area, of those that meet this face
    without a sharp edge.
    """
    weighted = face_normals(mesh.vertices, mesh.faces)
    unit = weighted / np.maximum(np.linalg.norm(weighted, axis=1, keepdims=True), 1e-300)
    around: list[list[int]] = [[] for _ in mesh.vertices]
    for number, face in enumerate(mesh.faces):
        for vertex in face:
            around[vertex].append(number)
    normals = np.empty((len(mesh.faces), 3, 3))
    for number, face in enumerate(mesh.faces):
        for corner, vertex in enumerate(face):
            near = np.array(around[vertex])
            smooth = near[unit[near] @ unit[number] >= _SHARP_COSINE]
            normals[number, corner] = weighted[smooth].sum(axis=0) + 1e-12 * unit[number]
    return normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-300)


def _index(text: str, count: int) -> int:
    """Wavefront counts from 1, and backwards from the newest with negative numbers."""
    number = int(text)
    return number - 1 if number > 0 else count + number


def _texture_of(material_file: Path) -> str:
    """The first texture that a material file names: pybullet uses one a mesh; or empty."""
    if not material_file.is_file():
        return ""
    lines = (line.split() for line in material_file.read_text(errors="replace").splitlines())
    return next((words[1] for words in lines if len(words) > 1 and words[0] == "map_Kd"), "")
