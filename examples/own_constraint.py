# SPDX-License-Identifier: Apache-2.0
"""A constraint of your own: what is carried stays below a shelf, or the planner says why it cannot.

A constraint owns its rows: what they are, what is asked of them and when, and how they are called
when one is violated. Derivatives follow from the expression, and no other part of the motion
problem has to know of it. In the project itself a constraint is a file in motion_node/constraints/.

    python examples/own_constraint.py
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from motion_node import (
    PANDA,
    AlongPath,
    ArmModel,
    AtSwitch,
    Constraint,
    Demand,
    InfeasibleError,
    MotionPlanner,
    Phase,
    default_constraints,
)
from scene_graph import Move
from sim_node import World, robot_description, true_scene_graph


class BelowShelf(Constraint):
    """One row: how far the tool centre point is below a height [m]; at least 0 with a block."""

    name = "below_shelf"

    def __init__(self, height: float) -> None:
        self.height = height

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """The arm's symbols are in ``model``; this row needs neither parameters nor stacks."""
        return self.height - model.tool_center[2]

    def row_names(self, phase: Phase) -> Sequence[str]:
        """What people are told is violated."""
        return (f"room for {phase.tool.held or 'the hand'} below the shelf",)

    def at_switch(self, moment: AtSwitch) -> Demand:
        """At the end of a phase."""
        return Demand.constant(1, [self._least(moment.phase)], [np.inf])

    def along_path(self, way: AlongPath) -> Demand:
        """At every step of a phase."""
        return Demand.constant(way.steps, [self._least(way.phase)], [np.inf])

    def _least(self, phase: Phase) -> float:
        return 0.0 if phase.tool.held else -np.inf


def highest(planner: MotionPlanner) -> float:
    """Moves a block over a tower of two; the greatest height of the hand on the way [m]."""
    with World() as world:
        world.reset((("red_box",), ("blue_box", "green_box"), ()))
        scene = true_scene_graph(world)
    arm, fingers = np.array(PANDA.home), np.full(2, PANDA.gripper.finger_travel)
    motion = planner.solve(scene, [Move(0, 2)], arm, fingers)
    carried = motion.paths[1]
    heights = [planner.model.hand_at(q)[0][2] for q in carried.q]
    return float(max(heights))


def main() -> None:
    free = MotionPlanner(robot_description(), PANDA)
    print(f"without a shelf the hand rises to {highest(free):.3f} m")
    for height in (0.135, 0.03):
        constraints = [*default_constraints(PANDA), BelowShelf(height)]
        planner = MotionPlanner(robot_description(), PANDA, constraints=constraints)
        try:
            print(f"below a shelf at {height} m it rises to {highest(planner):.3f} m")
        except InfeasibleError as error:
            print(f"below a shelf at {height} m: {error}")


if __name__ == "__main__":
    main()
