# SPDX-License-Identifier: Apache-2.0
"""The bounds P1 (a single pose) and P2 (the switches of the whole sequence) of 3.4.

P2 minimises the squared joint distances between consecutive switches. For a path from rest to
rest in a time T the least integral of squared accelerations is 12 |q_b - q_a|^2 / T^3, so this is
the value that P3 would have without its path constraints: a lower bound, and the right place to
decide what P3 then keeps fixed, the switches themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .errors import KEYFRAMES, POSE, InfeasibleError
from .features import LEAN_ROWS, SMOOTHING, SWITCH_ROWS, Features
from .inverse_kinematics import InverseKinematics
from .k_order import Attached, Bounds, DifferenceCost, KOrderProblem, Solution
from .phases import Column, Phase, Switch, Tool

Array = NDArray[np.float64]

#: Weight of the distance to the rest posture against the distance between keyframes.
POSTURE_WEIGHT = 0.02


@dataclass(frozen=True)
class Clearances:
    """Distances that are kept.

    Attributes:
        margin: between the arm with what it holds and the blocks and the table [m].
        floor: height of the table [m].
    """

    margin: float
    floor: float


@dataclass(frozen=True)
class _Guess:
    """A configuration (n,), by how much it misses pose and clearances, rounded to mm, and how far
    its elbow is swung from upright."""

    q: Array
    score: float
    swing: int = 0


def lowered(
    columns: tuple[Column, ...], switch: Switch, tool: Tool, tcp_offset: float, margin: float
) -> tuple[Column, ...]:
    """The stacks while the hand moves vertically to or from a switch.

    The stack of the switch ends below what hangs from the palm: there the hand means to touch it,
    and the vertical line keeps it apart.
    """
    bottom = switch.position_world[2] + tcp_offset - tool.bottom
    top = bottom - margin - SMOOTHING - 0.002
    own = columns[switch.stack]
    result = list(columns)
    result[switch.stack] = replace(own, top=min(own.top, float(top)))
    return tuple(result)


class Keyframes:
    """Solves P1 and P2 for one arm and number of stacks.

    Args:
        lower, upper: joint limits, shape (n,) [rad].
    """

    def __init__(
        self, features: Features, inverse: InverseKinematics, lower: Array, upper: Array
    ) -> None:
        self.features, self.inverse = features, inverse
        self.lower, self.upper = lower, upper
        self.home = np.array(features.robot.home)
        self._problems: dict[int, KOrderProblem] = {}

    def problem(self, count: int) -> KOrderProblem:
        """P2 for ``count`` switches between a start and home; P1 if there is one. Built once."""
        if count not in self._problems:
            steps, n = count + 2, self.features.dimension
            differences = np.eye(steps)[1:] - np.eye(steps)[:-1]
            if count == 1:
                differences = differences[:0]
            posture = np.eye(steps) - np.eye(steps)[:, [-1]] @ np.ones((1, steps))
            free = tuple(range(1, count + 1))
            self._problems[count] = KOrderProblem(
                n,
                steps,
                fixed=(0, steps - 1),
                costs=[
                    DifferenceCost(differences, np.ones(n)),
                    DifferenceCost(posture[1:-1], POSTURE_WEIGHT * np.ones(n)),
                ],
                attached=[Attached(self.features.path, free), Attached(self.features.switch, free)],
            )
        return self._problems[count]

    def guesses(self, phases: Sequence[Phase], bounds: Sequence[Bounds]) -> list[list[_Guess]]:
        """Configurations near the rest posture turned towards each switch, the best one first.

        The arm has one joint more than a pose asks for. Beside a tall stack the forearm has to
        lean away from it, which is another valley than the upright one; so the elbow is swung to
        either side in steps, unless upright configurations serve for all switches.
        """
        switches = [phase.switch for phase in phases if phase.switch]
        positions = np.array([switch.position_world for switch in switches])
        yaws = np.array([switch.yaw for switch in switches])
        near, directions = self._turned(np.arctan2(positions[:, 1], positions[:, 0]), yaws)
        upright = self.inverse.solve(positions, directions, near)
        path = self.features.path.value.map(len(switches))

        def score(configurations: Array) -> Array:
            gaps = np.array(path(configurations.T, bounds[0].parameters.T)).T
            short = np.maximum(bounds[0].lower - gaps, 0.0)[:, LEAN_ROWS:].sum(axis=1)
            missed = np.abs(self.inverse.residual(configurations, positions)).max(axis=1)
            return np.round(short + 10 * missed, 3)

        found = [[_Guess(q, float(s))] for q, s in zip(upright, score(upright))]
        if all(own[0].score == 0.0 for own in found):
            return found
        seeding = self.features.robot.seeding
        for side in (1.0, -1.0):
            q = upright
            for step in range(seeding.swings):
                swung = q + side * seeding.swing_step * self.inverse.self_motion(q)
                q = self.inverse.solve(positions, directions, swung, iterations=8)
                for own, configuration, value in zip(found, q, score(q)):
                    own.append(_Guess(configuration, float(value), step + 1))
        return [sorted(own, key=lambda guess: (guess.score, guess.swing)) for own in found]

    def _turned(self, azimuths: Array, yaws: Array) -> tuple[Array, Array]:
        """See :meth:`Seeding.turned`."""
        _, home_yaw = self.features.hand_pose(self.home)
        return self.features.robot.seeding.turned(
            self.home, home_yaw, azimuths, yaws, self.lower, self.upper
        )

    def bounds(self, phases: Sequence[Phase], clear: Clearances) -> list[Bounds]:
        """Bounds and parameters of both features at the end of each phase."""
        features = self.features
        path_rows = features.path.rows
        offset = features.robot.gripper.tcp_offset
        modes, references, heights = [], [], []
        for phase in phases:
            assert phase.switch is not None
            columns = lowered(phase.columns, phase.switch, phase.tool, offset, clear.margin)
            modes.append(features.mode(columns, phase.tool, clear.floor, clear.margin))
            x, y, z = phase.switch.position_world
            references.append((x, y, phase.switch.yaw))
            heights.append(z)
        count = len(phases)
        lower, upper = np.zeros((count, path_rows)), np.full((count, path_rows), np.inf)
        upper[:, :LEAN_ROWS] = 0.0
        lower[:, features.tool_floor_row] = -np.inf  # what stands on the table touches it
        exact = np.zeros((count, SWITCH_ROWS))
        exact[:, 3] = heights
        return [Bounds(np.array(modes), lower, upper), Bounds(np.array(references), exact, exact)]

    def solve(self, start: Array, phases: Sequence[Phase], clear: Clearances) -> Array:
        """P2: configurations at the switches of all phases but the way home, shape (k, n).

        Args:
            start: configuration before the first phase, shape (n,) [rad].
            phases: those that end with a switch.

        Raises:
            InfeasibleError: with bound ``pose`` where one switch alone has no solution, else with
                ``keyframes``.
        """
        if not phases:
            return np.zeros((0, self.features.dimension))
        bounds = self.bounds(phases, clear)
        guesses = self.guesses(phases, bounds)
        poses = [
            self._solve_pose(phase, bounds, index, own)
            for index, (phase, own) in enumerate(zip(phases, guesses))
        ]
        x = np.vstack([start, *poses, self.home])
        solution = self.problem(len(phases)).solve(x, bounds, self.lower, self.upper)
        if solution.feasible:
            return solution.x[1:-1]
        raise self._error(KEYFRAMES, solution, phases)

    def _solve_pose(
        self, phase: Phase, bounds: Sequence[Bounds], index: int, guesses: Sequence[_Guess]
    ) -> Array:
        """P1: a configuration at the end of one phase, near the rest posture, shape (n,).

        Raises:
            InfeasibleError: with bound ``pose``.
        """
        if guesses[0].score == 0.0:
            return guesses[0].q
        own = [
            Bounds(*(rows[[index]] for rows in (item.parameters, item.lower, item.upper)))
            for item in bounds
        ]
        failed = []
        for guess in guesses:
            x = np.vstack([self.home, guess.q, self.home])
            solution = self.problem(1).solve(x, own, self.lower, self.upper)
            if solution.feasible:
                return np.asarray(solution.x[1])
            failed.append(solution)
        raise self._error(POSE, min(failed, key=lambda item: item.violation), [phase])

    def _error(self, bound: str, solution: Solution, phases: Sequence[Phase]) -> InfeasibleError:
        which = int(np.argmax([rows.max() for rows in solution.violations]))
        rows = solution.violations[which]
        step, row = (int(i) for i in np.unravel_index(int(rows.argmax()), rows.shape))
        phase = phases[step]
        assert phase.switch is not None
        path_names = self.features.path_names(phase.tool)
        names = path_names if which == 0 else self.features.switch_names(phase.switch)
        return InfeasibleError(
            bound,
            names[row],
            object_name=phase.object_name,
            violation=float(rows.max()),
            move=phase.move,
            phase=phase.kind,
        )
