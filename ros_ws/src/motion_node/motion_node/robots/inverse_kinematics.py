# SPDX-License-Identifier: Apache-2.0
"""Damped Gauss-Newton inverse kinematics for a hand that points down, for many poses at once.

It only makes starting points; the bounds of :mod:`motion_node.bounds` decide what is feasible.
In C (``inverse_kinematics.c``) where that can be compiled, and else in numpy.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, opened, written

from ..nlp.buffered import Buffered
from ..nlp.compiled import loaded, machine_code
from .model import FREEDOMS_OF_A_POSE, HAND_ROWS, POSITION_ROWS, ArmModel

Array = NDArray[np.float64]

#: Rows this near are where they should be [m or rad].
_THERE: Final = 1e-6
_DAMPING: Final = 1e-5
#: No joint moves farther in an iteration [rad].
_LONGEST: Final = 0.5
_FILE: Final = Path(__file__).with_suffix(".c")


class InverseKinematics:
    """Configurations for poses of a downward hand, near given configurations."""

    def __init__(self, model: ArmModel) -> None:
        self._model = model
        self._maps: dict[int, Buffered] = {}
        library = machine_code(model.hand)
        self._function = loaded(model.hand, library)
        self._hand, self._steps = opened(library), written(_FILE)

    def _hands(self, q: Array) -> tuple[Array, Array]:
        """Rows (k, HAND_ROWS) and Jacobians (k, HAND_ROWS, n) at configurations (k, n).

        Both are overwritten by the next call.
        """
        count = len(q)
        if count not in self._maps:
            self._maps[count] = Buffered(self._function.map(count))
        rows, jacobians = self._maps[count](q.ravel())
        by_column = jacobians.reshape(count, -1, HAND_ROWS)
        return rows.reshape(count, HAND_ROWS), by_column.transpose(0, 2, 1)

    def solve(
        self, positions_world: Array, yaws: Array, near: Array, iterations: int = 25
    ) -> Array:
        """Configurations (k, n) that put the tool centre point at ``positions_world`` (k, 3) [m].

        The hand points down with its fingers along ``yaws`` (k,) [rad]. Each configuration is
        the projection of ``near`` (k, n) or (n,) onto the poses, so the elbow stays where it was.
        Poses out of reach yield the nearest configuration found.
        """
        positions = np.atleast_2d(positions_world)
        model, count = self._model, len(positions)
        q = np.array(np.broadcast_to(near, (count, model.dimension)), dtype=float, order="C")
        zeros = np.zeros(count)
        target = np.column_stack([positions, zeros, zeros, np.cos(yaws), np.sin(yaws)])
        target = np.ascontiguousarray(target)
        if self._hand is None or self._steps is None:
            return self._by_numpy(q, target, iterations)
        name, model = self._model.hand.name(), self._model
        room = [ctypes.c_longlong() for _ in range(4)]
        getattr(self._hand, f"{name}_work")(*map(ctypes.byref, room))
        sizes = np.array([size.value for size in room], dtype=np.intc)
        failed = self._steps.inverse(
            getattr(self._hand, name),
            address(sizes),
            *map(ctypes.c_int, (*q.shape, HAND_ROWS)),
            *map(address, (target, model.lower, model.upper)),
            ctypes.c_int(iterations),
            *map(ctypes.c_double, (_THERE, _DAMPING, _LONGEST)),
            address(q),
        )
        if failed:
            raise MemoryError("no memory for inverse kinematics")
        return q

    def _by_numpy(self, q: Array, target: Array, iterations: int) -> Array:
        """All configurations (k, n) at once, towards rows (k, HAND_ROWS)."""
        model = self._model
        for _ in range(iterations):
            rows, jacobian = self._hands(q)
            residual = rows - target
            if np.abs(residual).max() < _THERE:
                break
            gram = jacobian @ jacobian.transpose(0, 2, 1) + _DAMPING * np.eye(HAND_ROWS)
            step = jacobian.transpose(0, 2, 1) @ np.linalg.solve(gram, residual[:, :, None])
            step = np.clip(step[:, :, 0], -_LONGEST, _LONGEST)
            q = np.clip(q - step, model.lower, model.upper)
        return q

    def moved(self, q: Array, positions_world: Array) -> Array:
        """As :meth:`solve`, near configurations (k, n) and with the fingers' directions there."""
        rows, _ = self._hands(q)
        return self.solve(positions_world, np.arctan2(rows[:, -1], rows[:, -2]), q)

    def residual(self, q: Array, positions_world: Array) -> Array:
        """Tool centre points at configurations (k, n) less positions, shape (k, 3) [m]."""
        rows, _ = self._hands(q)
        return np.asarray(rows[:, :POSITION_ROWS] - positions_world)

    def self_motion(self, q: Array) -> Array:
        """Unit directions (k, n) in which configurations (k, n) move without moving the hand.

        An arm with one joint more than a pose asks for has one such direction, in which its elbow
        swings about the line from shoulder to wrist; the first joint's share is made positive.
        Zero for an arm without spare joints.
        """
        if self._model.dimension <= FREEDOMS_OF_A_POSE:
            return np.zeros_like(q)
        _, jacobian = self._hands(q)
        direction = np.linalg.svd(jacobian)[2][:, -1]
        return np.asarray(direction * np.where(direction[:, :1] < 0, -1.0, 1.0))
