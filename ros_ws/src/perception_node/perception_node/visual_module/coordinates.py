# SPDX-License-Identifier: Apache-2.0
"""Coordinates of objects in the image, and the interface of what finds them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from perception_node.segment import Segments

from .object_images import ObjectImages


@dataclass(frozen=True)
class Coordinates:
    """What G says about the N objects of a scene.

    Attributes:
        phi: φ = (a, b), shape (N, 2), in 0..1 from the bottom-left corner.
        corners: bottom-left corners of the objects, as parts of the image's side, shape (N, 2).
        centres: centres of the objects' boxes, in the same unit, shape (N, 2).
        iou: IoU(u_i, ũ_i) of A.2.5, shape (N,), in 0..1.
    """

    phi: NDArray[np.float64]
    corners: NDArray[np.float64]
    centres: NDArray[np.float64]
    iou: NDArray[np.float64]

    def of(self, objects: Sequence[int]) -> Coordinates:
        """Those of some of the objects, by their indices."""
        some = list(objects)
        return Coordinates(self.phi[some], self.corners[some], self.centres[some], self.iou[some])


class Locator(Protocol):
    """Whatever finds the coordinates of objects: the visual module, or the baseline."""

    def images(self, rgb: NDArray[np.uint8], segments: Segments) -> ObjectImages:
        """What :meth:`locate` looks at, of a picture of shape (height, width, 3)."""
        ...

    def locate(self, objects: ObjectImages) -> Coordinates:
        """Coordinates of all objects of a scene, in their order."""
        ...


def intersection_over_union(
    first: NDArray[np.floating], second: NDArray[np.floating]
) -> NDArray[np.float64]:
    """IoU of soft masks in 0..1: Σ min / Σ max over the pixels; 0 where both are empty.

    For masks of zeros and ones this is the usual definition.

    Args:
        first, second: shape (n, height, width).

    Returns:
        Shape (n,), in 0..1.
    """
    axes = (-2, -1)
    union = np.maximum(first, second).sum(axes, dtype=np.float64)
    return np.minimum(first, second).sum(axes, dtype=np.float64) / np.maximum(union, 1e-9)
