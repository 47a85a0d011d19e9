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
from motion_node.execution.executive import Plan
from motion_node.phases import HOME, PICK, PLACE, Phase, PhasePath, Tool
from motion_node.planner import Motion
from motion_node.robots.joints import JointValues
from motion_node.timing.limits import JointLimits
from motion_node.timing.time_paths import TimingSettings, time_paths
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move, SceneGraph

Array = NDArray[np.float64]

HOME_Q = np.zeros(2)
OPEN, HALF_BLOCK, SQUEEZED = 0.04, 0.0225, 0.0125
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
    return Phase(kind, move, name, None, None, tool, (), SQUEEZED if kind == PICK else OPEN)


def timed(phases: Sequence[Phase], corners: Sequence[Array], fingers: Array) -> Trajectory:
    """Straight lines between the corners, one a phase."""
    lines = [np.linspace(a, b, 9) for a, b in pairwise(corners)]
    paths = [PhasePath(own, line) for own, line in zip(phases, lines)]
    return time_paths(paths, LIMITS, TimingSettings(), fingers, OPEN)


def two_moves(start: Array = HOME_Q, fingers: Array | None = None) -> Trajectory:
    """Two picks and places, and the way home."""
    phases = [phase(kind, move) for move in range(2) for kind in (PICK, PLACE)]
    corners = [start, *SWITCHES, HOME_Q]
    return timed(
        [*phases, phase(HOME, 2)], corners, np.full(2, OPEN) if fingers is None else fingers
    )


def planned(trajectory: Trajectory) -> Motion:
    """A motion of which only the trajectory counts, and that took a quarter of a second."""
    return Motion((), (), trajectory, 0.0, 0.25)


class FakePlanner:
    """Plans two moves whatever the scene; keeps what it was asked.

    Attributes:
        errors: raised instead, by the name of the method.
        while_solving: called in ``solve``, before it looks whether it is cancelled.
        ways_home: the numbers of moves done that ways home were asked for.
    """

    def __init__(self) -> None:
        self.errors: dict[str, Exception] = {}
        self.while_solving: Callable[[], None] = lambda: None
        self.asked: list[tuple[object, ...]] = []
        self.ways_home: list[int] = []

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


class SimulatedArm:
    """Follows every trajectory exactly; whoever waits makes its time go on.

    Faults are switched on by setting the attributes.

    Attributes:
        silent: publishes no joint states.
        deaf: ignores trajectories.
        stuck: stays where it is.
        frozen_clock: stamps stand still.
        block: half of what the fingers close on [m]; 0: nothing.
        trembling: by how much its joints differ from one state to the next [rad].
        slowness: seconds of this machine a second of the arm's.
        sent: the trajectories, and the joints when each arrived.
    """

    PERIOD = 0.02

    def __init__(self) -> None:
        self.silent = self.deaf = self.stuck = self.frozen_clock = False
        self.block, self.slowness, self.trembling = HALF_BLOCK, 1.0, 0.0
        self.sent: list[tuple[Trajectory, JointValues]] = []
        self.joints = JointValues(HOME_Q.copy(), np.full(2, OPEN))
        self._time, self._stamp, self._began = 1000.0, 50.0, 0.0
        self._box = ArmStateBox(self.now)
        self._following: Trajectory | None = None
        self._events: list[tuple[Callable[[], bool], Callable[[], object]]] = []

    def at_home(self) -> bool:
        return bool(np.abs(self.joints.arm - HOME_Q).max() < 0.01)

    def when(self, condition: Callable[[], bool], action: Callable[[], object]) -> None:
        """Does something once, as soon as a condition holds."""
        self._events.append((condition, action))

    def pass_time(self, seconds: float) -> None:
        """Lets time go on [s]."""
        end = self._time + seconds
        while self._time < end:
            self._tick()

    # Where the arm's states arrive

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

    def send(self, trajectory: Trajectory) -> None:
        self.sent.append((trajectory, self.joints))
        if not self.deaf:
            self._following, self._began = trajectory, self._stamp

    def _tick(self) -> None:
        self._time += self.PERIOD * self.slowness
        assert self._time < 1e6, "nobody ends this"
        if not self.frozen_clock:
            self._stamp += self.PERIOD
        if self._following is not None and not self.stuck:
            where, _ = self._following.sample(self._stamp - self._began)
            self.joints = JointValues(where.arm, np.maximum(where.fingers, self.block))
        for event in list(self._events):
            condition, action = event
            if condition():
                self._events.remove(event)
                action()
        if not self.silent:
            self.trembling *= -1
            arm = self.joints.arm + self.trembling / 2
            self._box.put(self._stamp, JointValues(arm, self.joints.fingers))
