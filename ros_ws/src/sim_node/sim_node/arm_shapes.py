# SPDX-License-Identifier: Apache-2.0
"""Boxes that stand for the meshes of a robot description, where nobody else has the files."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from .meshes.wavefront import read_obj

#: How thick the slices are that get a box each, at most [m].
SLICE: Final = 0.04


@dataclass(frozen=True)
class Box:
    """A box along the axes of a mesh's frame: its centre and its full extents, (3,) [m]."""

    center: NDArray[np.float64]
    size: NDArray[np.float64]


def boxes_around(
    vertices: NDArray[np.float64], faces: NDArray[np.int64], thickness: float = SLICE
) -> list[Box]:
    """Boxes that cover a surface: it is sliced across its longest axis, each slice gets one.

    Args:
        vertices: shape (v, 3) [m].
        faces: indices of vertices, shape (f, 3).
        thickness: of a slice, at most [m].
    """
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    axis = int(np.argmax(upper - lower))
    count = max(int(np.ceil((upper - lower)[axis] / thickness)), 1)
    edges = np.linspace(lower[axis], upper[axis], count + 1)
    corners = vertices[faces]
    boxes = []
    for low, high in itertools.pairwise(edges):
        inside = _clipped(corners, axis, low, high)
        if len(inside):
            start, end = inside.min(axis=0), inside.max(axis=0)
            boxes.append(Box(0.5 * (start + end), end - start))
    return boxes


def _clipped(
    corners: NDArray[np.float64], axis: int, low: float, high: float
) -> NDArray[np.float64]:
    """The corners of what triangles (f, 3, 3) have between two planes across an axis, (c, 3)."""
    points = corners.reshape(-1, 3)
    found = [points[(points[:, axis] >= low) & (points[:, axis] <= high)]]
    starts, ends = points, np.roll(corners, -1, axis=1).reshape(-1, 3)
    for plane in (low, high):
        before, after = starts[:, axis] - plane, ends[:, axis] - plane
        crosses = before * after < 0.0
        share = (before[crosses] / (before[crosses] - after[crosses]))[:, None]
        found.append(starts[crosses] + share * (ends[crosses] - starts[crosses]))
    return np.concatenate(found)


def with_boxes(description: str, path_of: Callable[[str], Path]) -> str:
    """The robot description with boxes in place of its meshes; joints and inertias stay.

    A link is drawn as its collision shapes are, since those have few faces; where it has none, as
    its visual meshes. A mesh that is no Wavefront file is left out.

    Args:
        description: a URDF's text.
        path_of: gives the file of a mesh's ``filename``.

    Raises:
        OSError: if a mesh cannot be read.
    """
    root = ElementTree.fromstring(description)
    boxes_of: dict[str, list[Box]] = {}
    for link in root.iter("link"):
        collisions = [item for item in link.findall("collision") if _mesh(item) is not None]
        visuals = [item for item in link.findall("visual") if _mesh(item) is not None]
        covers = [box for item in collisions for box in _cover(item, path_of, boxes_of)]
        looks = covers or [box for item in visuals for box in _cover(item, path_of, boxes_of)]
        material = visuals[0].find("material") if visuals else None
        for item in collisions + visuals:
            link.remove(item)
        for tag, elements, boxes in (("visual", visuals, looks), ("collision", collisions, covers)):
            for shape in boxes if elements else ():
                new = ElementTree.SubElement(link, tag)
                new.extend(shape)
                if tag == "visual" and material is not None:
                    new.append(material)
    return ElementTree.tostring(root, encoding="unicode")


def _mesh(element: ElementTree.Element) -> ElementTree.Element | None:
    return element.find("geometry/mesh")


def _cover(
    element: ElementTree.Element, path_of: Callable[[str], Path], known: dict[str, list[Box]]
) -> list[list[ElementTree.Element]]:
    """Origin and geometry of each box around a visual's or a collision's mesh, in the link."""
    mesh = _mesh(element)
    assert mesh is not None
    path = path_of(mesh.get("filename", ""))
    scale = mesh.get("scale", "1 1 1")
    key = f"{path} {scale}"
    if key not in known:
        known[key] = []
        if path.suffix == ".obj":
            surface = read_obj(path)
            known[key] = boxes_around(surface.vertices * _numbers(scale), surface.faces)
    origin = element.find("origin")
    rpy, xyz = "0 0 0", "0 0 0"
    if origin is not None:
        rpy, xyz = origin.get("rpy", rpy), origin.get("xyz", xyz)
    turn = Rotation.from_euler("xyz", _numbers(rpy))
    found = []
    for box in known[key]:
        center = turn.apply(box.center) + _numbers(xyz)
        geometry = ElementTree.Element("geometry")
        ElementTree.SubElement(geometry, "box", size=_text(box.size))
        found.append([ElementTree.Element("origin", rpy=rpy, xyz=_text(center)), geometry])
    return found


def _numbers(text: str) -> NDArray[np.float64]:
    return np.array([float(word) for word in text.split()])


def _text(values: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.4f}" for value in values)
