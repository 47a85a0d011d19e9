# SPDX-License-Identifier: Apache-2.0
"""URDF text to forward kinematics, symbolic in CasADi: one description for all bounds."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..errors import RobotDescriptionError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Joint:
    """One joint of a robot description.

    Attributes:
        kind: ``revolute``, ``continuous``, ``prismatic`` or ``fixed``.
        parent_from_joint: 4x4 transform of the joint frame at position 0 in the parent link.
        axis: unit vector in the joint frame, shape (3,).
        lower, upper: position limits [rad or m].
        velocity: velocity limit [rad/s or m/s].
    """

    name: str
    kind: str
    parent: str
    child: str
    parent_from_joint: Array
    axis: Array
    lower: float
    upper: float
    velocity: float

    def moved(self, value: float) -> Array:
        """Transform (4, 4) of the child link in the joint frame at a position [rad or m]."""
        result = np.eye(4)
        if self.kind == "prismatic":
            result[:3, 3] = self.axis * value
        else:
            x, y, z = self.axis
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            result[:3, :3] += np.sin(value) * cross + (1 - np.cos(value)) * cross @ cross
        return result


def _numbers(text: str | None, default: str) -> Array:
    return np.array([float(value) for value in (text or default).split()])


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Rotation matrix (3, 3) of fixed-axis roll, pitch, yaw [rad] (the URDF convention)."""
    (cr, sr), (cp, sp), (cy, sy) = [(np.cos(a), np.sin(a)) for a in (roll, pitch, yaw)]
    matrix = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    # Quarter turns are written with few digits in URDFs; exact zeros keep the expressions small.
    rounded = np.round(matrix)
    return np.asarray(np.where(np.abs(matrix - rounded) < 1e-9, rounded, matrix))


def _parse_joint(element: ET.Element) -> Joint:
    name = element.get("name", "")
    try:
        kind = element.attrib["type"]
        parent, child = element.find("parent"), element.find("child")
        assert parent is not None and child is not None
        origin, axis, limit = element.find("origin"), element.find("axis"), element.find("limit")
        transform = np.eye(4)
        if origin is not None:
            transform[:3, :3] = rotation_from_rpy(*_numbers(origin.get("rpy"), "0 0 0"))
            transform[:3, 3] = _numbers(origin.get("xyz"), "0 0 0")
        direction = _numbers(axis.get("xyz") if axis is not None else None, "1 0 0")
        if kind != "fixed":
            direction = direction / np.linalg.norm(direction)
        bounded = limit is not None and kind in ("revolute", "prismatic")
        values = limit.attrib if limit is not None else {}
        return Joint(
            name=name,
            kind=kind,
            parent=parent.attrib["link"],
            child=child.attrib["link"],
            parent_from_joint=transform,
            axis=direction,
            lower=float(values.get("lower", 0.0)) if bounded else -np.inf,
            upper=float(values.get("upper", 0.0)) if bounded else np.inf,
            velocity=float(values.get("velocity", np.inf)),
        )
    except (AssertionError, KeyError, ValueError, TypeError) as error:
        raise RobotDescriptionError(f"joint {name!r} is malformed: {error!r}", name) from error


class Kinematics:
    """Forward kinematics of a tree of joints, for a chosen vector q of actuated joints.

    Args:
        description: the URDF's text.
        joints: names of the joints that make up q, in order; all others stay at position 0.

    Raises:
        RobotDescriptionError: if the text is not a URDF, or a joint is missing or cannot move.
    """

    def __init__(self, description: str, joints: Sequence[str]) -> None:
        try:
            root = ET.fromstring(description)
        except ET.ParseError as error:
            raise RobotDescriptionError(f"the robot description is not XML: {error}") from error
        self.links = {element.get("name", "") for element in root.iter("link")}
        parsed = [_parse_joint(element) for element in root.findall("joint")]
        by_name = {joint.name: joint for joint in parsed}
        for name in joints:
            if name not in by_name or by_name[name].kind == "fixed":
                raise RobotDescriptionError(
                    f"the robot description has no movable joint {name!r}; it has "
                    f"{', '.join(sorted(j.name for j in parsed if j.kind != 'fixed'))}",
                    name,
                )
        self.joints = [by_name[name] for name in joints]
        self.by_child = {joint.child: joint for joint in parsed}
        self.position_in_q = {name: index for index, name in enumerate(joints)}

    @property
    def root(self) -> str:
        """The link that is nobody's child; the world frame of all poses."""
        return min(self.links - set(self.by_child), default="")

    @property
    def lower(self) -> Array:
        """Lower position limits of q, shape (n,) [rad or m]."""
        return np.array([joint.lower for joint in self.joints])

    @property
    def upper(self) -> Array:
        """Upper position limits of q, shape (n,) [rad or m]."""
        return np.array([joint.upper for joint in self.joints])

    @property
    def velocity(self) -> Array:
        """Velocity limits of q, shape (n,) [rad/s or m/s]."""
        return np.array([joint.velocity for joint in self.joints])

    def link_poses(self, q: ca.SX) -> Callable[[str], tuple[ca.SX, ca.SX]]:
        """Symbolic poses of links: name -> (rotation (3, 3), position (3, 1)) in the root frame.

        The root link of the description is the world frame. Shared parts of the chain are
        evaluated once. The function raises RobotDescriptionError if a link does not exist.
        """
        cache: dict[str, tuple[ca.SX, ca.SX]] = {}

        def pose(link: str) -> tuple[ca.SX, ca.SX]:
            if link not in cache:
                cache[link] = self._pose_by_parent(link, q, pose)
            return cache[link]

        def checked(link: str) -> tuple[ca.SX, ca.SX]:
            self.check_links([link])
            return pose(link)

        return checked

    def check_links(self, links: Sequence[str]) -> None:
        """Raises RobotDescriptionError if a link does not exist."""
        for link in links:
            if link not in self.links:
                raise RobotDescriptionError(f"the robot description has no link {link!r}", link)

    def _pose_by_parent(
        self, link: str, q: ca.SX, pose: Callable[[str], tuple[ca.SX, ca.SX]]
    ) -> tuple[ca.SX, ca.SX]:
        joint = self.by_child.get(link)
        if joint is None:
            return ca.SX.eye(3), ca.SX.zeros(3, 1)
        parent_rotation, parent_position = pose(joint.parent)
        offset = ca.sparsify(ca.SX(joint.parent_from_joint[:3, 3]))
        fixed = ca.sparsify(ca.SX(joint.parent_from_joint[:3, :3]))
        position = parent_position + parent_rotation @ offset
        rotation = parent_rotation @ fixed
        if joint.name in self.position_in_q:
            value = q[self.position_in_q[joint.name]]
            axis = ca.SX(joint.axis)
            if joint.kind == "prismatic":
                position = position + rotation @ ca.sparsify(axis) * value
            else:
                rotation = rotation @ _rotation_about(joint.axis, value)
        return rotation, position

    def pose_at(self, link: str, q: Array) -> Array:
        """Transform (4, 4) of a link in the world, in numbers; any thread may ask.

        Raises:
            RobotDescriptionError: if the link does not exist.
        """
        self.check_links([link])
        world_from_link = np.eye(4)
        while (joint := self.by_child.get(link)) is not None:
            parent_from_link = joint.parent_from_joint
            if joint.name in self.position_in_q:
                parent_from_link = parent_from_link @ joint.moved(q[self.position_in_q[joint.name]])
            world_from_link = parent_from_link @ world_from_link
            link = joint.parent
        return world_from_link

    def pose_function(self, link: str) -> ca.Function:
        """CasADi function q (n,) -> (rotation (3, 3), position (3,)) of a link in the world."""
        q = ca.SX.sym("q", len(self.joints))
        rotation, position = self.link_poses(q)(link)
        return ca.Function(f"world_from_{link}", [q], [ca.densify(rotation), ca.densify(position)])


def _rotation_about(axis: Array, angle: ca.SX) -> ca.SX:
    """Rotation matrix about a unit axis (Rodrigues), sparse where the axis allows it."""
    x, y, z = (float(value) for value in axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    squared = cross @ cross
    return (
        ca.SX.eye(3)
        + ca.sparsify(ca.SX(cross)) * ca.sin(angle)
        + ca.sparsify(ca.SX(squared)) * (1 - ca.cos(angle))
    )
