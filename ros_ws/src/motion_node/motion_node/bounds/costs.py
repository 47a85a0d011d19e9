# SPDX-License-Identifier: Apache-2.0
"""What paths cost (5.1): squared accelerations and velocities; the least of it through knots."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..nlp import DifferenceCost

Array = NDArray[np.float64]


def path_costs(phases: int, intervals: int, acceleration: Array) -> list[DifferenceCost]:
    """Of phases one after another, each from rest to rest.

    Args:
        intervals: of a phase.
        acceleration: acceleration limits, shape (n,) [rad/s²]; they weigh the joints.
    """
    weights = (np.median(acceleration) / acceleration) ** 2 * intervals**3 / 10.0
    steps = phases * intervals + 1
    velocities = np.eye(steps)[1:] - np.eye(steps)[:-1]
    return [
        DifferenceCost(_accelerations(phases, intervals), weights),
        DifferenceCost(velocities, np.full(len(acceleration), 3.0 * intervals)),
    ]


def least_through(costs: Sequence[DifferenceCost], kept: Sequence[int]) -> list[DifferenceCost]:
    """The least that costs can be, all steps but some being free, as costs of these.

    What is minimised over is a Schur complement of each joint's Hessian, whose root is the
    operator.
    """
    n, steps = len(costs[0].weights), costs[0].differences.shape[1]
    grams = [cost.differences.T @ cost.differences for cost in costs]
    here, left = np.array(kept), np.setdiff1d(np.arange(steps), kept)
    found = []
    for joint, axis in enumerate(np.eye(n)):
        full = sum(cost.weights[joint] * gram for cost, gram in zip(costs, grams))
        across = full[np.ix_(left, here)]
        least = full[np.ix_(here, here)]
        least = least - across.T @ np.linalg.solve(full[np.ix_(left, left)], across)
        values, vectors = np.linalg.eigh(least)
        root = (vectors * np.sqrt(np.maximum(values, 0.0))).T
        found.append(DifferenceCost(root, axis))
    return found


def joined(parts: Sequence[Array]) -> Array:
    """The configurations of phases (steps + 1, n) as one array: each begins where one ends."""
    return np.vstack([parts[0], *[part[1:] for part in parts[1:]]])


def _accelerations(phases: int, intervals: int) -> Array:
    """Second differences over the steps of phases, each at rest at both ends.

    By central differences: x_{-1} = x_1 and x_{T+1} = x_{T-1}, which stand for the prefix of 3.4.
    """
    result = np.zeros((phases * (intervals + 1), phases * intervals + 1))
    for k in range(phases):
        index = intervals - np.abs(intervals - np.abs(np.arange(-1, intervals + 2)))
        index += k * intervals
        for row in range(intervals + 1):
            for offset, factor in enumerate((1.0, -2.0, 1.0)):
                result[k * (intervals + 1) + row, index[row + offset]] += factor
    return result
