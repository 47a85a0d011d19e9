# SPDX-License-Identifier: Apache-2.0
"""What the motion problem needs to know of an arm beyond its URDF: names, hulls, rest pose.

The URDF names meshes that may not be on this machine, so the hand is covered by a box and the links
behind it by spheres, measured from the convex hulls of Franka's meshes. The unit tests hold them
against the meshes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


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
class RobotGeometry:
    """An arm with a parallel gripper.

    Attributes:
        arm_joints, finger_joints: names, in the order of q and of the two fingers.
        hand_link: frame whose z axis points out of the hand and whose y axis is the direction in
            which the fingers move.
        tcp_offset: distance of the tool centre point from the hand frame along z [m].
        finger_root, finger_tip: z of the fingers' upper and lower end in the hand frame [m].
        finger_thickness: half extent of a finger along the hand's x axis [m].
        finger_depth: extent of a finger outwards from its gripping face [m].
        finger_travel: distance of a gripping face from the middle when fully open [m].
        palm: z of the hand's lower face in the hand frame [m].
        hand_half: half extents of the hand with the flange along its x and y axes [m].
        hand_top: z of the flange's upper end in the hand frame [m].
        bodies: spheres that cover those parts of the links behind the hand that come near stacks.
        home: configuration of the arm at rest, in which it hides nothing from the camera [rad].
        acceleration: joint acceleration limits [rad/s²]; URDFs have none.
    """

    arm_joints: tuple[str, ...]
    finger_joints: tuple[str, str]
    hand_link: str
    tcp_offset: float
    finger_root: float
    finger_tip: float
    finger_thickness: float
    finger_depth: float
    finger_travel: float
    palm: float
    hand_half: tuple[float, float]
    hand_top: float
    bodies: tuple[BodySphere, ...]
    home: tuple[float, ...]
    acceleration: tuple[float, ...]


#: Franka Emika Panda with its hand. link7 is fixed to the hand but for the flange's 45 degrees, in
#: which its bulge comes to lie along the fingers' direction, so one box covers both.
PANDA: Final = RobotGeometry(
    arm_joints=tuple(f"panda_joint{index}" for index in range(1, 8)),
    finger_joints=("panda_finger_joint1", "panda_finger_joint2"),
    hand_link="panda_hand",
    tcp_offset=0.105,
    finger_root=0.0584,
    finger_tip=0.1125,
    finger_thickness=0.0105,
    finger_depth=0.0264,
    finger_travel=0.04,
    palm=0.066,
    hand_half=(0.044, 0.1155),
    hand_top=-0.055,
    bodies=(
        BodySphere("wrist", "panda_link6", (0.075, -0.028, 0.006), 0.064),
        BodySphere("wrist", "panda_link6", (0.076, 0.030, 0.000), 0.064),
        BodySphere("wrist", "panda_link6", (0.011, 0.006, 0.007), 0.064),
        BodySphere("forearm", "panda_link5", (0.001, 0.062, -0.010), 0.0755),
        BodySphere("forearm", "panda_link5", (-0.001, 0.045, -0.081), 0.0755),
        BodySphere("forearm", "panda_link5", (0.000, 0.034, -0.150), 0.0755),
        BodySphere("forearm", "panda_link5", (0.001, 0.009, -0.221), 0.0755),
    ),
    home=(0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785),
    acceleration=(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
)
