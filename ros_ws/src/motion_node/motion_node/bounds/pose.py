# SPDX-License-Identifier: Apache-2.0
"""The bound P1 of 3.4: one configuration that does what one switch asks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import POSE, TAKING, InfeasibleError
from ..nlp import Demand
from ..phases import PICK, Phase
from ..robots.inverse_kinematics import InverseKinematics
from .switches import SwitchProblems

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Guess:
    """A configuration (n,), by how much it misses what is asked, rounded to mm, and how far its
    elbow is swung from upright."""

    q: Array
    score: float
    swing: int = 0


def check_widths(phases: Sequence[Phase], max_width: float) -> None:
    """The part of P1 that no configuration can change: a block between the open fingers.

    Args:
        max_width: widest block that they go around [m].

    Raises:
        InfeasibleError: with bound ``pose`` if a block is wider.
    """
    for phase in phases:
        if phase.kind == PICK and phase.grasp and phase.grasp.width > max_width:
            raise InfeasibleError(
                POSE,
                f"width of {phase.object_name} between the open fingers",
                object_name=phase.object_name,
                violation=phase.grasp.width - max_width,
                move=phase.move,
                phase=phase.kind,
                excludes=TAKING,
            )


class Poses:
    """Solves P1 from starting points that suit the arm."""

    def __init__(self, problems: SwitchProblems, inverse: InverseKinematics) -> None:
        self._problems, self._inverse = problems, inverse

    def solve(self, phases: Sequence[Phase], demands: Sequence[Demand]) -> list[Array]:
        """A configuration (n,) at the end of each phase, near the rest posture.

        Args:
            demands: of the groups, a step a phase.

        Raises:
            InfeasibleError: with bound ``pose``.
        """
        return [
            self._solve_one(phase, [demand.at([index]) for demand in demands], own)
            for index, (phase, own) in enumerate(zip(phases, self.guesses(phases, demands)))
        ]

    def _solve_one(
        self, phase: Phase, demands: Sequence[Demand], guesses: Sequence[Guess]
    ) -> Array:
        if guesses[0].score == 0.0:
            return guesses[0].q
        failed = []
        for guess in guesses:
            solution = self._problems.solve(self._problems.model.home, [guess.q], demands)
            if solution.feasible:
                return np.asarray(solution.x[1])
            failed.append(solution)
        least = min(failed, key=lambda item: item.violation)
        raise self._problems.error(POSE, least, [phase])

    def guesses(self, phases: Sequence[Phase], demands: Sequence[Demand]) -> list[list[Guess]]:
        """Configurations near the rest posture turned towards each switch, the best one first.

        The arm may have a joint more than a pose asks for. Beside a tall stack the forearm has to
        lean away from it, which is another valley than the upright one; so the elbow is swung to
        either side in steps, where an upright configuration does not serve.
        """
        model, inverse = self._problems.model, self._inverse
        switches = [phase.switch for phase in phases if phase.switch]
        positions = np.array([switch.position_world for switch in switches])
        near, directions = model.arm.seeding.turned(
            model.home,
            model.hand_at(model.home)[1],
            np.arctan2(positions[:, 1], positions[:, 0]),
            np.array([switch.yaw for switch in switches]),
            model.lower,
            model.upper,
        )
        upright = inverse.solve(positions, directions, near)

        def score(configurations: Array) -> Array:
            missed = np.abs(inverse.residual(configurations, positions)).max(axis=1)
            return np.round(self._problems.excess(configurations, demands) + 10 * missed, 3)

        found = [[Guess(q, float(s))] for q, s in zip(upright, score(upright))]
        left = [index for index, own in enumerate(found) if own[0].score > 0.0]
        if not left:
            return found
        positions, directions, upright = positions[left], directions[left], upright[left]
        demands = [demand.at(left) for demand in demands]
        seeding = model.arm.seeding
        for side in (1.0, -1.0):
            q = upright
            for step in range(seeding.swings):
                swung = q + side * seeding.swing_step * inverse.self_motion(q)
                q = inverse.solve(positions, directions, swung, iterations=8)
                for index, configuration, value in zip(left, q, score(q)):
                    found[index].append(Guess(configuration, float(value), step + 1))
        return [sorted(own, key=lambda guess: (guess.score, guess.swing)) for own in found]
