# SPDX-License-Identifier: Apache-2.0
"""Damped Gauss-Newton inverse kinematics for a hand that points down, for many poses at once.

It only makes starting points; the bounds of :mod:`keyframes` decide what is feasible.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .features import Features

Array = NDArray[np.float64]


class InverseKinematics:
    """Configurations for poses of a downward hand, near given configurations.

    Args:
        lower, upper: joint limits, shape (n,) [rad].
    """

    def __init__(self, features: Features, lower: Array, upper: Array) -> None:
        self._function = features.pose
        self._lower, self._upper = lower, upper
        self._maps: dict[int, object] = {}

    def solve(
        self, positions_world: Array, yaws: Array, near: Array, iterations: int = 25
    ) -> Array:
        """Configurations (k, n) that put the tool centre point at ``positions_world`` (k, 3) [m].

        The hand points down with its fingers along ``yaws`` (k,) [rad]. Each configuration is
        the projection of ``near`` (k, n) or (n,) onto the poses, so the elbow stays where it was.
        Poses out of reach yield the nearest configuration found.
        """
        positions = np.atleast_2d(positions_world)
        count = len(positions)
        q = np.array(np.broadcast_to(near, (count, len(self._lower))), dtype=float)
        zeros = np.zeros(count)
        target = np.column_stack([positions, zeros, zeros, np.cos(yaws), np.sin(yaws)])
        if count not in self._maps:
            self._maps[count] = self._function.map(count)
        function = self._maps[count]
        for _ in range(iterations):
            values, jacobians = function(q.T)  # type: ignore[operator]
            residual = np.array(values).T - target
            if np.abs(residual).max() < 1e-6:
                break
            jacobian = np.array(jacobians).reshape(7, count, -1).transpose(1, 0, 2)
            gram = jacobian @ jacobian.transpose(0, 2, 1) + 1e-5 * np.eye(7)
            step = jacobian.transpose(0, 2, 1) @ np.linalg.solve(gram, residual[:, :, None])
            q = np.clip(q - np.clip(step[:, :, 0], -0.5, 0.5), self._lower, self._upper)
        return q

    def residual(self, q: Array, positions_world: Array) -> Array:
        """Tool centre points at configurations (k, n) less positions, shape (k, 3) [m]."""
        values, _ = self._function.map(len(q))(q.T)
        return np.asarray(np.array(values).T[:, :3] - positions_world)

    def self_motion(self, q: Array) -> Array:
        """Unit directions (k, n) in which configurations (k, n) move without moving the hand.

        An arm with seven joints has one such direction, in which its elbow swings about the line
        from shoulder to wrist; the first joint's share is made positive.
        """
        _, jacobians = self._function.map(len(q))(q.T)
        jacobian = np.array(jacobians).reshape(7, len(q), -1).transpose(1, 0, 2)
        direction = np.linalg.svd(jacobian)[2][:, -1]
        return np.asarray(direction * np.where(direction[:, :1] < 0, -1.0, 1.0))
