# SPDX-License-Identifier: Apache-2.0
"""Where an arm's surface is seen: its robot description, posed and looked at along rays."""

from __future__ import annotations

import functools
import itertools
import os
import tempfile
import weakref
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import pybullet
from numpy.typing import NDArray

from ..camera import PinholeCamera
from ..errors import RobotDescriptionError

Array = NDArray[np.float64]

#: So many rays are cast at most: the fewer, the further apart the pixels are.
MOST_RAYS: Final = 8000
#: So wide is the rim of what is seen of it, twice [px of the grid].
RIM: Final = 11
#: The arm is looked for between these depths [m].
_NEAREST, _FURTHEST = 0.15, 4.0
#: Which of its greatest coordinates each corner of a box has.
_CORNERS: Final = tuple(itertools.product((False, True), repeat=3))
#: Of links that have none: it moves nothing here.
_INERTIAL: Final = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)
#: Files of meshes that pybullet reads.
_MESHES: Final = (".obj", ".stl", ".dae")


@dataclass(frozen=True)
class SeenArm:
    """Where the arm's surface is on a grid of a picture's pixels, if nothing is before it.

    Attributes:
        rows, columns: of the grid, shapes (m,) and (n,) [px]; the columns are their own mirror
            image: the k-th from the left is as far from that edge as the k-th from the right from
            the other one.
        depth: of the surface along the optical axis, shape (m, n) [m]; NaN where it is not. Empty
            where the arm is outside the picture.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    depth: NDArray[np.float32]

    @functools.cached_property
    def inner(self) -> NDArray[np.bool_]:
        """Where it is, but for its rim: the arm may be thinner than its shapes."""
        known = np.pad(np.isfinite(self.depth), 1, mode="edge").astype(np.uint8)
        inner = cv2.erode(known, np.ones((RIM, RIM), np.uint8))[1:-1, 1:-1]
        return np.asarray(inner, bool)


class ArmShape:
    """The bodies of a robot description; its root stands in the origin of the world.

    Kinematics, shapes and rays are pybullet's, in a world of its own that holds nothing else.

    Args:
        description: the URDF's text. Of a link its collision shapes are taken, or what it looks
            like where it has none; meshes whose files are not on this machine are left out.

    Attributes:
        root: name of the link that stands in the origin.

    Raises:
        RobotDescriptionError: it is no URDF, or no shape is left.
    """

    def __init__(self, description: str) -> None:
        text, self.root = _bodies_only(description)
        self._client = pybullet.connect(pybullet.DIRECT)
        freed = weakref.finalize(self, pybullet.disconnect, self._client)
        freed.atexit = False
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "arm.urdf"
            path.write_text(text, encoding="utf-8")
            try:
                self._body = pybullet.loadURDF(
                    str(path), useFixedBase=True, physicsClientId=self._client
                )
            except pybullet.error as error:
                raise RobotDescriptionError(f"pybullet cannot load it: {error}") from error
        count = pybullet.getNumJoints(self._body, physicsClientId=self._client)
        infos = [
            pybullet.getJointInfo(self._body, index, physicsClientId=self._client)
            for index in range(count)
        ]
        self._links = [-1, *range(count)]
        self._joints = {
            info[1].decode(): info[0] for info in infos if info[2] != pybullet.JOINT_FIXED
        }
        self._mimics = _mimics(text)

    def posed(self, positions: Mapping[str, float]) -> dict[str, float] | None:
        """Positions of all joints that move, by name; None where one is not told [rad, m].

        Args:
            positions: as joint_states tell them; those of other joints are passed over.
        """
        told = {}
        for name in self._joints:
            value = positions.get(name)
            if value is None and name in self._mimics:
                other, factor, offset = self._mimics[name]
                value = positions.get(other)
                value = None if value is None else factor * value + offset
            if value is None or not np.isfinite(value):
                return None
            told[name] = value
        return told

    def seen_by(self, camera: PinholeCamera, positions: Mapping[str, float]) -> SeenArm:
        """Where the arm is in a camera's picture.

        Args:
            positions: of all joints, see :meth:`posed` [rad, m].
        """
        for name, value in positions.items():
            pybullet.resetJointState(
                self._body, self._joints[name], value, physicsClientId=self._client
            )
        pybullet.performCollisionDetection(physicsClientId=self._client)  # poses the shapes
        rows, columns, looks = self._grid(camera)
        depth = np.full(looks.shape, np.nan, np.float32)
        if not looks.any():
            return SeenArm(rows, columns, depth)
        down, across = np.nonzero(looks)
        rays = camera.rays_world(np.stack([columns[across], rows[down]], axis=-1))
        eye = camera.position_world
        hits = pybullet.rayTestBatch(
            (eye + _NEAREST * rays).tolist(),
            (eye + _FURTHEST * rays).tolist(),
            numThreads=1,
            physicsClientId=self._client,
        )
        share = np.array([hit[2] if hit[0] == self._body else np.nan for hit in hits])
        depth[looks] = _NEAREST + share * (_FURTHEST - _NEAREST)
        return SeenArm(rows, columns, depth)

    def _grid(
        self, camera: PinholeCamera
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Rows and columns of pixels, evenly, over where the arm may be and its mirror image, and
        at which of them it may be."""
        low, high = np.array(
            [
                pybullet.getAABB(self._body, link, physicsClientId=self._client)
                for link in self._links
            ]
        ).swapaxes(0, 1)
        corners = np.array([np.where(choice, high, low) for choice in _CORNERS])
        pixels = camera.project(corners)  # (8, links, 2)
        last = np.array([camera.width - 1.0, camera.height - 1.0])
        first, final = pixels.min(axis=0), pixels.max(axis=0)
        behind = np.isnan(first).any(axis=1)  # the camera; it may then be anywhere in the picture
        first[behind], final[behind] = 0.0, last
        seen = ((final >= 0.0) & (first <= last)).all(axis=1)
        first, final = (np.clip(edge[seen], 0.0, last) for edge in (first, final))
        area = float(np.prod(final - first + 1.0, axis=1).sum())
        apart = max(1.0, float(np.sqrt(area / MOST_RAYS)))
        rows = np.unique(np.rint(np.arange(0.0, last[1] + 1e-9, apart)))
        half = np.rint(np.arange(last[0] / 2.0, last[0] + 1e-9, apart))
        columns = np.unique(np.concatenate([last[0] - half, half]))
        looks = np.zeros((len(rows), len(columns)), bool)
        for (left, top), (right, bottom) in zip(first, final):
            down = slice(*np.searchsorted(rows, (top, bottom + 1.0)))
            across = slice(*np.searchsorted(columns, (left, right + 1.0)))
            looks[down, across] = True
        kept_rows, kept_columns = (np.asarray(looks.any(axis=axis)) for axis in (1, 0))
        kept_columns |= kept_columns[::-1].copy()
        return (
            rows[kept_rows].astype(np.intp),
            columns[kept_columns].astype(np.intp),
            looks[np.ix_(kept_rows, kept_columns)],
        )


def _bodies_only(description: str) -> tuple[str, str]:
    """A robot description whose links have collision shapes only, and its root link.

    Raises:
        RobotDescriptionError: it is no URDF, or no shape is left.
    """
    try:
        robot = ElementTree.fromstring(description)
    except ElementTree.ParseError as error:
        raise RobotDescriptionError(f"it is not XML: {error}") from error
    shapes = 0
    for link in robot.iter("link"):
        bodies = link.findall("collision") or link.findall("visual")
        for element in link.findall("collision") + link.findall("visual"):
            link.remove(element)
        if link.find("inertial") is None:  # pybullet would complain about each
            link.append(ElementTree.fromstring(_INERTIAL))
        for body in filter(_is_usable, bodies):
            body.tag = "collision"
            link.append(body)
            shapes += 1
    if not shapes:
        raise RobotDescriptionError(
            "no link has a box, a cylinder, a sphere or a mesh whose file is on this machine"
        )
    links = {link.get("name", "") for link in robot.iter("link")}
    children = {element.get("link", "") for element in robot.findall("joint/child")}
    return ElementTree.tostring(robot, encoding="unicode"), min(links - children, default="")


def _is_usable(body: ElementTree.Element) -> bool:
    """Whether a shape can be read; a mesh then has the path of its file, and is no hull."""
    mesh = body.find("geometry/mesh")
    if mesh is None:
        return body.find("geometry") is not None
    path = _file_of(mesh.get("filename", ""))
    if path is None or path.suffix.lower() not in _MESHES:
        return False
    mesh.set("filename", str(path))
    body.set("concave", "yes")
    return True


def _file_of(uri: str) -> Path | None:
    """Of a mesh; None where it is not on this machine."""
    kind, _, rest = uri.rpartition("://")
    paths = [Path(rest)]
    if kind == "package":
        prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
        paths = [Path(prefix, "share", rest) for prefix in prefixes if prefix]
    return next((path for path in paths if path.is_file()), None)


def _mimics(description: str) -> dict[str, tuple[str, float, float]]:
    """Of each joint that follows another one: that one, a factor and an offset."""
    found: dict[str, tuple[str, float, float]] = {}
    for joint in ElementTree.fromstring(description).findall("joint"):
        mimic: Any = joint.find("mimic")
        if mimic is not None:
            factor, offset = (
                float(mimic.get(key, default))
                for key, default in (("multiplier", "1"), ("offset", "0"))
            )
            found[joint.get("name", "")] = (mimic.get("joint", ""), factor, offset)
    return found
