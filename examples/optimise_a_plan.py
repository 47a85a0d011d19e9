# SPDX-License-Identifier: Apache-2.0
"""Moves in, a trajectory of all joints out, plotted.

Run it as

    python examples/optimise_a_plan.py
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from motion_node import PANDA, MotionPlanner
from scene_graph import Move
from sim_node import World, robot_description, true_scene_graph


def main(out: Path = Path("runs")) -> None:
    with World() as world:
        world.reset((("red_box", "blue_box"), (), ("green_box",)))
        scene = true_scene_graph(world)
    planner = MotionPlanner(robot_description(), PANDA)
    fingers = np.full(2, PANDA.gripper.finger_travel)
    motion = planner.solve(scene, [Move(0, 1), Move(0, 2)], np.array(PANDA.home), fingers)
    trajectory = motion.trajectory
    print(f"{trajectory.duration:.1f} s of motion, optimised in {motion.seconds:.2f} s")

    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(9, 6), layout="constrained")
    above.plot(trajectory.times, trajectory.positions.arm, label=PANDA.arm_joints)
    above.set_ylabel("joints [rad]")
    above.legend(ncols=4, fontsize=7)
    below.plot(trajectory.times, 1e3 * trajectory.positions.fingers)
    below.set_ylabel("fingers [mm]")
    below.set_xlabel("time [s]")
    for interval in trajectory.intervals:
        if interval.gripping:
            above.axvspan(interval.start, interval.end, color="0.9")
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "trajectory.png")
    print("plotted into", out / "trajectory.png")


if __name__ == "__main__":
    main()
