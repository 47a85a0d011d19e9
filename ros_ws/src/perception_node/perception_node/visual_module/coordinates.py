# SPDX-License-Identifier: Apache-2.0
"""Coordinates of objects in the image, and the interface of what finds them."""

from __future__ import annotations

import math
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


def translated_overlap(
    coverage: NDArray[np.floating],
    default: NDArray[np.floating],
    crop_sizes: NDArray[np.intp],
    moves: NDArray[np.float64],
) -> NDArray[np.float64]:
    """IoU of soft masks with crops that are moved to where they should be, see :func:`sample`.

    Only where the crops come to lie is looked at.

    Args:
        coverage: shape (n, size, size).
        default: the crops, at the bottom-left corner, zero elsewhere, likewise.
        crop_sizes: their width and height, shape (n, 2) [px].
        moves: right and up, shape (n, 2) [px].

    Returns:
        Shape (n,), in 0..1.
    """
    found = np.zeros(len(coverage))
    for index, (seen, crop) in enumerate(zip(coverage, default)):
        (width, height), (right, up) = crop_sizes[index], moves[index]
        size = len(seen)
        part = np.zeros((height + 2, width + 2))
        part[1:-1, 1:-1] = crop[size - height :, :width]
        whole_right, whole_up = math.floor(right), math.floor(up)
        right, up = right - whole_right, up - whole_up
        # Bilinear: each pixel is shared by four, of which the last rows and columns are zero.
        part = (1.0 - right) * part[:, 1:] + right * part[:, :-1]
        part = (1.0 - up) * part[:-1] + up * part[1:]
        top, left = size - height - whole_up - 1, whole_right
        rows = slice(max(top, 0), max(top + len(part), 0))
        columns = slice(max(left, 0), max(left + part.shape[1], 0))
        mine = seen[rows, columns]
        part = part[max(-top, 0) :, max(-left, 0) :][: mine.shape[0], : mine.shape[1]]
        both = float(np.minimum(mine, part).sum())
        union = float(seen.sum(dtype=np.float64)) + float(part.sum()) - both
        found[index] = both / max(union, 1e-9)
    return found
