# SPDX-License-Identifier: Apache-2.0
"""Another arm: the KUKA iiwa that pybullet ships, with Franka's hand screwed to its flange.

All that the motion problem knows of an arm beyond its URDF is one value. In the project itself it
is a file in motion_node/robots/ and an entry in ``ARMS``, and the parameter ``robot`` selects it;
by now this arm stands there too, measured more carefully, as `kuka_iiwa`.

    python examples/another_arm.py
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pybullet_data

from motion_node import PANDA, Arm, BodySphere, MotionPlanner
from scene_graph import Move, format_stacks
from sim_node import World, true_scene_graph

KUKA_URDF = Path(pybullet_data.getDataPath()) / "kuka_iiwa" / "model.urdf"

#: A frame for the hand: z out of the flange, y in the direction of the fingers.
HAND = """
  <link name="hand"/>
  <joint name="hand_joint" type="fixed">
    <parent link="lbr_iiwa_link_7"/> <child link="hand"/>
    <origin xyz="0 0 0.1" rpy="0 0 0"/>
  </joint>
</robot>"""

KUKA = Arm(
    name="kuka_iiwa",
    arm_joints=tuple(f"lbr_iiwa_joint_{index}" for index in range(1, 8)),
    gripper=replace(PANDA.gripper, hand_link="hand"),
    # Spheres around the wrist and the forearm, which come near the stacks.
    bodies=(
        BodySphere("wrist", "lbr_iiwa_link_6", (0.0, 0.0, 0.0), 0.09),
        BodySphere("forearm", "lbr_iiwa_link_5", (0.0, 0.02, 0.05), 0.09),
        BodySphere("forearm", "lbr_iiwa_link_5", (0.0, 0.03, 0.16), 0.09),
    ),
    home=(0.0, 0.3, 0.0, -1.6, 0.0, 1.24, 0.0),
    acceleration=(8.0,) * 7,
    seeding=PANDA.seeding,  # for arms whose first joint turns the arm and whose last the hand
)


def description() -> str:
    """The KUKA's URDF with the hand's frame added."""
    return KUKA_URDF.read_text(encoding="utf-8").replace("</robot>", HAND)


def main() -> None:
    with World() as world:  # only for a scene to plan in; it has a Panda
        world.reset((("red_box", "blue_box"), ("green_box",), ()))
        scene = true_scene_graph(world)
    planner = MotionPlanner(description(), KUKA)
    moves = [Move(0, 2), Move(0, 1), Move(2, 1)]
    fingers = np.full(2, KUKA.gripper.finger_travel)
    motion = planner.solve(scene, moves, np.array(KUKA.home), fingers)
    print(f"{format_stacks(scene.stacks())}, then {', '.join(map(str, moves))}:")
    print(f"{motion.trajectory.duration:.1f} s of motion, optimised in {motion.seconds:.2f} s")
    for interval in motion.trajectory.intervals:
        if interval.gripping:
            phase = interval.phase
            print(f"  {interval.start:5.1f} s  {phase.kind} {phase.object_name}")


if __name__ == "__main__":
    main()
