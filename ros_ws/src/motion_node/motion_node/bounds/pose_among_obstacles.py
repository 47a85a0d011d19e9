# SPDX-License-Identifier: Apache-2.0
"""The bound P1 among obstacles: quick to refuse, and with the reason that a person can act on.

The hand's pose at a switch leaves an arm of seven joints one freedom, the swing of its elbow, which
is sampled from end to end. So what no sample comes near is refused without solvers that take
seconds, and what is missing is told with the hand where it has to be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..blocks import Column
from ..constraints import Clearances
from ..errors import POSE, PUTTING, SCENE, TAKING, InfeasibleError
from ..nlp import Demand
from ..phases import PICK, Phase
from .pose import Guess, Poses

Array = NDArray[np.float64]

#: Solved from so many of the best samples.
_TRIED: Final = 3
#: A hand this near is where it has to be [m].
_THERE: Final = 2e-3


class PosesAmongObstacles(Poses):
    """P1 switch by switch; failures say whether the other stacks have to do with it."""

    def solve_all(self, phases: Sequence[Phase], clear: Clearances) -> list[Array]:
        """As :meth:`solve`, for phases that end with a switch.

        Raises:
            InfeasibleError: with bound ``pose``; its ``excludes`` tells how much is excluded.
        """
        demands = self._problems.demands(phases, clear)
        found = []
        for index, (phase, own) in enumerate(zip(phases, self.guesses(phases, demands))):
            here = [demand.at([index]) for demand in demands]
            q = self._try(own, here)
            if q is None:
                raise self._verdict(phase, own, here, clear)
            found.append(q)
        return found

    def possible(self, phase: Phase, demands: Sequence[Demand]) -> bool:
        """Whether a pose is found for a phase with these demands."""
        return self._try(self.guesses([phase], demands)[0], demands) is not None

    def verdict(self, phase: Phase, clear: Clearances) -> InfeasibleError:
        """Why, where P1 was found to have no solution for a phase."""
        demands = self._problems.demands([phase], clear)
        return self._verdict(phase, self.guesses([phase], demands)[0], demands, clear)

    def _try(self, guesses: Sequence[Guess], demands: Sequence[Demand]) -> Array | None:
        if guesses[0].score == 0.0:
            return guesses[0].q
        for guess in guesses[:_TRIED]:
            home = self._problems.model.home
            solution = self._problems.solve(home, [guess.q], demands, thorough=False)
            if solution.feasible:
                return np.asarray(solution.x[1])
        return None

    def _verdict(
        self,
        phase: Phase,
        guesses: Sequence[Guess],
        demands: Sequence[Demand],
        clear: Clearances,
    ) -> InfeasibleError:
        """Why there is no pose, with the hand as near as it comes."""
        assert phase.switch is not None
        position = np.array(phase.switch.position_world)
        q = np.array([guess.q for guess in guesses])
        missed = np.linalg.norm(self._inverse.residual(q, position), axis=1)
        fixed = TAKING if phase.kind == PICK else PUTTING
        if missed.min() > _THERE:
            q = self._inverse.moved(q, np.tile(position, (len(q), 1)))
            missed = np.linalg.norm(self._inverse.residual(q, position), axis=1)
            return InfeasibleError(
                POSE,
                f"{_reach(phase)}{self._at_limits(q[missed.argmin()])}",
                object_name=phase.object_name,
                violation=float(missed.min()),
                move=phase.move,
                phase=phase.kind,
                excludes=fixed,
            )
        there = [guess for guess, far in zip(guesses, missed) if far <= _THERE]
        worst = min(
            (self._problems.worst_but_the_hands_pose(guess.q, demands) for guess in there),
            key=lambda violation: violation.amount,
        )
        error = worst.error(POSE, phase)
        error.excludes = SCENE
        alone = replace(phase, columns=_alone(phase, clear))
        demands = self._problems.demands([alone], clear)
        if not self.possible(alone, demands):
            error.excludes = fixed
            if error.constraint.endswith(f" to stack{phase.switch.stack}"):
                # The hand gets there only with the arm in the stack that it is to stand on.
                error.constraint = f"{_reach(phase)} with {error.constraint}"
        return error

    def _at_limits(self, q: Array) -> str:
        """Which joints of a configuration (n,) are as far as they go, to end a sentence."""
        model = self._problems.model
        end = np.isclose(q, model.lower, atol=1e-3) | np.isclose(q, model.upper, atol=1e-3)
        names = [name for name, there in zip(model.arm.arm_joints, end) if there]
        return f", with {' and '.join(names)} at the limit" if names else ""


def _reach(phase: Phase) -> str:
    assert phase.switch is not None
    x, y, z = phase.switch.position_world
    return f"reach of the hand to ({x:.2f}, {y:.2f}, {z:.2f}) at stack{phase.switch.stack}"


def _alone(phase: Phase, clear: Clearances) -> tuple[Column, ...]:
    """The stacks as if there were only that of the switch."""
    assert phase.switch is not None
    empty = [Column(column.center, (0.0, 0.0), clear.floor) for column in phase.columns]
    empty[phase.switch.stack] = phase.columns[phase.switch.stack]
    return tuple(empty)
