# SPDX-License-Identifier: Apache-2.0
"""From a scene, moves and the arm's state to a trajectory: P1, P2, then P3, then times."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move, SceneGraph

from .blocks import Scene, read_scene
from .bounds import JointProblem, Keyframes, PathProblem, SwitchProblems, Undivided, check_widths
from .bounds.costs import joined
from .choosing import solve_choosing
from .constraints import (
    Clearances,
    Constraint,
    ObstacleClearance,
    capacity_for,
    default_constraints,
)
from .dense_check import check as dense_check
from .errors import PATH, CancelledError, InfeasibleError
from .expand import (
    SPARE_RISE,
    TALLEST,
    USUAL_STACKS,
    Choice,
    expand,
    only_for,
    open_tool,
    put_down,
    rise_home,
    something_held,
    way_home,
)
from .motion import Motion
from .nlp import SOLVERS
from .obstacles import Obstacle
from .phases import PLACE, Phase, PhasePath
from .refining import FREE, refined
from .robots import PANDA, Arm
from .robots.inverse_kinematics import InverseKinematics
from .robots.model import ArmModel
from .settings import Settings
from .timing.limits import JointLimits
from .timing.time_paths import time_paths
from .timing.trajectory import Trajectory

__all__ = ["Motion", "MotionPlanner"]

Array = NDArray[np.float64]

#: Phases that are left when a block is in the hand and no more is to be done than put it down.
_PUT_DOWN: Final = 2


class MotionPlanner:
    """The motion problem of 5.1 for one arm; usable without ROS.

    >>> planner = MotionPlanner(urdf_text)                               # doctest: +SKIP
    >>> motion = planner.solve(graph, [Move(0, 2)], q, fingers)          # doctest: +SKIP

    Args:
        description: the URDF's text.
        constraints: what motions have to keep to; :func:`default_constraints` if not given.
        obstacles: what stands around besides blocks.

    Attributes:
        model: the arm with its URDF.
        inverse: its inverse kinematics.
        timing: may be changed between plans.

    Raises:
        RobotDescriptionError: if the description lacks a joint or link of ``arm``.
        ValueError: if there is no solver of the settings' name.
    """

    def __init__(
        self,
        description: str,
        arm: Arm = PANDA,
        settings: Settings | None = None,
        constraints: Sequence[Constraint] | None = None,
        obstacles: Sequence[Obstacle] = (),
    ) -> None:
        self.arm = arm
        self.settings = settings or Settings()
        if self.settings.solver not in SOLVERS:
            raise ValueError(
                f"there is no solver {self.settings.solver!r}; there is {', '.join(SOLVERS)}"
            )
        self._solver = SOLVERS[self.settings.solver]
        self.model = ArmModel(description, arm, self.settings.limit_margin)
        self.inverse = InverseKinematics(self.model)
        chosen = default_constraints(arm) if constraints is None else constraints
        self.obstacles = tuple(obstacles)
        self._shape = self.settings.path
        self._among: ObstacleClearance | None = None
        if obstacles:
            # Steps so near to one another that no wall fits in between.
            between = self._shape.steps - 2 * self._shape.vertical
            self._shape = replace(self._shape, steps=self._shape.steps + between)
            self._among = ObstacleClearance(arm, obstacles, capacity_for(len(obstacles)))
            chosen = (*chosen, self._among)
        self.constraints = tuple(chosen)
        self.limits = JointLimits(self.model.kinematics.velocity, np.array(arm.acceleration))
        self.timing = self.settings.timing
        self._bounds: dict[int, tuple[Keyframes, PathProblem]] = {}
        self._undivided: dict[int, Undivided] = {}

    def prepare(self, stacks: int, moves: int = 0) -> tuple[Keyframes, PathProblem]:
        """Builds the problems for a number of stacks, and those for a number of moves, once."""
        if stacks not in self._bounds:
            problems = SwitchProblems(self.model, stacks, self.constraints, self._solver)
            path, steps = self.path_problem(stacks), self._shape.steps

            def make(phases: int, kept: Sequence[int] = range(steps)) -> JointProblem:
                return JointProblem(
                    *(self.model, path.groups, problems.groups, self.limits.acceleration),
                    *(self._solver, phases, steps, kept),
                )

            keyframes = Keyframes(problems, self.inverse, path, make, self._shape)
            keyframes.problem(_PUT_DOWN)
            self._bounds[stacks] = (keyframes, path)
            self._undivided[stacks] = Undivided(problems, path, make, steps)
        keyframes, path = self._bounds[stacks]
        if moves:
            keyframes.problem(2 * moves + 1)
            if self.settings.joint:
                self.undivided(stacks).problem(2 * moves + 1)
        return keyframes, path

    def undivided(self, stacks: int) -> Undivided:
        """P3 over all phases and switches at once, for a number of stacks."""
        self.prepare(stacks)
        return self._undivided[stacks]

    def surround(self, obstacles: Sequence[Obstacle]) -> None:
        """Other obstacles from now on, for a planner that was made with as many or more.

        Raises:
            ValueError: if there are more than its problems are built for.
        """
        if not obstacles or self._among is None or len(obstacles) > self._among.capacity:
            raise ValueError(f"the problems are not built for {len(obstacles)} obstacles")
        self.obstacles = tuple(obstacles)
        self._among.surround(obstacles)
        for _, path in self._bounds.values():
            path.obstacles = self.obstacles

    def path_problem(self, stacks: int, phases: int = 1) -> PathProblem:
        """P3 for a number of stacks, over one phase or several that are solved at once."""
        return PathProblem(
            self.model,
            stacks,
            self.constraints,
            self.inverse,
            self.limits.acceleration,
            self._shape,
            self._solver,
            phases,
            self.obstacles,
        )

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
        scene, settings = read_scene(graph), self.settings
        gripper = self.arm.gripper

        def phases_for(
            own: Scene, some: Sequence[Move], choices: Sequence[Choice]
        ) -> Sequence[Phase]:
            names = object_names if own is scene else ()
            return expand(own, some, gripper, settings.phases, settings.squeeze, names, choices)

        def solve(
            phases: Sequence[Phase], own: Scene, at_home: bool, sampled: bool = True
        ) -> Motion:
            start = self.model.home if at_home else arm
            return self._solve(
                *(phases, scene.floor, start, fingers, cancelled, begin),
                scene=own,
                sampled=sampled,
            )

        try:
            if not self.obstacles:
                with suppress(InfeasibleError):  # other grasps are tried only then
                    return solve(phases_for(scene, moves, ()), scene, False, sampled=False)
            return solve_choosing(
                *(scene, moves, phases_for, solve),
                lambda move: only_for(scene, moves, move, gripper, settings.phases),
            )
        except InfeasibleError as error:
            if scene.aside:
                error.add(f"in the plan's scene {scene.aside}")
            raise

    def solve_way_home(self, motion: Motion, moves_done: int, arm: Array, fingers: Array) -> Motion:
        """The way home of an empty hand in the middle of a plan: open, rise, go home.

        Raises:
            InfeasibleError: if the path has no solution.
        """
        begin = time.perf_counter()
        home = way_home(motion.phases, moves_done, self.arm.gripper)
        return self._solve([home], motion.floor, arm, fingers, begin=begin)

    def solve_put_down(self, motion: Motion, move: int, arm: Array) -> Motion:
        """The rest of a move whose block is in the hand, from wherever the arm is, and home.

        Raises:
            InfeasibleError: if there is no such path, or the motion does not place that block.
        """
        begin = time.perf_counter()
        phases = put_down(motion.phases, move)
        if phases is None:
            raise InfeasibleError(PATH, "a place for the block", move=move, phase=PLACE)
        # The fingers press on: where they stand is not where they are sent.
        pressing = np.full(2, phases[0].tool.finger)
        return self._solve(phases, motion.floor, arm, pressing, begin=begin, opening=False)

    def solve_rise_home(
        self, motion: Motion | None, arm: Array, fingers: Array, held: str = ""
    ) -> Motion:
        """Straight up, and home, whatever stands around the hand; what is held stays in it.

        Args:
            motion: the last one that is known, which says how high stacks are; there may be none.
            held: what the hand holds.

        Raises:
            InfeasibleError: if there is no such path.
        """
        begin = time.perf_counter()
        floor, stacks, top = 0.0, USUAL_STACKS, TALLEST
        tool = open_tool(self.arm.gripper)
        if held:
            opening = float(np.mean(fingers))
            tool = something_held(self.arm.gripper, opening, held, self.settings.squeeze)
        if motion is not None and motion.phases:
            floor, stacks = motion.floor, len(motion.phases[0].columns)
            top = max(column.top for phase in motion.phases for column in phase.columns)
            for phase in motion.phases:
                if held and phase.tool.held == held:
                    tool = phase.tool
        x, y, z = (float(value) for value in self.model.tool_at(arm))
        fingers = np.full(2, tool.finger) if held else fingers
        lower = z - self.settings.path.lift
        # Where the arm cannot rise as high as would be safe, less has to do.
        for height in (floor + max(top, TALLEST), top + SPARE_RISE, lower):
            phase = rise_home((x, y, z), stacks, height, tool)
            try:
                return self._solve([phase], floor, arm, fingers, begin=begin, opening=not held)
            except InfeasibleError as error:
                failure = error
        raise failure

    def _solve(
        self,
        phases: Sequence[Phase],
        floor: float,
        arm: Array,
        fingers: Array,
        cancelled: Callable[[], bool] = lambda: False,
        begin: float = 0.0,
        opening: bool = True,
        scene: Scene | None = None,
        sampled: bool = False,
    ) -> Motion:
        def check() -> None:
            if cancelled():
                raise CancelledError("stopped on request while planning the motion")

        check()
        check_widths(phases, self.settings.phases.max_grasp_width)
        keyframes, problem = self.prepare(len(phases[0].columns))
        clear = Clearances(self.settings.path.margin, floor)
        ways = keyframes.solve(arm, phases, clear, sampled)
        guesses = problem.guesses(ways)

        def solve_one(index: int, kept: Clearances) -> PhasePath:
            check()
            way = ways[index]
            if kept is clear:
                return problem.solve_ways([way], [guesses[index]])[0]
            ends = [way.start_q, way.goal_q]
            return problem.solve([way.phase], ends, kept, [guesses[index]])[0]

        def timed(paths: Sequence[PhasePath]) -> Trajectory:
            first = self.arm.gripper.finger_travel if opening else None
            return time_paths(paths, self.limits, self.timing, fingers, first)

        paths = [solve_one(index, clear) for index in range(len(phases))]
        if self.settings.joint and len(phases) > 1:
            whole = self.undivided(len(phases[0].columns))
            check()
            together = whole.solve(phases, joined([path.q for path in paths]), clear)
            if together is not None and whole.cost(together) < whole.cost(paths):
                paths = together
                ways = [way.between(p.q[0], p.q[-1]) for way, p in zip(ways, paths)]
        check()
        if self.obstacles:
            paths, trajectory = refined(
                *(paths, clear, solve_one, timed),
                lambda sent: dense_check(self.model, sent, scene, self.obstacles, FREE, floor),
                frozenset(item.name for item in self.obstacles),
            )
        else:
            trajectory = timed(paths)
        return Motion(tuple(phases), tuple(paths), trajectory, floor, time.perf_counter() - begin)
