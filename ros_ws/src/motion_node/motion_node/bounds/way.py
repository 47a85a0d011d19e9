# SPDX-License-Identifier: Apache-2.0
"""The way through one phase: its vertical ends, and starting points for the path problem."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from functools import lru_cache
from math import dist
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..blocks import Column
from ..constraints import AlongPath, Clearances, VerticalEnd, lowered
from ..nlp import Demand
from ..obstacles import Obstacle
from ..phases import Phase, Switch
from ..robots.inverse_kinematics import InverseKinematics
from ..robots.model import ArmModel
from ..settings import PathSettings
from .ways_round import HandGrid

Array = NDArray[np.float64]

#: Stacks nearer than this to the start have to be risen above first [m].
NEAR_START = 0.15
#: Stacks farther than this from the line between the ends are passed beside [m].
BESIDE = 0.14
#: Between two steps a path may be so much lower than at both [m].
DIP = 0.001
#: Starting points among obstacles keep so much more than the margin [m].
SPARE = 0.01
#: A starting point turns neither before this share of the way nor so near to its end.
EARLIEST: Final = 0.15
#: Where others stand in between, it turns so much later, and earlier, to be over them more shortly.
BETWEEN: Final = 0.05


@dataclass(frozen=True)
class Corner:
    """Where a starting point turns.

    Attributes:
        share: of the way, at which it does.
        point: of the tool centre, shape (3,) [m].
        near: a configuration in which the hand is turned as there, shape (n,) [rad].
    """

    share: float
    point: Array
    near: Array


class Way:
    """One phase between given configurations.

    A phase that starts at a switch leaves it along a vertical line. One that starts anywhere else
    (the first, and a way home after a stop) rises first if what hangs from the palm is not yet
    above the stacks; clearances that do not hold at its start may not shrink.

    Args:
        start, goal: configurations at its ends, shape (n,) [rad].
        moving: whether the arm is on its way already at the start, and need not rise first.

    Attributes:
        phase: what it is the way of.
        along: what constraints are told of it.
        asked: what they ask for, once that was worked out.
    """

    def __init__(
        self,
        model: ArmModel,
        shape: PathSettings,
        phase: Phase,
        start: Array,
        goal: Array,
        clear: Clearances,
        moving: bool = False,
    ) -> None:
        self._model, self._shape, self.phase, self._clear = model, shape, phase, clear
        self.start_q, self.goal_q = start, goal
        first = None if moving else self._start_end()
        last = self._switch_end(phase.switch) if phase.switch else None
        self.along = AlongPath(model.arm, phase, clear, shape, first, last)
        self.asked: list[Demand] = []

    def between(self, start: Array, goal: Array) -> Way:
        """The same from a switch, or from where it starts, to a switch in other configurations."""
        other = copy(self)
        other.start_q, other.goal_q = start, goal
        return other

    def _tool_bottom(self, tcp_height: float) -> float:
        return tcp_height + self._model.arm.gripper.tcp_offset - self.phase.tool.bottom

    def _switch_end(self, switch: Switch) -> VerticalEnd:
        phase, clear = self.phase, self._clear
        x, y, z = switch.position_world
        columns = lowered(phase, switch, self._model.arm, clear)
        above_own = phase.columns[switch.stack].top - self._tool_bottom(z) + clear.margin + 0.002
        lift = max(self._shape.lift + DIP, above_own)
        return VerticalEnd(np.array([x, y, switch.yaw]), z, lift, columns)

    def _start_end(self) -> VerticalEnd | None:
        phase, reserve = self.phase, self._clear.reserve
        if phase.start is not None:
            return self._switch_end(phase.start)
        (x, y, z), yaw = self._model.hand_at(self.start_q)
        bottom = self._tool_bottom(z)
        if bottom > max(column.top for column in phase.columns) + reserve:
            return None
        near = [
            column.top
            for column in phase.columns
            if np.hypot(column.center[0] - x, column.center[1] - y) < NEAR_START
        ]
        lift = max([self._shape.lift, *[top - bottom + reserve for top in near]])
        return VerticalEnd(np.array([x, y, yaw]), z, lift, phase.columns)

    def _passed(self, thorough: bool) -> list[Column]:
        """The stacks that a starting point passes over.

        Between two vertical ends those near the straight line, seen from above. From home and back
        none, unless ``thorough``: the arm comes from above anyway, and lifted over them first it
        ends in another valley, which costs a tenth more.
        """
        first, last, columns = self.along.first, self.along.last, self.phase.columns
        if first is None or last is None:
            return list(columns) if thorough else []
        begin, way = first.reference[:2], last.reference[:2] - first.reference[:2]
        found = []
        for column in columns:
            away = np.array(column.center) - begin
            share = float(np.clip(away @ way / max(float(way @ way), 1e-9), 0.0, 1.0))
            if float(np.hypot(*(away - share * way))) < BESIDE:
                found.append(column)
        return found

    def corners(self, higher: float, inwards: float) -> list[Corner]:
        """Where a starting point turns that goes up, across and down.

        Args:
            higher: how much higher than needed to pass over the stacks [m].
            inwards: share by which the way across is drawn towards the arm's base.
        """
        shape, phase = self._shape, self.phase
        hanging = phase.tool.bottom - self._model.arm.gripper.tcp_offset
        passed = self._passed(higher > 0.0)
        top = max([column.top for column in passed], default=0.0)
        across = top + hanging + self._clear.reserve + 0.01 + higher
        share = 1.6 * shape.vertical / shape.steps
        first, last = self.along.first, self.along.last
        shares = (share, 1 - share)
        if first and last:
            # Who goes up and down far has less time to pass over what is in between. A step too
            # late there is another valley, which costs a quarter more.
            up, down = (max(across, e.height + e.lift) - e.height for e in (first, last))
            far = dist(last.reference[:2], first.reference[:2])
            switches = [switch.stack for switch in (phase.start, phase.switch) if switch]
            own = [phase.columns[stack] for stack in switches]
            between = any(c.top > self._clear.floor and c not in own for c in passed)
            whole, shorter = up + far + down, BETWEEN if between else 0.0
            earlier = min(max(up / whole + shorter, EARLIEST), 1 - EARLIEST)
            later = 1 - max(down / whole + shorter, EARLIEST)
            shares = (earlier, max(earlier, later))
        found = []
        for end, q, when in zip((first, last), (self.start_q, self.goal_q), shares):
            if end is not None:
                point = end.reference * (1 - inwards)
                point[2] = max(across, end.height + end.lift)
                found.append(Corner(when, point, q))
        return found

    def through(self, shares: Sequence[float], between: Sequence[Array]) -> Array:
        """A starting point, shape (steps + 1, n) [rad].

        Args:
            shares: of the way at which it is at the configurations ``between``, each (n,) [rad].
        """
        knots = np.array([self.start_q, *between, self.goal_q])
        when = np.array([0.0, *shares, 1.0])
        at = _slow_ends(self._shape.steps)
        behind = when[1:-1].searchsorted(at, side="right")
        part = (at - when[behind]) / (when[behind + 1] - when[behind])
        before = knots[behind]
        return np.asarray(before + part[:, None] * (knots[behind + 1] - before))

    def guesses_round(
        self, inverse: InverseKinematics, obstacles: Sequence[Obstacle], count: int
    ) -> Iterator[Array]:
        """Up to ``count`` starting points that lead around obstacles, the shortest way first.

        Each of shape (steps + 1, n) [rad].
        """
        shape, along = self._shape, self.along
        ends, yaws = [], []
        for end, q in ((along.first, self.start_q), (along.last, self.goal_q)):
            point, yaw = self._model.hand_at(q)
            if end is not None:
                point = np.array([*end.reference[:2], end.height + end.lift + SPARE])
            ends.append(point)
            yaws.append(yaw)
        margin, floor = self._clear.margin + SPARE, self._clear.floor
        gripper = self._model.arm.gripper
        grid = HandGrid(
            gripper, self.phase, obstacles, np.array(ends), np.array(yaws), margin, floor
        )
        first = shape.vertical if along.first else 0
        last = shape.steps - (shape.vertical if along.last else 0)
        share = np.linspace(0.0, 1.0, last - first + 1)
        near = self.start_q + share[:, None] * (self.goal_q - self.start_q)
        turned = yaws[0] + share * _half_turn(yaws[1] - yaws[0])
        at = np.arange(shape.steps + 1)
        for way in grid.ways(count):
            lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1)))
            points = np.column_stack(
                [np.interp(share * lengths[-1], lengths, axis) for axis in way.T]
            )
            q = inverse.solve(points, turned, near)
            knots = np.vstack([self.start_q, q, self.goal_q])
            when = np.concatenate([[-1e-9], at[first : last + 1], [shape.steps + 1e-9]])
            yield np.column_stack([np.interp(at, when, column) for column in knots.T])


def guesses(
    ways: Sequence[Way], inverse: InverseKinematics, higher: float, inwards: float
) -> list[Array]:
    """A starting point for each way, all of them found at once; see :meth:`Way.corners`."""
    corners = [way.corners(higher, inwards) for way in ways]
    listed = [corner for own in corners for corner in own]
    if not listed:
        return [way.through((), ()) for way in ways]
    found = inverse.moved(
        np.array([corner.near for corner in listed]), np.array([corner.point for corner in listed])
    )
    parts = np.split(found, np.cumsum([len(own) for own in corners])[:-1])
    return [
        way.through([corner.share for corner in own], list(part))
        for way, own, part in zip(ways, corners, parts)
    ]


@lru_cache
def _slow_ends(steps: int) -> Array:
    """At which share of a way that begins and ends slowly its steps are, shape (steps + 1,)."""
    time = np.linspace(0.0, 1.0, steps + 1)
    return time**2 * (3.0 - 2.0 * time)


def _half_turn(angle: float) -> float:
    """The angle that is the same up to whole turns, in [-pi, pi) [rad]."""
    return float(np.mod(angle + np.pi, 2 * np.pi) - np.pi)
