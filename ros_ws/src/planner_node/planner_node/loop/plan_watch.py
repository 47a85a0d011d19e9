# SPDX-License-Identifier: Apache-2.0
"""Watching while the arm moves: what is seen against what the plan predicts at that instant."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

from tamp_runtime.motion_report import MotionReport

from scene_graph import UP, SceneGraph, SceneObject, base_name

from .evidence import Evidence, Finding, Suspicion
from .expectation import Expectation
from .plan import Plan
from .scene import Scene, Sighting
from .timeline import Timeline


class Sight(IntEnum):
    """What a frame shows of the block that is taken next, with the numbers of PlanSighting."""

    SEEN = 0
    HIDDEN = 1
    DOUBTFUL = 2


@dataclass(frozen=True)
class PlanSight:
    """What one frame shows of what a plan takes next.

    Attributes:
        stamp: when the frame was taken, in ROS time [ns].
        move: index of the move whose block is taken next.
        sight: of this block.
        moved: blocks that were moved a little since the plan was made, as they are seen now.
    """

    stamp: int
    move: int
    sight: Sight
    moved: tuple[SceneObject, ...] = ()


class PlanWatch:
    """Compares frames with a plan that is carried out.

    Args:
        patience: see :class:`.evidence.Evidence`.

    Attributes:
        contradiction: what was seen to happen, as a sentence; empty while all is as predicted.
        sight: what the newest frame shows of what is taken next; None where that contradicts
            the plan, or before any.
    """

    def __init__(self, plan: Plan, patience: int = 1) -> None:
        self._plan = plan
        self._timeline = Timeline(len(plan.moves))
        self._evidence = Evidence(Expectation(plan), patience)
        self._newest = plan.scene.stamp
        self.contradiction = ""
        self.sight: PlanSight | None = None

    def hear(self, report: MotionReport) -> None:
        """Takes a report of the motion node on the plan."""
        self._timeline.note(report)

    def see(self, sighting: Sighting | None) -> bool:
        """Takes the newest frame; whether the plan is contradicted by now."""
        if self.contradiction or sighting is None or sighting.defect:
            return bool(self.contradiction)
        if sighting.stamp <= self._newest or self._timeline.off_course:
            return False
        self._newest, self.sight = sighting.stamp, None
        steps = self._timeline.steps_at(sighting.stamp)
        told = self._evidence.weigh(sighting, steps)
        self.contradiction = "; ".join(self._clause(item, sighting.graph) for item in told)
        name = self._evidence.expectation.picked(steps[-1])
        if not told:
            sight, moved = self._sight_of(name, sighting), tuple(self._evidence.nudged.values())
            self.sight = PlanSight(sighting.stamp, steps[-1] // 2, sight, moved)
        return bool(self.contradiction)

    @property
    def nudged(self) -> dict[str, float]:
        """How far blocks were moved that were taken where they were then, by name [m]."""
        before = self._plan.scene.graph
        return {
            name: math.dist(item.position_world, before.object(name).position_world)
            for name, item in self._evidence.nudged.items()
        }

    @property
    def told_of_moved(self) -> list[str]:
        """A sentence about each of these blocks."""
        return [f"{name} was moved by {1000 * away:.0f} mm, and the way corrected"
                for name, away in self.nudged.items()]  # fmt: skip

    def _sight_of(self, name: str, sighting: Sighting) -> Sight:
        if not name:
            return Sight.HIDDEN
        if not sighting.graph.objects or self._evidence.doubts:
            return Sight.DOUBTFUL
        return Sight.SEEN if self._evidence.is_in_place(name) else Sight.HIDDEN

    def is_as_predicted(self, scene: Scene, moves_done: int) -> bool:
        """Whether a scene is as the plan predicts it after so many moves, to the last block."""
        expected = self._evidence.expectation.at(2 * min(moves_done, len(self._plan.moves)))
        seen = {item.name: item.position_world for item in scene.graph.objects}
        return seen.keys() == expected.keys() and all(
            rest is not None and rest.holds(seen[name]) for name, rest in expected.items()
        )

    def _clause(self, item: Suspicion, graph: SceneGraph) -> str:
        finding, moves = item.finding, len(self._plan.moves)
        if item.step < 2 * moves:
            since = f"since move {item.step // 2 + 1} of {moves}"
        else:
            since = "since the last move"
        name, rest, seen = finding.name, finding.expected, _where(finding, graph)
        if rest is None:
            return f"{name} is seen {seen} {since}, and was not there before"
        return f"{name} was expected on {rest.support} and is {seen} {since}"


def _where(finding: Finding, graph: SceneGraph) -> str:
    """Where a block is seen: by what it stands on, or by how far it is from where it stood."""
    position, rest = finding.position_world, finding.expected
    if position is None:
        return "not seen any more"
    on = [item.object for item in graph.relations if (item.subject, item.predicate) ==
          (finding.name, UP)]  # fmt: skip
    if rest is None:
        return f"on {on[0]}" if on else _point(position)
    spots = {base_name(place.index) for place in graph.places if place.aside}
    if on and on[0] != rest.support and on[0] not in spots:
        return f"seen on {on[0]}"
    away = math.dist(position[:2], rest.position_world[:2])
    if away > rest.tolerance:
        return f"seen {1000 * away:.0f} mm beside where it was to be"
    return f"seen {_point(position)}"


def _point(position: tuple[float, float, float]) -> str:
    x, y, z = position
    return f"at ({x:.2f}, {y:.2f}, {z:.2f}) m"
