# SPDX-License-Identifier: Apache-2.0
"""Fits models of blocks to what a picture says about them, with the covariance of the result.

Maximum likelihood: points are normal about the model's faces, the points of the outline about the
model's outline, to a fraction of a pixel. Gauss-Newton with Huber's weights, so that a few pixels
of another thing do little; the inverse of the normal matrix is the covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .descent import Lowest, Prior, Problem, descended
from .evidence import Evidence
from .models import Model

Array = NDArray[np.float64]

#: At first depths and outline count as if they were so much less exact, so that what is far off
#: pulls all the same: standard deviation of a surface [m], factor for the outline's.
COARSE: Final = (0.004, 2.0)
#: Trials of the coarse and of the exact descent, and steps that are the end of it [m, rad].
MAX_TRIALS: Final = (4, 7)
ENOUGH: Final = (1e-3, 1e-4)
#: By this much an extent is changed to see what the picture says of it [m].
PROBE: Final = 0.005


@dataclass(frozen=True)
class Fit:
    """A model that was fitted.

    Attributes:
        model: its kind.
        parameters: shape (P,).
        cost: half the sum of squared residuals, see :mod:`.descent`, a residual.
        off: of the n points from the model's faces, shape (n,) [m].
        distance: their root mean square, the farthest fifth left out [m].
        solved: what it was fitted in, together with others, and which of its blocks it is.
    """

    model: Model
    parameters: Array
    cost: float
    off: Array
    distance: float
    solved: tuple[Problem, Lowest, int]


def fit(
    model: Model, starts: Sequence[Array], priors: Sequence[Prior], evidence: Sequence[Evidence]
) -> list[Fit]:
    """Fits a model to each of B blocks.

    Args:
        starts: parameters to begin with, shape (P,) each.
        evidence: from one picture; at least one.
    """
    problem = Problem.of(model, priors, evidence)
    near = descended(
        problem.blurred(*COARSE), np.stack(starts), MAX_TRIALS[0], ENOUGH[0], offs=False
    )
    found = descended(problem, near.parameters, MAX_TRIALS[1], ENOUGH[1])
    fits = []
    for index, item in enumerate(evidence):
        off = found.off[index, : len(item.noise)]
        squares = np.sort(off**2)[: max(1, (4 * len(off)) // 5)]
        fits.append(
            Fit(
                model,
                found.parameters[index],
                float(found.cost[index]) / (len(item.noise) + len(item.outline)),
                off,
                float(np.sqrt(squares.mean())),
                (problem, found, index),
            )
        )
    return fits


def covariances(fits: Sequence[Fit]) -> list[Array]:
    """Of the parameters of each fit, shape (P, P): of those that are the best ones only."""
    together: dict[int, list[int]] = {}
    for number, item in enumerate(fits):
        together.setdefault(id(item.solved[0]), []).append(number)
    every: list[Array] = [np.empty(0)] * len(fits)
    for numbers in together.values():
        problem, found, _ = fits[numbers[0]].solved
        blocks = [fits[number].solved[2] for number in numbers]
        if blocks != list(range(len(found.cost))):
            problem, found = problem.only(blocks), Lowest(*(array[blocks] for array in found))
        for number, covariance in zip(numbers, _covariances(problem, found)):
            every[number] = covariance
    return every


def _covariances(problem: Problem, found: Lowest) -> Array:
    """Inverses of the information, shape (B, P, P), wider where the cost is flatter than it says.

    An edge at the back that the front just hides bounds a width on one side only: derivatives take
    it for known. So each extent is changed by :data:`PROBE` both ways, the front staying where it
    is, and what the cost says of that counts.
    """
    parameters, information = found.parameters, found.information
    covariances = np.linalg.inv(information)
    hidden = problem.model.hidden(parameters, problem.camera.position_world)
    if not len(hidden):
        return np.asarray(covariances, np.float64)
    # All at once, both ways of each direction as blocks of their own.
    changes = PROBE * np.concatenate([hidden, -hidden])
    changed = (parameters + changes).reshape(-1, parameters.shape[1])
    probed = descended(problem.repeated(len(changes)), changed, 0, 0.0, offs=False)
    rises = probed.cost.reshape(2, len(hidden), -1).min(axis=0) - found.cost
    # A parabola that rises by this much over the step has this variance.
    variances = PROBE**2 / (2.0 * np.maximum(rises, 1e-3))
    for directions, variance in zip(hidden, variances):
        mine = 1.0 / np.einsum("bp,bpq,bq->b", directions, information, directions)
        wider = np.maximum(variance - mine, 0.0)
        covariances += wider[:, None, None] * directions[:, :, None] * directions[:, None]
    return np.asarray(covariances, np.float64)
