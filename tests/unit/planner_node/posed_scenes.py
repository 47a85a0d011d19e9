# SPDX-License-Identifier: Apache-2.0
"""Frames of blocks that have poses, and a plan that is carried out before a camera."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tamp_runtime.motion_report import MotionReport, MotionState

from planner_node.goals import Goal
from planner_node.loop import Plan, Scene, Sighting, plan_for
from planner_node.search import SearchResult
from scene_graph import (
    ROW_OF_THREE,
    GraphStatus,
    Move,
    Place,
    SceneGraph,
    SceneObject,
    Stacks,
    apply_move,
    split_object_name,
    up_relations,
)

EDGE = 0.045
SECOND = 1_000_000_000
FRAME = SECOND // 10
Point = tuple[float, float, float]


def centre(stack: int, level: int) -> Point:
    """Of a block in a stack [m]."""
    x, y, z = ROW_OF_THREE[stack]
    return x, y, z + (level + 0.5) * EDGE


def block(name: str, position: Point, visible: float = 0.95) -> SceneObject:
    color, kind, *_ = name.split("_")
    return SceneObject(name, color, kind, position, size=(EDGE,) * 3, confidence=visible)


def frame(
    stacks: Stacks,
    stamp: int,
    moved: Mapping[str, Point | None] | None = None,
    status: GraphStatus = GraphStatus.OCCLUDED,
    hidden: tuple[float, ...] = (0.0, 0.0, 0.0),
    visible: float = 0.95,
    seen_to: tuple[float, ...] = (0.0, 0.0, 0.0),
    fallen: Mapping[str, Point] | None = None,
    shape: str = "box",
) -> Sighting:
    """What perception reports of a state.

    Args:
        moved: blocks that are elsewhere than their stack says, or not seen at all.
        hidden: shares of the columns over the places.
        visible: share of every block.
        seen_to: heights to which the columns are not hidden [m].
        fallen: blocks that lie where they were not measured, and look like such a shape.
    """
    positions: dict[str, Point | None] = {
        name: centre(index, level)
        for index, stack in enumerate(stacks)
        for level, name in enumerate(stack)
    }
    positions |= moved or {}
    objects = [block(name, at, visible) for name, at in sorted(positions.items()) if at]
    for name, at in (fallen or {}).items():
        color, _ = split_object_name(name)
        objects = [item for item in objects if item.name != name]
        objects.append(SceneObject(f"{color}_{shape}", color, shape, at, confidence=visible))
    columns = enumerate(zip(ROW_OF_THREE, hidden, seen_to))
    places = tuple(Place(i, at, share, height) for i, (at, share, height) in columns)
    seen = tuple(tuple(name for name in stack if positions[name]) for stack in stacks)
    graph = SceneGraph(tuple(objects), up_relations(seen), places, 0.5)
    return Sighting(graph, status, stamp=stamp, frame_id="world")


def plan_of(stacks: Stacks, moves: tuple[Move, ...], stamp: int = SECOND) -> Plan:
    """A plan from a scene that was seen at a time."""
    states = [stacks]
    for move in moves:
        states.append(apply_move(states[-1], move))
    sighting = frame(stacks, stamp, status=GraphStatus.CONFIDENT)
    scene = Scene(sighting.graph, stacks, stamp, "world")
    return plan_for(scene, Goal(()), SearchResult(moves, tuple(states), 0, 0.0), stamp)


@dataclass(frozen=True)
class Instant:
    """A moment of a plan that is carried out as predicted.

    Attributes:
        step: 2k while move k is picked, 2k + 1 while it is placed, 2n on the way home.
        begins: whether the step has just begun.
        stacks: what stands, the block in the hand left out.
        held: the block in the hand.
        hand: the stack over which the hand is.
    """

    stamp: int
    step: int
    begins: bool
    stacks: Stacks
    held: str
    hand: int

    def report(self, plan: Plan, late: int = 0) -> MotionReport:
        """What the motion node says when the step begins, stamped so much too late [ns]."""
        moves = len(plan.moves)
        move, phase = self.step // 2, ("pick", "place")[self.step % 2]
        if move == moves:
            move, phase = moves - 1, "home"
        return MotionReport(
            plan.plan_id, MotionState.EXECUTING, move=move, moves_done=self.step // 2,
            moves_total=moves, phase=phase, stamp=self.stamp + late,
        )  # fmt: skip

    def frame(self, moved: Mapping[str, Point | None] | None = None, **fields: Any) -> Sighting:
        """What the camera shows; the block in the hand is seen in the air, in changing places.

        The hand hides its column: that of the stack where it takes something or puts it down.
        """
        shown = {self.held: (0.5, 0.2 - self.stamp % 7 * 0.05, 0.3)} if self.held else {}
        hidden = tuple(0.7 if index == self.hand else 0.0 for index in range(len(self.stacks)))
        fields = {"hidden": hidden, **fields}
        return frame(self.stacks, self.stamp, {**shown, **(moved or {})}, **fields)


def instants(plan: Plan, frames: int = 12) -> Iterator[Instant]:
    """A plan as it is carried out, so many frames a step."""
    stamp = plan.stamp
    for step in range(2 * len(plan.moves) + 1):
        move = step // 2
        held = plan.blocks[move] if step % 2 else ""
        before = plan.states[move]
        stacks = tuple(tuple(n for n in stack if n != held) for stack in before)
        for number in range(frames):
            stamp += FRAME
            hand = -1
            if move < len(plan.moves):
                leaves = not held or number < frames // 2
                hand = plan.moves[move].source if leaves else plan.moves[move].target
            yield Instant(stamp, step, number == 0, stacks, held, hand)
