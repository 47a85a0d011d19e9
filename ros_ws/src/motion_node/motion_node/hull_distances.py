# SPDX-License-Identifier: Apache-2.0
"""Distances between hulls in numbers, for many moments at once; shared with no constraint.

Upright bodies that stand still against boxes and spheres that move. What is told is never more than
the distance: of boxes the largest gap along the axes that can separate them, which is negative
exactly where they overlap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Farther apart than this by the spheres around them, bodies are not looked at closer [m].
NEAR = 0.1
_TINY = 1e-9


@dataclass(frozen=True)
class Upright:
    """Bodies that stand still: boxes turned about the vertical, or cylinders.

    Attributes:
        names: of each.
        center, half: shapes (m, 3) [m].
        yaw: shape (m,) [rad].
        round: whether it is the cylinder of radius ``half[:, 0]``, shape (m,).
    """

    names: tuple[str, ...]
    center: Array
    half: Array
    yaw: Array
    round: NDArray[np.bool_]

    def __getitem__(self, index: NDArray[np.int_]) -> Upright:
        """Those at an index, one a row, names left out."""
        return Upright((), self.center[index], self.half[index], self.yaw[index], self.round[index])

    @property
    def radius(self) -> Array:
        """Of the spheres around them, shape (m,) [m]."""
        return np.linalg.norm(self.half, axis=1)

    @property
    def axes(self) -> Array:
        """Own axes as rows, shape (m, 3, 3)."""
        cos, sin, zero = np.cos(self.yaw), np.sin(self.yaw), np.zeros_like(self.yaw)
        rows = [(cos, sin, zero), (-sin, cos, zero), (zero, zero, zero + 1)]
        return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)

    def reach(self, directions: Array) -> Array:
        """Half extents along directions (m, a, 3) of each, shape (m, a) [m]."""
        own = np.abs(directions @ self.axes.transpose(0, 2, 1)) * self.half[:, None]
        level = np.hypot(directions[..., 0], directions[..., 1]) * self.half[:, [0]]
        beside = np.where(self.round[:, None], level, own[..., 0] + own[..., 1])
        return np.asarray(beside + own[..., 2])


@dataclass(frozen=True)
class MovingBox:
    """A box at k moments.

    Attributes:
        rotation: its axes as columns, shape (k, 3, 3).
        center: shape (k, 3) [m].
        half: shape (3,) [m].
    """

    rotation: Array
    center: Array
    half: Array

    @property
    def radius(self) -> float:
        """Of the sphere around it [m]."""
        return float(np.linalg.norm(self.half))

    def above(self, height: float) -> Array:
        """Of its lowest point above a height, shape (k,) [m]."""
        return np.asarray(self.center[:, 2] - np.abs(self.rotation[:, 2]) @ self.half - height)

    def gaps(self, others: Upright) -> Array:
        """To each of m bodies, shape (k, m) [m]; of what is far away no more than spheres tell."""
        delta = self.center[:, None] - others.center
        gaps = np.linalg.norm(delta, axis=2) - self.radius - others.radius
        moments, which = np.nonzero(gaps < NEAR)
        if len(moments):
            near = self._separated(moments, delta[moments, which], others[which])
            gaps[moments, which] = np.maximum(gaps[moments, which], near)
        return gaps

    def _separated(self, moments: NDArray[np.int_], delta: Array, others: Upright) -> Array:
        """Largest gaps along axes at some moments to one body each, shape (p,) [m]."""
        rotation = self.rotation[moments]
        mine, theirs = rotation.transpose(0, 2, 1), others.axes
        crossed = np.cross(mine[:, :, None], theirs[:, None]).reshape(-1, 9, 3)
        level = (delta * (1.0, 1.0, 0.0))[:, None]
        axes = np.concatenate([mine, theirs, crossed, level], axis=1)
        length = np.linalg.norm(axes, axis=2)
        axes = axes / np.maximum(length, _TINY)[..., None]
        apart = np.abs(axes @ delta[..., None])[..., 0]
        own = np.abs(axes @ rotation) @ self.half
        gaps = np.where(length > 1e-3, apart - own - others.reach(axes), -np.inf)
        return np.asarray(gaps.max(axis=1))


@dataclass(frozen=True)
class MovingSpheres:
    """Spheres at k moments.

    Attributes:
        center: shape (k, s, 3) [m].
        radius: shape (s,) [m].
    """

    center: Array
    radius: Array

    def above(self, height: float) -> Array:
        """Of their lowest points above a height, shape (k, s) [m]."""
        return np.asarray(self.center[..., 2] - self.radius - height)

    def gaps(self, others: Upright) -> Array:
        """To each of m bodies, shape (k, s, m) [m]."""
        delta = self.center[:, :, None] - others.center
        own = np.abs(np.einsum("mij,ksmj->ksmi", others.axes, delta)) - others.half
        around = np.hypot(delta[..., 0], delta[..., 1]) - others.half[:, 0]
        beside = np.hypot(np.maximum(own[..., 0], 0), np.maximum(own[..., 1], 0))
        beside = np.where(others.round, np.maximum(around, 0), beside)
        inside = np.where(others.round, around, np.maximum(own[..., 0], own[..., 1]))
        outside = np.hypot(beside, np.maximum(own[..., 2], 0))
        within = np.minimum(np.maximum(inside, own[..., 2]), 0)
        return np.asarray(outside + within - self.radius[:, None])
