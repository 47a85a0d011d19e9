# SPDX-License-Identifier: Apache-2.0
"""Tables with things that stand around, and what moves lead to the goal on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from motion_node.errors import InfeasibleError
from motion_node.obstacles import Obstacle
from motion_node.planner import Motion, MotionPlanner
from planner_node.errors import ImpossibleError
from planner_node.goals import parse_goal, resolve_goal
from planner_node.loop import plan_for
from planner_node.loop.possible_moves import exclusion_of
from planner_node.loop.scene import Scene
from planner_node.search import make_plan
from planner_node.search.possible import Exclusion, plan_avoiding
from scene_graph import SceneGraph

#: Places far enough apart for a wall in between and a hand on either side.
WIDE: Final = ((0.5, -0.2), (0.5, 0.0), (0.5, 0.2))
#: How thick walls are [m].
THICK: Final = 0.02


def wall(
    x: float, y: float, length: float, height: float, *, yaw: float = 0.0, name: str = "wall"
) -> Obstacle:
    """A wall that stands on the table, along x unless it is turned."""
    return Obstacle(name, (length, THICK, height), (x, y, height / 2), yaw)


def pen(x: float, y: float, height: float, inner: float = 0.14) -> tuple[Obstacle, ...]:
    """Four walls around a place."""
    far, turned = (inner + THICK) / 2, np.pi / 2
    length = inner + 2 * THICK
    return (
        wall(x, y - far, length, height, name="left fence"),
        wall(x, y + far, length, height, name="right fence"),
        wall(x - far, y, inner, height, yaw=turned, name="back fence"),
        wall(x + far, y, inner, height, yaw=turned, name="front fence"),
    )


@dataclass
class Backtracked:
    """What planning with the motion's verdicts came to.

    Attributes:
        motion: None if the goal is impossible.
        moves: how many the last plan has.
        exclusions: in the order in which they were found.
        refusal: the planner's sentence, if there is no motion.
    """

    motion: Motion | None = None
    moves: int = 0
    exclusions: list[Exclusion] = field(default_factory=list)
    refusal: str = ""


def plan_geometrically(
    planner: MotionPlanner, graph: SceneGraph, goal: str, most: int = 60
) -> Backtracked:
    """Plans, moves, excludes what cannot be, and plans anew: the closed loop without its nodes."""
    resolved = resolve_goal(parse_goal(goal), graph.names)
    scene = Scene(graph=graph, stacks=graph.stacks(), stamp=0, frame_id="world")
    result = Backtracked()
    fingers = np.full(2, planner.arm.gripper.finger_travel)
    while len(result.exclusions) <= most:
        try:
            found = (
                plan_avoiding(scene.stacks, resolved, result.exclusions)
                if result.exclusions
                else make_plan(scene.stacks, resolved)
            )
        except ImpossibleError as error:
            result.refusal = str(error)
            return result
        plan = plan_for(scene, resolved, found, 0)
        result.moves = len(plan.moves)
        try:
            result.motion = planner.solve(graph, plan.moves, planner.model.home, fingers)
            return result
        except InfeasibleError as error:
            report = MotionReport(
                state=MotionState.FAILED, reason=MotionReason.INFEASIBLE, bound=error.bound,
                constraint=error.constraint, move=min(error.move, len(plan.moves) - 1),
                phase=error.phase, violation=error.violation, excludes=error.excludes,
            )  # fmt: skip
            exclusion = exclusion_of(plan, report)
            assert exclusion is not None, error
            result.exclusions.append(exclusion)
    return result


def names_of(obstacles: Sequence[Obstacle]) -> set[str]:
    """Their names."""
    return {item.name for item in obstacles}
