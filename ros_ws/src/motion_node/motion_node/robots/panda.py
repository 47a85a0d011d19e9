# SPDX-License-Identifier: Apache-2.0
"""The Franka Emika Panda, measured from the convex hulls of Franka's meshes.

The unit tests hold the hulls against the meshes.
"""

from __future__ import annotations

from typing import Final

from .arm import Arm, BodySphere, Gripper
from .seeding import TurnedHome

#: Franka's hand. link7 is fixed to it but for the flange's 45 degrees, in which its bulge comes to
#: lie along the fingers' direction, so one box covers both.
FRANKA_HAND: Final = Gripper(
    hand_link="panda_hand",
    finger_joints=("panda_finger_joint1", "panda_finger_joint2"),
    tcp_offset=0.105,
    finger_tip=0.1125,
    finger_thickness=0.0105,
    finger_depth=0.0264,
    finger_travel=0.04,
    palm=0.066,
    hand_half=(0.044, 0.1155),
    hand_top=-0.055,
)

#: The arm with that hand.
PANDA: Final = Arm(
    name="panda",
    arm_joints=tuple(f"panda_joint{index}" for index in range(1, 8)),
    gripper=FRANKA_HAND,
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
    seeding=TurnedHome(swings=6, swing_step=0.35),
    upper_bodies=(
        BodySphere("elbow", "panda_link4", (-0.083, 0.082, 0.000), 0.0715),
        BodySphere("elbow", "panda_link4", (0.000, 0.000, 0.043), 0.0715),
        BodySphere("elbow", "panda_link4", (-0.055, 0.028, 0.031), 0.0715),
        BodySphere("upper arm", "panda_link3", (0.039, 0.034, -0.027), 0.0705),
        BodySphere("upper arm", "panda_link3", (0.082, 0.043, 0.000), 0.0705),
        BodySphere("upper arm", "panda_link3", (0.000, 0.000, -0.081), 0.0705),
        BodySphere("shoulder", "panda_link2", (0.000, -0.149, 0.000), 0.0775),
        BodySphere("shoulder", "panda_link2", (-0.010, 0.002, 0.058), 0.0775),
        BodySphere("shoulder", "panda_link2", (0.001, -0.059, 0.023), 0.0775),
        BodySphere("shoulder", "panda_link2", (0.006, 0.010, 0.053), 0.0775),
    ),
)
