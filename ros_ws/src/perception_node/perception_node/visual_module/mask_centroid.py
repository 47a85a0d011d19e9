# SPDX-License-Identifier: Apache-2.0
"""The baseline: with masks given, the centroid of the mask solves the coordinate problem."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from perception_node.segment import Segments, largest_part

from .coordinates import Coordinates, intersection_over_union
from .grid_sampler import sample
from .object_images import ObjectImages, object_images


class MaskCentroid:
    """Finds coordinates without learning; stands where the visual module stands.

    Args:
        largest_part_only: leave out parts of the mask that are detached from its largest part.
    """

    def __init__(self, largest_part_only: bool = False) -> None:
        self.largest_part_only = largest_part_only

    def images(self, rgb: NDArray[np.uint8], segments: Segments) -> ObjectImages:
        """One image of the whole scene per object."""
        return object_images(rgb, segments)

    def locate(self, objects: ObjectImages) -> Coordinates:
        """Coordinates of all objects of a scene: the centroids of their masks."""
        size = objects.coverage.shape[-1]
        coverage = objects.coverage
        if self.largest_part_only:
            coverage = coverage * np.array([largest_part(mask > 0) for mask in coverage])
        centroids = _centroids(coverage)
        moved = centroids - _centroids(objects.default_coverage)
        # With a factor of 2, φ is the translation as a part of the image's side.
        reconstructed = sample(
            torch.from_numpy(objects.default_coverage[:, None]),
            torch.from_numpy((moved / size).astype(np.float32)),
            2.0,
        )
        in_scene = objects.in_scene(centroids / size)
        return Coordinates(
            phi=in_scene,
            corners=in_scene,
            centres=in_scene,
            iou=intersection_over_union(objects.coverage, reconstructed[:, 0].numpy()),
        )


def _centroids(coverage: NDArray[np.float32]) -> NDArray[np.float64]:
    """From the bottom-left corner [px], shape (N, 2)."""
    size = coverage.shape[-1]
    steps = np.arange(size) + 0.5
    mass = np.maximum(coverage.sum((1, 2), dtype=np.float64), 1e-9)
    across = (coverage.sum(1, dtype=np.float64) @ steps) / mass
    up = (coverage.sum(2, dtype=np.float64) @ steps[::-1]) / mass
    return np.stack([across, up], axis=1)
