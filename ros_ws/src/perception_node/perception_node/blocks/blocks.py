# SPDX-License-Identifier: Apache-2.0
"""All blocks of a scene: measured by depth, or with the shape of their outline only."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception_node.noise import depth_noise
from perception_node.observation import Observation
from perception_node.places import Standing
from perception_node.segment import Segments
from scene_graph import BlockPose, Place

from .measure import BlockSurface, measure_blocks
from .outline import shape_from_outline
from .pose import MeasuredBlock, pose_blocks
from .silhouette import measure_silhouettes


@dataclass(frozen=True)
class Blocks:
    """What is known of the N blocks of a scene, in the order of their segments.

    Attributes:
        shapes: ``box``, ``cylinder`` or ``sphere`` for each.
        measured: all of them, or none where camera, or depth of masks that were given, are missing.
        by_outline: whether they were measured by their outlines, not by depth.
        behind: indices of those that may be behind the block below them rather than on it.
    """

    shapes: tuple[str, ...]
    measured: tuple[MeasuredBlock, ...] = ()
    by_outline: bool = False
    behind: tuple[int, ...] = ()

    @property
    def poses(self) -> tuple[BlockPose | None, ...]:
        """For each block its pose in world, None where it was not measured."""
        if self.measured:
            return tuple(block.pose for block in self.measured)
        return (None,) * len(self.shapes)


def measure(
    observation: Observation, segments: Segments, places: Sequence[Place] = ()
) -> tuple[BlockSurface, ...]:
    """Each block by its depth, or all by their outlines where these were found in colour alone.

    Args:
        places: on which they stand.

    Returns:
        In the order of the segments; nothing without camera, or of masks that came without depth.

    Raises:
        BadImageError: if too little depth of a block is known, or one stands on no place.
    """
    depth, camera = observation.depth, observation.camera
    if camera is None:
        return ()
    if depth is None:
        if segments.hides is None or not places:
            return ()
        feet = np.array([place.position_world for place in places])
        return measure_silhouettes(observation.rgb, segments, camera, feet)
    return measure_blocks(
        segments, depth, camera, depth_noise(depth), observation.sure, observation.edge_doubt
    )


def centres(surfaces: tuple[BlockSurface, ...]) -> NDArray[np.float64] | None:
    """Centres of measured blocks, shape (N, 3) [m]; None of none."""
    if not surfaces:
        return None
    return np.array([(*item.position, 0.5 * (item.low + item.high)) for item in surfaces])


def find_blocks(
    observation: Observation,
    segments: Segments,
    standing: Standing,
    surfaces: tuple[BlockSurface, ...],
    covered: Collection[int] = (),
    smallest: float = 0.0,
) -> Blocks:
    """The blocks in their stacks; where they were not measured, only their shapes are told.

    Args:
        covered, smallest: see :func:`pose_blocks`.
    """
    if not surfaces:
        shapes = tuple(shape_from_outline(observation.rgb, segment.part) for segment in segments)
        return Blocks(shapes)
    measured = pose_blocks(surfaces, standing.stacks, standing.table_heights, covered, smallest)
    shapes = tuple(block.shape for block in measured)
    behind = tuple(index for index, item in enumerate(surfaces) if item.behind)
    return Blocks(shapes, measured, by_outline=observation.depth is None, behind=behind)
