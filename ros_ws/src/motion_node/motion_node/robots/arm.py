# SPDX-License-Identifier: Apache-2.0
"""What the motion problem needs to know of an arm beyond its URDF: names, hulls, rest posture.

The URDF names meshes that may not be on this machine, so the hand is covered by a box and the links
behind it by spheres.
"""

from __future__ import annotations

from dataclasses import dataclass

from .seeding import Seeding


@dataclass(frozen=True)
class BodySphere:
    """A sphere that covers part of a link.

    Attributes:
        name: as a person calls it; it appears in the names of violated constraints.
        link: the link whose frame the sphere is fixed to.
        center: in the link's frame [m].
        radius: [m].
    """

    name: str
    link: str
    center: tuple[float, float, float]
    radius: float


@dataclass(frozen=True)
class Gripper:
    """A hand with two parallel fingers.

    Attributes:
        hand_link: frame whose z axis points out of the hand and whose y axis is the direction in
            which the fingers move.
        finger_joints: names; each joint's position is the distance of its gripping face from the
            middle [m].
        tcp_offset: distance of the tool centre point from the hand frame along z [m].
        finger_tip: z of the fingers' lower end in the hand frame [m].
        finger_thickness: half extent of a finger along the hand's x axis [m].
        finger_depth: extent of a finger outwards from its gripping face [m].
        finger_travel: distance of a gripping face from the middle when fully open [m].
        palm: z of the hand's lower face in the hand frame [m].
        hand_half: half extents of the hand with the flange along its x and y axes [m].
        hand_top: z of the flange's upper end in the hand frame [m].
    """

    hand_link: str
    finger_joints: tuple[str, str]
    tcp_offset: float
    finger_tip: float
    finger_thickness: float
    finger_depth: float
    finger_travel: float
    palm: float
    hand_half: tuple[float, float]
    hand_top: float


@dataclass(frozen=True)
class Arm:
    """An arm with a gripper.

    Attributes:
        name: the value of the parameter ``robot`` that selects it.
        arm_joints: names, in the order of q, shape (n,) everywhere.
        gripper: what is fixed to its last link.
        bodies: spheres that cover those parts of the links behind the hand that come near stacks.
        upper_bodies: spheres that cover the links above those, which come near obstacles only.
        home: configuration at rest, in which the arm hides nothing from the camera, (n,) [rad].
        acceleration: joint acceleration limits, (n,) [rad/s²]; URDFs have none.
        seeding: where its inverse kinematics starts.
    """

    name: str
    arm_joints: tuple[str, ...]
    gripper: Gripper
    bodies: tuple[BodySphere, ...]
    home: tuple[float, ...]
    acceleration: tuple[float, ...]
    seeding: Seeding
    upper_bodies: tuple[BodySphere, ...] = ()

    def __post_init__(self) -> None:
        """Raises ValueError if ``home`` or ``acceleration`` is not one number a joint."""
        for field in ("home", "acceleration"):
            if len(getattr(self, field)) != len(self.arm_joints):
                raise ValueError(
                    f"{field} of {self.name} has {len(getattr(self, field))} numbers; "
                    f"it has {len(self.arm_joints)} joints"
                )

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The arm's joints, then the fingers', as messages name them."""
        return self.arm_joints + self.gripper.finger_joints
