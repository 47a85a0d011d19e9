# SPDX-License-Identifier: Apache-2.0
"""What stands around, as a file and messages tell it, and the planner that knows so much."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from tamp_runtime.motion_report import MotionReport, ObstaclesHeard

from scene_graph import SceneGraph

from .blocks import read_scene
from .constraints import CAPACITIES, capacity_for
from .dense_check import check as dense_check
from .motion import Motion
from .obstacles import Obstacle, ObstacleError
from .planner import MotionPlanner

#: So long a planner is not built while a motion under way is looked at, or is being stopped [s].
LOOKS: Final = 3.0

#: A message's obstacles by name.
Heard = dict[str, tuple[Obstacle, ...]]


class Surroundings:
    """The obstacles of a file, which stay, and those of messages; for any thread.

    Args:
        fixed: those of the file.
    """

    def __init__(self, fixed: Sequence[Obstacle]) -> None:
        self._fixed, self._heard = tuple(fixed), Heard()
        self._all = self._fixed
        self._verdict, self._problem = ObstaclesHeard.TAKEN, ""

    @property
    def all(self) -> tuple[Obstacle, ...]:
        """The obstacles now; the same tuple as long as nothing changes."""
        return self._all

    def hear(self, read: Callable[[Mapping[str, tuple[Obstacle, ...]]], Heard]) -> bool:
        """Takes a message, of whose obstacles ``read`` makes those after it; False: it is refused.

        What was known before stays then, and reports say why.
        """
        try:
            heard = read(self._heard)
            parts = (*self._fixed, *(part for own in heard.values() for part in own))
            if len(parts) > CAPACITIES[-1]:
                raise ObstacleError(f"there are more than {CAPACITIES[-1]} obstacles", number=True)
            taken = {item.name for item in self._fixed} & set(heard)
            if taken:
                raise ObstacleError(f"the file of obstacles has {', '.join(sorted(taken))} already")
        except ObstacleError as error:
            verdict = ObstaclesHeard.INVALID
            if error.frame or error.number:
                verdict = ObstaclesHeard.UNKNOWN_FRAME if error.frame else ObstaclesHeard.TOO_MANY
            self._verdict, self._problem = verdict, f"{error}; the obstacles known before stay"
            return False
        self._heard = heard
        if parts != self._all:
            self._all = parts
        self._verdict, self._problem = ObstaclesHeard.TAKEN, ""
        return True

    @property
    def problem(self) -> str:
        """Why the newest message was refused; empty: it was taken."""
        return self._problem

    def told_in(self, report: MotionReport) -> MotionReport:
        """The report, with how many obstacles there are, and what became of the newest message."""
        return replace(
            report,
            obstacles=len(self._all),
            obstacles_heard=self._verdict,
            obstacles_problem=self._problem,
        )


class Planners:
    """A planner for each capacity that was needed, built where nobody waits for it.

    Args:
        around: what stands around now.
    """

    def __init__(self, around: Surroundings) -> None:
        self._around, self._lock = around, threading.Lock()
        self._make: Callable[[Sequence[Obstacle]], MotionPlanner] | None = None
        self._built: dict[int, MotionPlanner] = {}
        self._current: MotionPlanner | None = None
        self._looked: tuple[Obstacle, ...] = ()

    @property
    def any(self) -> MotionPlanner | None:
        """One of them, for what is the same in all."""
        return next(iter(self._built.values()), None)

    @property
    def all(self) -> list[MotionPlanner]:
        """Those that are built."""
        return list(self._built.values())

    @property
    def wanting(self) -> bool:
        """Whether the planner for what stands around now has to be built."""
        with self._lock:
            return self._make is not None and self._fitting(self._around.all) is None

    def describe(self, make: Callable[[Sequence[Obstacle]], MotionPlanner]) -> MotionPlanner:
        """From now on planners of another robot; the one for now is built, and returned.

        Raises:
            MotionError: if it cannot be made; those of the robot before stay.
        """
        obstacles = self._around.all
        made = make(obstacles)
        with self._lock:
            self._make, self._built = make, {_capacity(obstacles): made}
        return made

    def build(self, moving: Callable[[], bool] = lambda: False) -> MotionPlanner | None:
        """Builds what the obstacles of now need; None: it is there, or nothing is described yet.

        Args:
            moving: whether the arm follows a motion. Then it is first looked whether anything is in
                its way, and the arm stopped if so, as building holds up the thread that does this,
                for seconds where many share a core.
        """
        obstacles, until = self._around.all, time.monotonic() + LOOKS
        while moving() and self._looked is not self._around.all and time.monotonic() < until:
            time.sleep(0.01)
        with self._lock:
            make = self._make
            if make is None or self._fitting(obstacles) is not None:
                return None
        made = make(obstacles)
        with self._lock:
            if self._make is make:
                self._built[_capacity(obstacles)] = made
        return made

    def now(self) -> MotionPlanner | None:
        """The planner among what stands around now; None while it is being built.

        For the thread that plans.
        """
        obstacles = self._around.all
        with self._lock:
            planner = self._fitting(obstacles)
        if planner is not None and planner.obstacles != obstacles:
            planner.surround(obstacles)
        if planner is not None:
            self._current, self._looked = planner, obstacles
        return planner

    def in_the_way(self, motion: Motion, graph: SceneGraph, since: float) -> str:
        """What has come into the rest of a motion's way since it was planned; empty: nothing.

        Looks only if the obstacles are others than when nothing was; for the thread that plans.

        Args:
            graph: the scene before the motion.
            since: the time of the motion's trajectory [s].
        """
        obstacles, planner = self._around.all, self._current
        if obstacles is self._looked or planner is None:
            return ""
        names = {item.name for item in obstacles}
        found = dense_check(
            *(planner.model, motion.trajectory, read_scene(graph), obstacles),
            floor=motion.floor,
            since=since,
        )
        for contact in found.contacts:
            if contact.other in names:
                return f"obstacle {contact.other} is in the way of the {contact.body}"
        self._looked = obstacles
        return ""

    def _fitting(self, obstacles: Sequence[Obstacle]) -> MotionPlanner | None:
        """The one with the least capacity that is enough; without obstacles, the one without."""
        if not obstacles:
            return self._built.get(0)
        enough = [number for number in self._built if number >= len(obstacles)]
        return self._built[min(enough)] if enough else None


def _capacity(obstacles: Sequence[Obstacle]) -> int:
    return capacity_for(len(obstacles)) if obstacles else 0
