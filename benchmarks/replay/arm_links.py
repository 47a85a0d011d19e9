# SPDX-License-Identifier: Apache-2.0
"""Arm and bodies as pybullet has them: the second engine gets the same masses and shapes."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pybullet
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from sim_node.meshes.wavefront import read_obj
from sim_node.world import World

from .recording import BOX, CYLINDER, SPHERE, Body, RecordingError

_SHAPES: Final = {
    pybullet.GEOM_BOX: BOX,
    pybullet.GEOM_CYLINDER: CYLINDER,
    pybullet.GEOM_SPHERE: SPHERE,
}
_KINDS: Final = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "fixed": ""}


@dataclass(frozen=True)
class Link:
    """A link with the joint that carries it.

    Attributes:
        name, parent: of the links; the parent is empty for the root.
        position, quaternion: pose at joint position 0 in the parent [m; x, y, z, w].
        joint: name of the joint; empty where it cannot move.
        kind: ``hinge``, ``slide`` or empty.
        axis: in the link's frame, shape (3,).
        lower, upper: the joint's limits [rad or m].
        effort: what its motor can do at most [N·m or N].
        mass: [kg]
        center: of mass, in the link, shape (3,) [m].
        inertia: about that along the link's axes, shape (3,) [kg m²]; as pybullet computes it
            from the shapes, since those in Franka's URDF are made up (0.1 for every link).
        friction: as :attr:`Body.friction`.
        hull: corners of the convex collision shape in the link, shape (v, 3) [m]; None: no shape.
    """

    name: str
    parent: str
    position: NDArray[np.float64]
    quaternion: NDArray[np.float64]
    joint: str
    kind: str
    axis: NDArray[np.float64]
    lower: float
    upper: float
    effort: float
    mass: float
    center: NDArray[np.float64]
    inertia: NDArray[np.float64]
    friction: tuple[float, float, float]
    hull: NDArray[np.float64] | None


def arm_links(world: World) -> tuple[Link, ...]:
    """The arm's links, parents first."""
    root = ElementTree.parse(world.arm.urdf).getroot()
    count = pybullet.getNumJoints(world.robot, physicsClientId=world.client)
    numbers = {
        pybullet.getJointInfo(world.robot, index, physicsClientId=world.client)[12].decode(): index
        for index in range(count)
    }
    joints = {_child(joint): joint for joint in root.findall("joint")}
    links = []
    for element in root.findall("link"):
        name = element.get("name", "")
        joint = joints.get(name)
        index = numbers.get(name, -1)
        dynamics = pybullet.getDynamicsInfo(world.robot, index, physicsClientId=world.client)
        turn = Rotation.from_quat(dynamics[4]).as_matrix()
        inertia = turn @ np.diag(dynamics[2]) @ turn.T
        if np.abs(inertia - np.diag(np.diag(inertia))).max() > 1e-9:
            raise RecordingError(f"{name}'s inertia does not lie along the link's axes")
        kind, moving = "", ""
        position, quaternion = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])
        axis, limit = np.array([0.0, 0.0, 1.0]), {}
        if joint is not None:
            kind = _KINDS[joint.get("type", "")]
            moving = joint.get("name", "") if kind else ""
            position, quaternion = _origin(joint)
            if kind:
                axis = _numbers(_attribute(joint, "axis", "xyz", "1 0 0"))
                found = joint.find("limit")
                limit = dict(found.attrib) if found is not None else {}
        links.append(
            Link(
                name=name,
                parent=_attribute(joint, "parent", "link", "") if joint is not None else "",
                position=position,
                quaternion=quaternion,
                joint=moving,
                kind=kind,
                axis=axis,
                lower=float(limit.get("lower", 0.0)),
                upper=float(limit.get("upper", 0.0)),
                effort=float(limit.get("effort", 0.0)),
                mass=dynamics[0],
                center=np.array(dynamics[3]),
                inertia=np.diag(inertia).copy(),
                friction=(dynamics[1], dynamics[7], dynamics[6]),
                hull=_hull(element, world),
            )
        )
    return tuple(links)


def bodies_in(world: World) -> tuple[Body, ...]:
    """All bodies but the arm, as they stand now.

    Raises:
        RecordingError: a body is of a shape that the replay does not know.
    """
    names = {world.body(name): name for name in world.names}
    bodies = []
    for number in range(pybullet.getNumBodies(physicsClientId=world.client)):
        body = pybullet.getBodyUniqueId(number, physicsClientId=world.client)
        if body == world.robot:
            continue
        name = names.get(body, f"fixed_{body}")
        shapes = pybullet.getCollisionShapeData(body, -1, physicsClientId=world.client)
        if not shapes:
            continue  # only seen, not touched
        if len(shapes) != 1 or shapes[0][2] not in _SHAPES:
            raise RecordingError(f"{name} is neither box, cylinder nor sphere")
        kind, extents = _SHAPES[shapes[0][2]], shapes[0][3]
        if kind == CYLINDER:  # height, radius
            extents = (2 * extents[1], 2 * extents[1], extents[0])
        elif kind == SPHERE:  # radius
            extents = (2 * extents[0],) * 3
        position, quaternion = pybullet.getBasePositionAndOrientation(
            body, physicsClientId=world.client
        )
        dynamics = pybullet.getDynamicsInfo(body, -1, physicsClientId=world.client)
        if dynamics[0] > 0.0 and body not in names:
            raise RecordingError(f"{name} can be moved and is no block; the replay has only blocks")
        friction = (dynamics[1], dynamics[7], dynamics[6])
        bodies.append(Body(name, kind, tuple(extents), dynamics[0], friction, position, quaternion))
    return tuple(bodies)


def _hull(link: ElementTree.Element, world: World) -> NDArray[np.float64] | None:
    """The convex hull of a link's collision meshes: pybullet takes the hull of each, too."""
    corners = []
    for shape in link.findall("collision"):
        mesh = shape.find("geometry/mesh")
        if mesh is None:
            raise RecordingError(f"a collision shape of {link.get('name')} is no mesh")
        name = mesh.get("filename", "").removeprefix("package://")
        vertices = read_obj(world.arm.urdf.parent / name).vertices
        vertices = vertices * _numbers(mesh.get("scale", "1 1 1"))
        position, quaternion = _origin(shape)
        corners.append(Rotation.from_quat(quaternion).apply(vertices) + position)
    if not corners:
        return None
    if len(corners) > 1:
        raise RecordingError(f"{link.get('name')} has several collision shapes")
    return np.asarray(corners[0][ConvexHull(corners[0]).vertices])


def _child(joint: ElementTree.Element) -> str:
    return _attribute(joint, "child", "link", "")


def _attribute(element: ElementTree.Element, tag: str, key: str, default: str) -> str:
    found = element.find(tag)
    return default if found is None else found.get(key, default)


def _origin(element: ElementTree.Element) -> tuple[NDArray[Any], NDArray[Any]]:
    turn = _numbers(_attribute(element, "origin", "rpy", "0 0 0"))
    position = _numbers(_attribute(element, "origin", "xyz", "0 0 0"))
    return position, Rotation.from_euler("xyz", turn).as_quat()


def _numbers(text: str) -> NDArray[np.float64]:
    return np.array([float(word) for word in text.split()])
