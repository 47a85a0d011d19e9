# SPDX-License-Identifier: Apache-2.0
"""An arm of two joints in a time of its own, and a planner that knows two moves for it.

Nobody waits for anything: whoever waits for a joint state makes the arm's time go on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_node.execution.arm_state import ArmState, ArmStateBox
from motion_node.execution.plan import Plan
from motion_node.grasps import Grasp
from motion_node.phases import HOME, PICK, PLACE, Phase, PhasePath, Switch, Tool
from motion_node.planner import Motion
from motion_node.robots.joints import JointValues
from motion_node.timing.limits import JointLimits
from motion_node.timing.time_paths import TimingSettings, time_paths
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move, SceneGraph

Array = NDArray[np.float64]

HOME_Q = np.zeros(2)
OPEN, HALF_BLOCK, SQUEEZED = 0.04, 0.0225, 0.0125
BESIDE = HALF_BLOCK + TimingSettings().finger_room
BLOCKS = ("green_box", "blue_box")
#: Where the arm takes the first block, puts it down, takes the second one, puts it down [rad].
SWITCHES = np.array([(0.8, -0.5), (-0.7, -0.4), (0.3, -0.6), (-0.7, -0.3)])
LIMITS = JointLimits(np.full(2, 2.0), np.full(2, 8.0))
PLAN = Plan("a", SceneGraph((), frozenset()), (Move(0, 2), Move(1, 2)), BLOCKS)


def phase(kind: str, move: int) -> Phase:
    """A phase of the two moves; blocks are held from the end of the pick to that of the place."""
    holding = kind == PLACE
    name = "" if kind == HOME else BLOCKS[move]
    tool = Tool(0.01, 0.07, 0.1, name if holding else "", SQUEEZED if holding else OPEN)
    grasp = None if kind == HOME else Grasp(0.0, 2 * HALF_BLOCK, 2 * HALF_BLOCK, 0.0, 0.0)
    switch = Switch((0.5, 0.0, 0.1), 0.0, 2) if kind == PLACE else None
    grip = SQUEEZED if kind == PICK else OPEN
    return Phase(kind, move, name, switch, None, tool, (), grip, grasp)


def holding_home(move: int, held: str, fingers: float) -> Phase:
    """A way home with something in the hand."""
    return Phase(HOME, move, "", None, None, Tool(0.01, 0.07, 0.1, held, fingers), (), fingers)


def timed(
    phases: Sequence[Phase],
    corners: Sequence[Array],
    fingers: Array,
    opening: float | None = OPEN,
) -> Trajectory:
    """Straight lines between the corners, one a phase."""
    lines = [np.linspace(a, b, 9) for a, b in pairwise(corners)]
    paths = [PhasePath(own, line) for own, line in zip(phases, lines)]
    return time_paths(paths, LIMITS, TimingSettings(), fingers, opening)


def two_moves(start: Array = HOME_Q, fingers: Array | None = None) -> Trajectory:
    """Two picks and places, and the way home."""
    phases = [phase(kind, move) for move in range(2) for kind in (PICK, PLACE)]
    corners = [start, *SWITCHES, HOME_Q]
    return timed(
        [*phases, phase(HOME, 2)], corners, np.full(2, OPEN) if fingers is None else fingers
    )


def planned(trajectory: Trajectory) -> Motion:
    """A motion of which only trajectory and phases count; it took a quarter of a second."""
    phases = tuple(dict.fromkeys(interval.phase for interval in trajectory.intervals))
    return Motion(phases, (), trajectory, 0.0, 0.25)


class FakePlanner:
    """Plans two moves whatever the scene; keeps what it was asked.

    Attributes:
        errors: raised instead, by the name of the method.
        while_solving: called in ``solve``, before it looks whether it is cancelled.
        ways_home: the numbers of moves done that ways home were asked for.
        put_downs: the moves whose blocks were to be put down.
        rises: what was in the hand where the arm was to rise and go home.
    """

    def __init__(self) -> None:
        self.errors: dict[str, Exception] = {}
        self.while_solving: Callable[[], None] = lambda: None
        self.asked: list[tuple[object, ...]] = []
        self.ways_home: list[int] = []
        self.put_downs: list[int] = []
        self.rises: list[str] = []

    def solve(
        self, graph: Any, moves: Any, arm: Array, fingers: Array, names: Any, cancelled: Any
    ) -> Motion:
        self.asked.append((graph, tuple(moves), tuple(names)))
        self.while_solving()
        if "solve" in self.errors and (cancelled() or "cancelled" not in str(self.errors["solve"])):
            raise self.errors["solve"]
        return planned(two_moves(arm, fingers))

    def solve_way_home(
        self, _motion: Motion, moves_done: int, arm: Array, fingers: Array
    ) -> Motion:
        if "solve_way_home" in self.errors:
            raise self.errors["solve_way_home"]
        self.ways_home.append(moves_done)
        return planned(timed([phase(HOME, moves_done)], [arm, HOME_Q], fingers))

    def solve_put_down(self, _motion: Motion, move: int, arm: Array) -> Motion:
        self.put_downs.append(move)
        if "solve_put_down" in self.errors:
            raise self.errors["solve_put_down"]
        phases = [phase(PLACE, move), phase(HOME, move + 1)]
        corners = [arm, SWITCHES[2 * move + 1], HOME_Q]
        return planned(timed(phases, corners, np.full(2, SQUEEZED), opening=None))

    def solve_rise_home(
        self, _motion: Motion | None, arm: Array, fingers: Array, held: str = ""
    ) -> Motion:
        self.rises.append(held)
        if "solve_rise_home" in self.errors:
            raise self.errors["solve_rise_home"]
        if not held:
            return planned(timed([phase(HOME, 0)], [arm, HOME_Q], fingers))
        pressing = float(np.mean(fingers)) - 0.01
        way = [holding_home(0, held, pressing)]
        return planned(timed(way, [arm, HOME_Q], np.full(2, pressing), opening=None))


class SimulatedArm:
    """Follows every trajectory exactly; whoever waits makes its time go on.

    Faults are switched on by setting the attributes.

    Attributes:
        silent: publishes no joint states.
        frozen: publishes the same positions for ever.
        deaf: ignores trajectories.
        stuck: stays where it is.
        frozen_clock: stamps stand still.
        block: half of what the fingers close on [m]; 0: nothing.
        cut_at: the next trajectory ends there [s]; 0: at its end.
        fingers_stuck_at: where the fingers stay [m]; negative: they obey.
        trembling: by how much its joints differ from one state to the next [rad].
        slowness: seconds of this machine a second of the arm's.
        lag: how long the arm takes to set out [s].
        travels: how long a trajectory is on its way to the controller [s].
        sent: the trajectories, and the joints when each was sent.
        refused: how many of them it did not take.
    """

    PERIOD = 0.02

    def __init__(self) -> None:
        self.silent = self.deaf = self.stuck = self.frozen_clock = False
        self.block, self.slowness, self.trembling = HALF_BLOCK, 1.0, 0.0
        self.lag, self.travels, self.refused = 0.0, 0.0, 0
        self.sent: list[tuple[Trajectory, JointValues]] = []
        self.joints = self._seen = JointValues(HOME_Q.copy(), np.full(2, OPEN))
        self.frozen, self.fingers_stuck_at, self.cut_at = False, -1.0, 0.0
        self.closed, self.standing = False, False
        self._time, self._stamp, self._began = 1000.0, 50.0, 0.0
        self._box = ArmStateBox(self.now)
        self._following: Trajectory | None = None
        self._events: list[tuple[Callable[[], bool], Callable[[], object]]] = []

    def at_home(self) -> bool:
        return bool(np.abs(self.joints.arm - HOME_Q).max() < 0.01)

    def be_quiet(self, seconds: float, standing: bool) -> None:
        """No joint states for a while [s]; ``standing``: the arm and its clock stand still, too."""
        self.silent, self.standing, end = True, standing, self._time + seconds

        def again() -> None:
            self.silent = self.standing = False

        self.when(lambda: self._time > end, again)

    def when(self, condition: Callable[[], bool], action: Callable[[], object]) -> None:
        """Does something once, as soon as a condition holds."""
        self._events.append((condition, action))

    def pass_time(self, seconds: float) -> None:
        """Lets time go on [s]."""
        end = self._time + seconds
        while self._time < end:
            self._tick()

    # Where the arm's states arrive

    @property
    def problem(self) -> str:
        return self._box.problem

    def refuse(self, problem: str) -> None:
        """Something arrives that is no measurement."""
        self._box.refuse(problem)

    def now(self) -> float:
        return self._time

    def newest(self) -> ArmState | None:
        return self._box.newest()

    def wait(self, after: ArmState | None, timeout: float) -> ArmState | None:
        end = self._time + timeout
        while self._box.newest() is after and self._time < end:
            self._tick()
        return self._box.wait(after, 0.0)

    # The controller

    def send(self, trajectory: Trajectory, begins: float | None = None) -> None:
        self.sent.append((trajectory, self.joints))
        if self.travels:
            arrives = self._stamp + self.travels
            self.when(lambda: self._stamp >= arrives, lambda: self._arrive(trajectory, begins))
        else:
            self._arrive(trajectory, None)

    def _arrive(self, trajectory: Trajectory, begins: float | None) -> None:
        """Begins now, or is joined where it should be by now."""
        began = self._stamp if begins is None else begins
        target = trajectory.sample(self._stamp - began)[0]
        jump = float(np.abs(target.arm - self.joints.arm).max())
        if self.deaf or jump > 0.1:
            self.refused += 1
            return
        if self.cut_at > 0.0:
            trajectory, self.cut_at = trajectory.cut(0.0, self.cut_at), 0.0
        self._following, self._began = trajectory, began + self.lag

    def _tick(self) -> None:
        self._time += self.PERIOD * self.slowness
        assert self._time < 1e6, "nobody ends this"
        if not (self.frozen_clock or self.standing):
            self._stamp += self.PERIOD
        where = None if self.stuck else self._commanded()
        if where is not None:
            fingers = np.maximum(where.fingers, self.block)
            if self.fingers_stuck_at >= 0.0:
                fingers = np.full(2, self.fingers_stuck_at)
            self.joints = JointValues(where.arm, fingers)
        for event in list(self._events):
            condition, action = event
            if condition():
                self._events.remove(event)
                action()
        if not self.silent:
            self.trembling *= -1
            seen = self._seen if self.frozen else self.joints
            self._seen = seen
            self._box.put(self._stamp, JointValues(seen.arm + self.trembling / 2, seen.fingers))

    def _commanded(self) -> JointValues | None:
        """Where the joints are told to be now."""
        if self._following is None:
            return None
        return self._following.sample(self._stamp - self._began)[0]
