# SPDX-License-Identifier: Apache-2.0
"""Fewer triangles for the same surface: edge collapse by quadric error metrics.

Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997. Collapses that do
not touch each other are made at once, which lets numpy do the work; the result depends on nothing
but the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .wavefront import Mesh, face_normals

#: Weight of the planes that hold borders and seams of material in place.
_BORDER_WEIGHT = 1000.0
#: A collapse may not turn a face further than this, else surfaces would fold over.
_LEAST_TURN_COSINE = 0.5


@dataclass
class _Surface:
    """A mesh while it is simplified; quadrics and areas by vertex, (v, 4, 4) [m⁴] and (v,) [m²]."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    kept: NDArray[np.int64]
    quadrics: NDArray[np.float64]
    areas: NDArray[np.float64]


def simplify(mesh: Mesh, tolerance: float) -> Mesh:
    """The mesh with as few triangles as keep its surface in place.

    Args:
        tolerance: root mean square distance of a vertex from the planes of the faces that it
            stands for [m].
    """
    quadrics, areas = _quadrics(mesh)
    count = len(mesh.vertices)
    surface = _Surface(
        mesh.vertices.copy(), mesh.faces.copy(), np.arange(len(mesh.faces)), quadrics, areas
    )
    refused = np.zeros(0, dtype=np.int64)
    while True:
        keys = _edge_keys(surface.faces, count)
        edges = np.stack(np.divmod(keys[~np.isin(keys, refused)], count), axis=1)
        targets, costs = _targets(surface, edges)
        allowed = costs <= tolerance**2
        if not allowed.any():
            break
        edges, targets, costs = edges[allowed], targets[allowed], costs[allowed]
        chosen = _independent(edges, costs, surface.faces, count)
        edges, targets = edges[chosen], targets[chosen]
        folds = _folds(surface, edges, targets)
        refused = np.concatenate([refused, edges[folds, 0] * count + edges[folds, 1]])
        _collapse(surface, edges[~folds], targets[~folds])
    used, index = np.unique(surface.faces, return_inverse=True)
    return Mesh(
        surface.vertices[used],
        index.reshape(surface.faces.shape),
        mesh.parts[surface.kept],
        mesh.texture[surface.kept],
        mesh.image,
    )


def _quadrics(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sums over the faces at each vertex of area · p pᵀ, p its plane, and of the areas."""
    normals = face_normals(mesh.vertices, mesh.faces)
    lengths = np.linalg.norm(normals, axis=1)
    unit = normals / np.maximum(lengths, 1e-300)[:, None]
    planes = _planes(unit, mesh.vertices[mesh.faces[:, 0]])
    areas = lengths / 2.0
    quadrics = np.zeros((len(mesh.vertices), 4, 4))
    sums = np.zeros(len(mesh.vertices))
    weighted = areas[:, None, None] * planes[:, :, None] * planes[:, None, :]
    for corner in range(3):
        np.add.at(quadrics, mesh.faces[:, corner], weighted)
        np.add.at(sums, mesh.faces[:, corner], areas)
    for start, end, face in _border(mesh):
        along = mesh.vertices[end] - mesh.vertices[start]
        across = np.cross(along, unit[face])
        length = float(np.linalg.norm(across))
        if length > 0.0:
            plane = _planes(across / length, mesh.vertices[start])
            quadric = _BORDER_WEIGHT * length**2 * np.outer(plane, plane)
            quadrics[start] += quadric
            quadrics[end] += quadric
    return quadrics, sums


def _planes(normals: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Planes (n, -n·x) through points, shape (…, 4)."""
    offset = -(normals * points).sum(axis=-1, keepdims=True)
    return np.concatenate([normals, offset], axis=-1)


def _border(mesh: Mesh) -> list[tuple[int, int, int]]:
    """Edges (start, end, face) with no face, or one of another material, on their other side."""
    neighbours: dict[tuple[int, int], list[int]] = {}
    for number, face in enumerate(mesh.faces.tolist()):
        for start, end in zip(face, [*face[1:], face[0]]):
            neighbours.setdefault((min(start, end), max(start, end)), []).append(number)
    return [
        (start, end, face)
        for (start, end), faces in neighbours.items()
        if len(faces) == 1 or len({int(mesh.parts[face]) for face in faces}) > 1
        for face in faces
    ]


def _edge_keys(faces: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Each edge once, as smaller vertex · count + larger vertex, shape (e,)."""
    following = np.roll(faces, -1, axis=1)
    return np.unique(np.minimum(faces, following) * count + np.maximum(faces, following))


def _targets(
    surface: _Surface, edges: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where each edge's vertices would meet, shape (e, 3) [m], and the cost of it, (e,) [m²]."""
    first, second = edges.T
    quadrics = surface.quadrics[first] + surface.quadrics[second]
    areas = np.maximum(surface.areas[first] + surface.areas[second], 1e-300)
    middle = 0.5 * (surface.vertices[first] + surface.vertices[second])
    # The best point is far away where the surface is flat; a little pull keeps it at the edge.
    pull = 1e-5 * np.trace(quadrics[:, :3, :3], axis1=1, axis2=2) + 1e-30
    matrix = quadrics[:, :3, :3] + pull[:, None, None] * np.eye(3)
    side = pull[:, None] * middle - quadrics[:, :3, 3]
    targets = np.linalg.solve(matrix, side[:, :, None])[:, :, 0]
    homogeneous = np.concatenate([targets, np.ones((len(targets), 1))], axis=1)
    costs = np.einsum("ei,eij,ej->e", homogeneous, quadrics, homogeneous) / areas
    return targets, np.maximum(costs, 0.0)


def _independent(
    edges: NDArray[np.int64], costs: NDArray[np.float64], faces: NDArray[np.int64], count: int
) -> NDArray[np.int64]:
    """Indices of edges that are the cheapest of all that share a face with their faces."""
    order = np.lexsort((edges[:, 1], edges[:, 0], costs))
    rank = np.empty(len(edges), dtype=np.int64)
    rank[order] = np.arange(len(edges))
    least = np.full(count, len(edges))
    for end in range(2):
        np.minimum.at(least, edges[:, end], rank)
    around = least.copy()
    of_face = least[faces].min(axis=1)
    for corner in range(3):
        np.minimum.at(around, faces[:, corner], of_face)
    return np.flatnonzero((rank <= around[edges[:, 0]]) & (rank <= around[edges[:, 1]]))


def _folds(
    surface: _Surface, edges: NDArray[np.int64], targets: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Which of independent collapses would turn over a face that stays, shape (e,)."""
    collapse_of = np.full(len(surface.vertices), -1)
    collapse_of[edges[:, 0]] = collapse_of[edges[:, 1]] = np.arange(len(edges))
    moved = surface.vertices.copy()
    moved[edges[:, 0]] = moved[edges[:, 1]] = targets
    touched = collapse_of[surface.faces]
    staying = ((touched >= 0).sum(axis=1) == 1).nonzero()[0]
    faces = surface.faces[staying]
    old, new = face_normals(surface.vertices, faces), face_normals(moved, faces)
    sizes = np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
    folded = (old * new).sum(axis=1) < _LEAST_TURN_COSINE * sizes
    result = np.zeros(len(edges), dtype=np.bool_)
    result[touched[staying[folded]].max(axis=1)] = True
    return result


def _collapse(surface: _Surface, edges: NDArray[np.int64], targets: NDArray[np.float64]) -> None:
    first, second = edges.T
    surface.vertices[first] = targets
    surface.quadrics[first] += surface.quadrics[second]
    surface.areas[first] += surface.areas[second]
    renamed = np.arange(len(surface.vertices))
    renamed[second] = first
    faces = renamed[surface.faces]
    a, b, c = faces.T
    stays = (a != b) & (b != c) & (c != a)
    surface.faces, surface.kept = faces[stays], surface.kept[stays]
