# SPDX-License-Identifier: Apache-2.0
"""The KUKA LBR iiwa 7 with Franka's hand on its flange, as the simulator has it.

The hulls are measured from the meshes that pybullet ships; the unit tests hold them against those.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from .arm import Arm, BodySphere
from .panda import FRANKA_HAND
from .seeding import TurnedHome

#: The round flange is wider than the hand.
_HAND: Final = replace(FRANKA_HAND, hand_half=(0.053, 0.1155))

KUKA_IIWA: Final = Arm(
    name="kuka_iiwa",
    arm_joints=tuple(f"lbr_iiwa_joint_{index}" for index in range(1, 8)),
    gripper=_HAND,
    bodies=(
        BodySphere("wrist", "lbr_iiwa_link_6", (0.001, -0.025, -0.006), 0.081),
        BodySphere("wrist", "lbr_iiwa_link_6", (-0.002, 0.030, -0.006), 0.080),
        BodySphere("forearm", "lbr_iiwa_link_5", (-0.006, 0.069, 0.196), 0.075),
        BodySphere("forearm", "lbr_iiwa_link_5", (0.001, 0.029, 0.087), 0.075),
        BodySphere("forearm", "lbr_iiwa_link_5", (0.000, 0.000, 0.028), 0.076),
    ),
    home=(0.0, 0.0, 0.0, -1.571, 0.0, 1.571, 0.0),
    acceleration=(8.0,) * 7,
    seeding=TurnedHome(swings=6, swing_step=0.35),
    upper_bodies=(
        BodySphere("elbow", "lbr_iiwa_link_4", (0.003, 0.080, 0.056), 0.078),
        BodySphere("elbow", "lbr_iiwa_link_4", (0.000, -0.001, 0.039), 0.081),
        BodySphere("elbow", "lbr_iiwa_link_4", (0.000, 0.159, 0.000), 0.076),
        BodySphere("upper arm", "lbr_iiwa_link_3", (0.000, 0.039, 0.216), 0.081),
        BodySphere("upper arm", "lbr_iiwa_link_3", (-0.001, 0.060, 0.134), 0.081),
        BodySphere("upper arm", "lbr_iiwa_link_3", (0.000, 0.000, 0.042), 0.083),
        BodySphere("shoulder", "lbr_iiwa_link_2", (0.014, 0.041, 0.049), 0.095),
        BodySphere("shoulder", "lbr_iiwa_link_2", (-0.007, 0.157, 0.009), 0.096),
        BodySphere("shoulder", "lbr_iiwa_link_2", (0.000, -0.001, 0.039), 0.097),
    ),
)
