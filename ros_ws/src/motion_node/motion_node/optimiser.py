# SPDX-License-Identifier: Apache-2.0
"""From a scene, moves and the arm's state to a trajectory: P2, then P3, then times."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move, SceneGraph

from .errors import POSE, CancelledError, InfeasibleError
from .features import Features
from .inverse_kinematics import InverseKinematics
from .keyframes import Clearances, Keyframes
from .kinematics import Kinematics
from .path_problem import PathProblem, PhasePath
from .phase_bounds import PathSettings
from .phases import HOME, Phase, PhaseSettings, expand, read_scene, too_wide, way_home
from .robots import PANDA, Arm
from .timing.limits import JointLimits
from .timing.time_paths import TimingSettings, time_paths
from .timing.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Settings:
    """Everything that can be tuned.

    Attributes:
        squeeze: how much farther than the block's half width each finger is sent [m].
        limit_margin: distance kept to the joints' position limits [rad].
    """

    phases: PhaseSettings = field(default_factory=PhaseSettings)
    path: PathSettings = field(default_factory=PathSettings)
    timing: TimingSettings = field(default_factory=TimingSettings)
    squeeze: float = 0.01
    limit_margin: float = 0.05


@dataclass(frozen=True)
class Motion:
    """An optimised plan.

    Attributes:
        phases: the phases in order, the way home last.
        paths: their paths.
        floor: height of the table [m].
        seconds: wall time that the optimisation took [s].
    """

    phases: tuple[Phase, ...]
    paths: tuple[PhasePath, ...]
    trajectory: Trajectory
    floor: float
    seconds: float


class MotionOptimiser:
    """The motion problem of 5.1 for one arm; usable without ROS.

    >>> optimiser = MotionOptimiser(urdf_text)                           # doctest: +SKIP
    >>> motion = optimiser.solve(graph, [Move(0, 2)], q, fingers)        # doctest: +SKIP

    Args:
        description: the URDF's text.

    Raises:
        RobotDescriptionError: if the description lacks a joint or link of ``robot``.
    """

    def __init__(
        self, description: str, robot: Arm = PANDA, settings: Settings | None = None
    ) -> None:
        self.robot = robot
        self.settings = settings or Settings()
        self.kinematics = Kinematics(description, robot.arm_joints)
        self.kinematics.check_links(
            [robot.gripper.hand_link, *(body.link for body in robot.bodies)]
        )
        margin = self.settings.limit_margin
        self.lower = self.kinematics.lower + margin
        self.upper = self.kinematics.upper - margin
        self.home = np.array(robot.home)
        self.limits = JointLimits(self.kinematics.velocity, np.array(robot.acceleration))
        #: May be changed between plans.
        self.timing = self.settings.timing
        self._bounds: dict[int, tuple[Keyframes, PathProblem]] = {}

    def prepare(self, stacks: int, moves: int = 0) -> tuple[Keyframes, PathProblem]:
        """Builds the problems for a number of stacks, and P2 for a number of moves, once."""
        if stacks not in self._bounds:
            features = Features(self.kinematics, self.robot, stacks)
            inverse = InverseKinematics(features, self.lower, self.upper)
            self._bounds[stacks] = (
                Keyframes(features, inverse, self.lower, self.upper),
                PathProblem(
                    features,
                    inverse,
                    self.lower,
                    self.upper,
                    self.limits.acceleration,
                    self.settings.path,
                ),
            )
        keyframes, path = self._bounds[stacks]
        if moves:
            keyframes.problem(2 * moves)
        return keyframes, path

    def solve(
        self,
        graph: SceneGraph,
        moves: Sequence[Move],
        arm: Array,
        fingers: Array,
        object_names: Sequence[str] = (),
        cancelled: Callable[[], bool] = lambda: False,
    ) -> Motion:
        """The trajectory that carries out moves in a scene, and goes home.

        Args:
            arm: present configuration, shape (n,) [rad]; at rest.
            fingers: present finger positions, shape (2,) [m].
            object_names: the blocks the plan believes it moves, one a move, or none.
            cancelled: polled between problems.

        Raises:
            InvalidPlanError: if the moves do not fit the scene.
            InfeasibleError: if a bound has no solution.
            CancelledError: if ``cancelled`` said so.
        """
        begin = time.perf_counter()
        phases = expand(
            graph,
            moves,
            self.robot.gripper,
            self.settings.phases,
            self.settings.squeeze,
            object_names,
        )
        return self._solve(phases, read_scene(graph).floor, arm, fingers, cancelled, begin)

    def solve_way_home(self, motion: Motion, moves_done: int, arm: Array, fingers: Array) -> Motion:
        """The way home of an empty hand in the middle of a plan: open, rise, go home.

        Raises:
            InfeasibleError: if the path has no solution.
        """
        begin = time.perf_counter()
        home = way_home(motion.phases, moves_done, self.robot.gripper)
        return self._solve([home], motion.floor, arm, fingers, lambda: False, begin)

    def _solve(
        self,
        phases: Sequence[Phase],
        floor: float,
        arm: Array,
        fingers: Array,
        cancelled: Callable[[], bool],
        begin: float,
    ) -> Motion:
        def check() -> None:
            if cancelled():
                raise CancelledError("stopped on request while optimising")

        check()
        for phase in phases:
            if phase.kind == "pick" and (
                excess := too_wide(phase, self.settings.phases, self.settings.squeeze)
            ):
                raise InfeasibleError(
                    POSE,
                    f"width of {phase.object_name} between the open fingers",
                    object_name=phase.object_name,
                    violation=excess,
                    move=phase.move,
                    phase=phase.kind,
                )
        keyframes, problem = self.prepare(len(phases[0].columns))
        clear = Clearances(self.settings.path.margin, floor)
        switching = [phase for phase in phases if phase.kind != HOME]
        configurations = [arm, *keyframes.solve(arm, switching, clear), self.home]
        paths: list[PhasePath] = []
        for phase, start, goal in zip(phases, configurations, configurations[1:]):
            check()
            paths += problem.solve([phase], [start, goal], clear)
        check()
        trajectory = time_paths(
            paths, self.limits, self.timing, fingers, self.robot.gripper.finger_travel
        )
        return Motion(tuple(phases), tuple(paths), trajectory, floor, time.perf_counter() - begin)
