# SPDX-License-Identifier: Apache-2.0
"""The last look before fingers close: the block that they are to take was just seen there.

Of a plan that is watched the planner tells picture by picture what it sees. Most often it has just
told it when the hand arrives, and nothing is waited for. Where it has not, or what it saw last is
doubtful, the hand stands at the switch with open fingers. Fingers that are closing open again when
a picture brings doubt, or when they meet nothing: as long as nothing is lifted nothing is lost.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

import numpy as np

from scene_graph import SceneObject

from ..phases import PICK
from ..timing.trajectory import Interval, Trajectory
from .arm_state import ArmState
from .follow import Follower

#: Of a picture that is no older than this no newer one is waited for: a camera of 10 Hz, and what
#: looks at its pictures, take less even where two cores do all [s].
RECENT: Final = 1.0
#: Where looking takes longer, a newer one is waited for so long [s], ...
WAITS: Final = 0.06
#: ... and then one will do that is no older than this [s], ...
OLDEST: Final = 2.0
#: ... or than this where newer ones only show the hand before the block [s].
BEFORE_HAND: Final = 3.0
#: So much before the hand arrives it is decided whether it stands there: a trajectory that ends
#: there has to be on its way by then [s].
DECIDES: Final = 0.08
#: So much before the hand arrives it is over the block, and hides it less [s].
OVER: Final = 0.45
#: A finger that is this much nearer to the other one than a side of the block has met none [m].
INSIDE: Final = 0.002
#: For so long nothing is seen before that is given up, by the clock of the joint states [s].
GIVES_UP: Final = 5.0


class Sight(IntEnum):
    """What a picture shows of a block that is to be taken, with the numbers of PlanSighting."""

    SEEN = 0
    HIDDEN = 1
    DOUBTFUL = 2


@dataclass(frozen=True)
class PlanSighting:
    """What one picture shows of a plan that is carried out.

    Attributes:
        stamp: when it was taken, by the clock of the joint states [s].
        move: index of the move whose block is to be taken next.
        sight: of this block.
        moved: blocks that were moved a little since the plan was made, as they are seen now.
    """

    plan_id: str
    stamp: float
    move: int
    sight: Sight = Sight.SEEN
    moved: tuple[SceneObject, ...] = ()


class Sightings:
    """Keeps what is told of the plan that is carried out; any thread may put and ask."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._newest: dict[Sight, PlanSighting] = {}
        self._moved: tuple[str, tuple[SceneObject, ...]] = ("", ())

    def put(self, sighting: PlanSighting) -> None:
        """Takes what is told."""
        with self._lock:
            self._newest[sighting.sight] = sighting
            self._moved = (sighting.plan_id, sighting.moved)

    def is_hidden(self, plan_id: str, move: int, since: float) -> bool:
        """Whether a picture that was taken since then does not show the block, and has no doubt."""
        with self._lock:
            hidden, doubt = self._newest.get(Sight.HIDDEN), self._newest.get(Sight.DOUBTFUL)
        if hidden is None or (hidden.plan_id, hidden.move) != (plan_id, move):
            return False
        return hidden.stamp > max(since, doubt.stamp if doubt is not None else since)

    def is_doubtful(self, plan_id: str) -> bool:
        """Whether the newest picture of a plan is doubtful."""
        with self._lock:
            newest = max(self._newest.values(), key=lambda item: item.stamp, default=None)
        return newest is not None and (newest.plan_id, newest.sight) == (plan_id, Sight.DOUBTFUL)

    def moved(self, plan_id: str) -> tuple[SceneObject, ...]:
        """The blocks of a plan that were moved a little since it was made."""
        with self._lock:
            told_of, moved = self._moved
            return moved if told_of == plan_id else ()

    def age(self, plan_id: str, move: int, now: float) -> float:
        """How old the newest picture is that has the block of a move where it is to be taken [s].

        Infinite where there is none, or something has become doubtful since.

        Args:
            now: by the clock of the joint states [s].
        """
        with self._lock:
            seen, doubt = self._newest.get(Sight.SEEN), self._newest.get(Sight.DOUBTFUL)
        if seen is None or (seen.plan_id, seen.move) != (plan_id, move):
            return float("inf")
        if doubt is not None and doubt.plan_id == plan_id and doubt.stamp > seen.stamp:
            return float("inf")
        return now - seen.stamp


class LastLook:
    """Whether a hand may close its fingers, while one plan is carried out."""

    def __init__(self, sightings: Sightings, plan_id: str) -> None:
        self._sightings, self._plan_id, self._closing = sightings, plan_id, -1
        # On which block fingers closed and met nothing, and when [s].
        self._missed, self._missed_at = -1, 0.0

    def allows(self, move: int, state: ArmState, stands: float = 0.0) -> bool:
        """Whether the block of a move was seen recently enough, and since fingers missed it.

        Args:
            stands: for how long the hand has stood at the block [s].
        """
        age = self._sightings.age(self._plan_id, move, state.stamp)
        if move == self._missed and state.stamp - age <= self._missed_at:
            return False
        if self._sightings.is_hidden(self._plan_id, move, state.stamp - age):
            return age <= BEFORE_HAND
        return age <= (OLDEST if stands >= WAITS else RECENT)

    def is_hidden(self, move: int, since: float) -> bool:
        """Whether the hand is seen to hide the block since then, by the joint states' clock [s]."""
        return self._sightings.is_hidden(self._plan_id, move, since)

    def close(self, move: int) -> None:
        """The fingers close on the block of a move from now on."""
        self._closing = move

    def is_missing(self, follower: Follower, trajectory: Trajectory, state: ArmState) -> bool:
        """Whether fingers are about to close on what was not seen just now.

        Where joint states have no stamps of their driver nobody can tell; then it is not asked.
        """
        if not state.stamped:
            return False
        grasp, time = grasp_ahead(trajectory, follower.time), follower.time
        if grasp is None or time < grasp.start - DECIDES:
            return False
        if grasp.phase.move == self._closing:
            if time < grasp.end - follower.LEAD and self._sightings.is_doubtful(self._plan_id):
                return True
            return self._meets_nothing(grasp, state)
        allowed = self.allows(grasp.phase.move, state)
        if allowed and time >= grasp.start:
            self.close(grasp.phase.move)
        return not allowed

    def _meets_nothing(self, grasp: Interval, state: ArmState) -> bool:
        """Whether closing fingers are further than a block lets them, for the first time on it.

        A block that is seen all the same was measured too wide: then the lift tells.
        """
        phase = grasp.phase
        if phase.move == self._missed or phase.grasp is None:
            return False
        if float(np.mean(state.positions.fingers)) > phase.grasp.width / 2 - INSIDE:
            return False
        self._missed, self._missed_at = phase.move, state.stamp
        return True


def grasp_ahead(trajectory: Trajectory, time: float) -> Interval | None:
    """The interval in which fingers close on the block that the hand is on its way to, or at.

    None where it is not on the way to one.
    """
    now = trajectory.interval_at(time)
    if now.phase.kind != PICK:
        return None
    last = [item for item in trajectory.intervals if item.phase is now.phase][-1]
    return last if last.gripping else None
