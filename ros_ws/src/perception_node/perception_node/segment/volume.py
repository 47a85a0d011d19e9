# SPDX-License-Identifier: Apache-2.0
"""The volume over the table in which blocks are looked for."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera

Array = NDArray[np.float64]

#: Blocks are looked for as far as this beside the outer places [m].
MARGIN: Final = 0.12
#: What stands further than this beside the row of places is none of its blocks [m].
NEAR: Final = 0.095
#: What fell off a tower, or was pushed off its place, lies up to this far from the row [m], ...
FALLEN: Final = 0.21
#: ... and no higher than this over the table [m].
LYING: Final = 0.09


@dataclass(frozen=True, eq=False)
class Volume:
    """An upright box in world, its floor on the table, and the row of places in it.

    One is equal to itself only, so that what is seen of it is kept by it.

    Attributes:
        low, high: opposite corners, shape (3,) [m].
        feet: the places, in order, shape (m, 2) [m].
        near: what stands further than this beside the row is none of its blocks [m].
    """

    low: Array
    high: Array
    feet: Array
    near: float = NEAR

    @classmethod
    def over(cls, feet: Array, height: float) -> Volume:
        """What is around and over places.

        Args:
            feet: of the places, at least one, shape (m, 3) [m].
            height: of the highest tower [m].
        """
        low = np.append(feet[:, :2].min(axis=0) - MARGIN, np.median(feet[:, 2]))
        high = np.append(feet[:, :2].max(axis=0) + MARGIN, feet[:, 2].max() + height)
        return cls(low, high, feet[:, :2].astype(np.float64))

    @property
    def floor(self) -> float:
        """Height of the table [m]."""
        return float(self.low[2])

    def is_near(self, points: Array) -> NDArray[np.bool_]:
        """Whether points are near enough to the row to be of it, (n, 2) [m] -> (n,).

        Near the places, and near the lines from each one to the next.
        """
        begin, end = self.feet, np.concatenate([self.feet[1:], self.feet[-1:]])
        along = end - begin
        squares = np.maximum((along**2).sum(axis=1), 1e-12)
        share = ((points[:, None] - begin) * along).sum(axis=-1) / squares
        nearest = begin + np.clip(share, 0.0, 1.0)[..., None] * along
        distances = np.linalg.norm(points[:, None] - nearest, axis=-1)
        return np.asarray(distances.min(axis=1) < self.near)

    def before(self, camera: PinholeCamera) -> Volume:
        """What is on the table beyond it on the camera's side, where no block of the row is."""
        return _before(self, camera)

    def corners(self) -> Array:
        """All eight, shape (8, 3) [m]."""
        unit = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
        return self.low + unit * (self.high - self.low)

    def seen_by(self, camera: PinholeCamera) -> tuple[slice, slice] | None:
        """Rows and columns of the part of a picture that shows it; None if none does."""
        return _seen_by(self, camera)


@functools.lru_cache(maxsize=8)
def _before(volume: Volume, camera: PinholeCamera) -> Volume:
    toward = camera.position_world[:2] - volume.feet.mean(axis=0)
    axis = int(np.argmax(np.abs(toward)))
    low, high = volume.low.copy(), volume.high.copy()
    high[2] = volume.floor + LYING
    if toward[axis] > 0.0:
        edge = volume.feet[:, axis].max()
        low[axis], high[axis] = edge + NEAR, edge + FALLEN
    else:
        edge = volume.feet[:, axis].min()
        low[axis], high[axis] = edge - FALLEN, edge - NEAR
    return replace(volume, low=low, high=high, near=FALLEN)


@functools.lru_cache(maxsize=16)
def _seen_by(volume: Volume, camera: PinholeCamera) -> tuple[slice, slice] | None:
    pixels = camera.project(volume.corners())
    if not np.isfinite(pixels).all():  # the camera is in the volume: all of it may be seen
        pixels = np.array([[0, 0], [camera.width - 1, camera.height - 1]], dtype=np.float64)
    size = (camera.width, camera.height)
    first = np.clip(np.floor(pixels.min(axis=0)).astype(int), 0, size)
    last = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + 1, 0, size)
    if (last - first).min() < 3:
        return None
    return slice(int(first[1]), int(last[1])), slice(int(first[0]), int(last[0]))
