# SPDX-License-Identifier: Apache-2.0
"""Blocks that are moved a little while a plan is carried out: its motion is corrected under way.

The arm goes on while the correction is computed, which begins in its future: where it next rests at
a switch, or, where it is on its way to what was moved, on this way. When it comes there it is sent
on along the corrected trajectory: position and velocity go on, acceleration may jump on a way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

from tamp_runtime.motion_report import MotionReason

from scene_graph import SceneGraph, SceneObject

from ..errors import MotionError
from ..phases import PICK
from ..planner import Motion
from ..timing.trajectory import Trajectory
from .errors import ExecutionError
from .follow import Follower
from .last_look import Sightings
from .plan import Plan

#: A block that moved by less is taken all the same [m].
MOVED: Final = 0.005
#: So far ahead of the arm a correction begins [s], ...
AHEAD: Final = 0.25
#: ... or, where computing it took longer than that, as many times as far ...
MORE: Final = 1.5
#: ... but no farther [s].
FARTHEST: Final = 1.0
#: The arm may be so far beyond the beginning of a correction when it is sent [s].
LATE: Final = 0.02

#: Motion under way, time from which on the correction counts [s], the plan's scene as it is now ->
#: the rest of the motion. Raises InfeasibleError.
Correct = Callable[[Motion, float, SceneGraph], Motion]


@dataclass(frozen=True)
class Correction:
    """A corrected motion, and when the one under way gives way to it.

    Attributes:
        begins: time of the motion under way [s].
        graph: the scene that it is for.
    """

    motion: Motion
    begins: float
    graph: SceneGraph


class Corrections:
    """Corrects the motion of one plan.

    Args:
        correct: solves the rest of a motion anew; None: nothing does.
    """

    def __init__(
        self, plan: Plan, sightings: Sightings, follower: Follower, correct: Correct | None
    ) -> None:
        self._plan_id, self._graph = plan.plan_id, plan.graph
        self._sightings, self._follower, self._correct = sightings, follower, correct
        self._ahead = AHEAD
        self._next: Correction | None = None

    @property
    def wanted(self) -> tuple[SceneObject, ...]:
        """The blocks that stand elsewhere than the motion under way has them."""
        return tuple(item for item in self._sightings.moved(self._plan_id)
                     if _away(item, self._graph) > MOVED)  # fmt: skip

    def is_due(self, motion: Motion, time: float) -> bool:
        """Whether the arm has come to where a correction begins; computes one where it is wanted.

        Args:
            time: of the motion under way [s].

        Raises:
            ExecutionError: there is none without a stop.
        """
        if self._next is not None and self._is_missed(motion, time):
            self._next, self._ahead = None, min(MORE * self._ahead, FARTHEST)
        if self._next is None and (moved := self.wanted):
            self._next = self._made(motion, time, moved)
        following = self._next
        return following is not None and time >= following.begins - self._follower.LEAD

    def take(self) -> Correction:
        """The correction that is due; from now on it is the motion under way."""
        found, self._next = self._next, None
        assert found is not None
        self._graph = found.graph
        return found

    def _is_missed(self, motion: Motion, time: float) -> bool:
        assert self._next is not None
        if motion.trajectory.interval_at(time).gripping:
            return False
        return time > self._next.begins - self._follower.LEAD + LATE

    def _made(
        self, motion: Motion, time: float, moved: tuple[SceneObject, ...]
    ) -> Correction | None:
        """None: there is nothing left to correct."""
        trajectory, known = motion.trajectory, {item.name: item for item in moved}
        names, begins = ", ".join(sorted(known)), time + self._ahead
        for interval in trajectory.intervals:
            if not interval.gripping or interval.end <= time or interval.start > begins:
                continue
            if interval.phase.kind == PICK and interval.phase.object_name in known:
                raise needs_a_stop(interval.phase.object_name, "it is about to be taken")
            begins = max(begins, interval.end)  # while fingers move nothing is corrected
        begins = self._at_a_switch(trajectory, begins, known)
        if begins >= trajectory.duration:
            return None
        if self._correct is None:
            raise needs_a_stop(names, "arm and gripper have a controller each")
        objects = tuple(_moved_to(item, known) for item in self._graph.objects)
        graph = replace(self._graph, objects=objects)
        try:
            return Correction(self._correct(motion, begins, graph), begins, graph)
        except MotionError as error:
            raise needs_a_stop(names, str(error)) from error

    def _at_a_switch(
        self, trajectory: Trajectory, begins: float, moved: Mapping[str, SceneObject]
    ) -> float:
        """The end of the phase of a time, where the arm rests, if its end stays where it is."""
        phase = trajectory.interval_at(begins).phase
        stacks = self._graph.stacks()
        beneath = stacks[phase.switch.stack] if phase.switch is not None else ()
        if moved.keys() & {phase.object_name, *beneath}:
            return begins
        return [item.end for item in trajectory.intervals if item.phase is phase][-1]


def _away(item: SceneObject, graph: SceneGraph) -> float:
    known = next((other for other in graph.objects if other.name == item.name), item)
    return math.dist(item.position_world, known.position_world)


def _moved_to(item: SceneObject, seen: dict[str, SceneObject]) -> SceneObject:
    """The block where it is seen now; its size is as it was measured with nothing before it."""
    if item.name not in seen:
        return item
    now = seen[item.name]
    return replace(item, position_world=now.position_world, quaternion_world=now.quaternion_world)


def needs_a_stop(names: str, why: str) -> ExecutionError:
    """What ends a motion that cannot be corrected under way."""
    return ExecutionError(
        MotionReason.UNSEEN,
        f"{names} was moved, and the way there cannot be corrected without a stop: {why}",
        recoverable=True,
    )
