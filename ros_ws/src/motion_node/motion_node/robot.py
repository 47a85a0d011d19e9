# SPDX-License-Identifier: Apache-2.0
"""What the motion problem needs to know of an arm beyond its URDF: names, hull boxes, rest pose.

The URDF names meshes that may not be on this machine, so each link that can come near a block is
covered by a box, measured from the convex hulls of Franka's collision meshes. The unit tests hold
the boxes against the meshes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class BodyBox:
    """A box that covers (part of) a link.

    Attributes:
        name: as a person calls it; it appears in the names of violated constraints.
        link: the link whose frame the box is fixed to.
        center, half: centre and half extents in the link's frame [m].
        across: which of the box's axes points across the arm, so that it parts the arm from a
            stack beside it, whichever way the arm points.
    """

    name: str
    link: str
    center: tuple[float, float, float]
    half: tuple[float, float, float]
    across: int


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
        bodies: boxes of the hand and the links behind it; the fingers come on top.
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
    bodies: tuple[BodyBox, ...]
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
    bodies=(
        BodyBox("hand", "panda_hand", (0.0, 0.0055, 0.0055), (0.044, 0.1100, 0.0605), 0),
        BodyBox("wrist", "panda_link6", (0.0422, 0.0153, 0.0062), (0.0902, 0.0666, 0.0504), 2),
        BodyBox("forearm", "panda_link5", (0.0, 0.055, -0.040), (0.056, 0.076, 0.093), 1),
        BodyBox("forearm", "panda_link5", (0.0, 0.030, -0.199), (0.056, 0.086, 0.066), 1),
    ),
    home=(0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785),
    acceleration=(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
)
