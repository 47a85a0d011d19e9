# SPDX-License-Identifier: Apache-2.0
"""Whether something that is not a block on a place hides part of the places."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.config import PerceptionConfig
from perception_node.masks import pixels_of
from perception_node.observation import Observation
from perception_node.segment import Segments
from scene_graph import BlockPose

from .standing import Places

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
#: Rows and columns of a part of a picture, and which of its pixels are meant.
Part = tuple[tuple[slice, slice], Mask]

#: Things lower than this above the table hide nothing: shadows, the table itself [m].
MIN_HEIGHT: Final = 0.01
#: So small a share of a column's pixels hides nothing.
STRAY: Final = 0.002
#: What is this near to a measured block is of it: pixels that a segmenter missed [m].
RIM: Final = 0.008


@dataclass(frozen=True)
class Columns:
    """The upright columns of space over the places, in which blocks can stand.

    Attributes:
        places: where they stand; at least one.
        half_width: half the side of a column [m].
        height: of a column: the highest tower [m].
    """

    places: Places
    half_width: float
    height: float

    def seen_to(self, hidden: Mask, regions: Sequence[Part], camera: PinholeCamera) -> list[float]:
        """For each column the height over its place up to which nothing hides it [m].

        A hidden pixel hides the column at the height at which its ray leaves it at the back, and
        above. Some stray pixels hide nothing.

        Args:
            hidden: the pixels where something hides the places, shape (height, width).
            regions: those of :meth:`regions`.
        """
        heights = []
        for foot, (box, region) in zip(self._feet(), regions):
            rows, across = pixels_of(hidden[box] & region)
            stray = int(STRAY * np.count_nonzero(region))
            if len(rows) <= stray:
                heights.append(self.height)
                continue
            rows, across = rows + box[0].start, across + box[1].start
            away = foot[:2] - camera.position_world[:2]
            distance = float(np.hypot(*away))
            rays = camera.rays_world(np.stack([across, rows], axis=-1))
            ahead = np.maximum(rays[:, :2] @ (away / max(distance, 1e-9)), 1e-9)
            back = (distance + self.half_width) / ahead
            z = camera.position_world[2] + back * rays[:, 2] - foot[2]
            heights.append(float(np.clip(np.partition(z, stray)[stray], 0.0, self.height)))
        return heights

    def regions(self, camera: PinholeCamera) -> list[Part]:
        """For each column the pixels behind which it may be."""
        size = (2.0 * self.half_width, 2.0 * self.half_width, self.height)
        return [
            box_part(camera, BlockPose((x, y, z + 0.5 * self.height), 0.0, size))
            for x, y, z in (place.position_world for place in self.places.places)
        ]

    def greatest_depth(self, camera: PinholeCamera) -> float:
        """Depth along the optical axis that no point of the columns exceeds [m]."""
        forward = camera.world_from_optical[:3, 2]
        feet = (self._feet() - camera.position_world) @ forward
        aside = self.half_width * (abs(forward[0]) + abs(forward[1]))
        return float(feet.max() + aside + max(self.height * forward[2], 0.0))

    def hidden_by(self, points_world: Array, camera: PinholeCamera) -> Mask:
        """Whether points, shape (..., 3) [m], are among the columns or between them and the camera.

        NaN hides nothing.
        """
        with np.errstate(invalid="ignore"):
            above = points_world[..., 2] > self._feet()[:, 2].min() + MIN_HEIGHT
        return self.places.in_front(points_world, camera, self.half_width) & above

    def _feet(self) -> Array:
        return np.array([place.position_world for place in self.places.places], dtype=np.float64)


@dataclass(frozen=True)
class Occlusion:
    """What is hidden by things that are not blocks.

    Attributes:
        hidden: pixels where such a thing is in front of or among the places, shape (height, width);
            None where that cannot be known.
        shares: the hidden share of the column over each place, 0..1; empty where it is not known.
        seen_to: up to which height over each place nothing hides the column [m]; likewise.
    """

    hidden: Mask | None = None
    shares: tuple[float, ...] = ()
    seen_to: tuple[float, ...] = ()

    @property
    def greatest(self) -> float:
        """The largest of the shares, 0 where none is known."""
        return max(self.shares, default=0.0)

    def visible_shares(
        self, poses: Sequence[BlockPose | None], camera: PinholeCamera | None
    ) -> Array:
        """How much of each block's outline is not hidden, shape (N,), 0..1; 1 without a pose."""
        if self.hidden is None or camera is None or not self.hidden.any():
            return np.ones(len(poses))
        parts = [None if pose is None else box_part(camera, pose) for pose in poses]
        return np.array(
            [1.0 if part is None else 1.0 - _share(self.hidden[part[0]], part[1]) for part in parts]
        )


def find_occlusion(
    observation: Observation,
    segments: Segments,
    places: Places,
    config: PerceptionConfig,
    blocks: Sequence[BlockPose | None] = (),
) -> Occlusion:
    """What hides the columns over the places, by depth, or by what the segmenter says of colour.

    Nothing is known without camera or places.

    Args:
        blocks: those that were measured: what lies on their surface is they, whoever missed it.
    """
    depth, camera = observation.depth, observation.camera
    if camera is None or not places.places or (depth is None and segments.hides is None):
        return Occlusion()
    columns = Columns(places, config.column_half_width, config.column_height)
    regions = columns.regions(camera)
    if depth is None:
        assert segments.hides is not None
        return _occlusion(segments.hides, columns, regions, camera)
    # What is deeper than every column is behind them: most of the image, without any geometry.
    behind = np.zeros(depth.shape, bool)
    for box, region in regions:
        behind[box] |= region
    part = _around([box for box, _ in regions])
    with np.errstate(invalid="ignore"):
        near = (depth[part] > 0) & (depth[part] < columns.greatest_depth(camera))
    rows, across = pixels_of(behind[part] & (segments.label_image[part] == 0) & near)
    rays = _rays(camera, *((side.start, side.stop) for side in part))[rows, across]
    rows, across = rows + part[0].start, across + part[1].start
    points = camera.position_world + rays * depth[rows, across, None]
    hidden = np.zeros(depth.shape, bool)
    hides = columns.hidden_by(points, camera)
    rows, across, points = rows[hides], across[hides], points[hides]
    hides = np.ones(len(points), bool)
    for block in blocks:
        if block is not None:
            hides &= ~_is_of(block, points)
    hidden[rows[hides], across[hides]] = True
    return _occlusion(hidden, columns, regions, camera)


@functools.lru_cache(maxsize=4)
def _rays(camera: PinholeCamera, rows: tuple[int, int], columns: tuple[int, int]) -> Array:
    """Of the pixels of some rows and columns, from the first to that after the last, (h, w, 3)."""
    across, down = np.meshgrid(np.arange(*columns), np.arange(*rows))
    return camera.rays_world(np.stack([across, down], axis=-1))


def _occlusion(
    hidden: Mask, columns: Columns, regions: Sequence[Part], camera: PinholeCamera
) -> Occlusion:
    shares = tuple(_share(hidden[box], region) for box, region in regions)
    return Occlusion(hidden, shares, tuple(columns.seen_to(hidden, regions, camera)))


def _around(boxes: Sequence[tuple[slice, slice]]) -> tuple[slice, slice]:
    """Rows and columns that hold all of some others, at least one."""
    rows, columns = (
        slice(min(side.start for side in sides), max(side.stop for side in sides))
        for sides in zip(*boxes)
    )
    return rows, columns


def _is_of(block: BlockPose, points_world: Array) -> Mask:
    """Whether points, shape (n, 3) [m], are as near to a block as its rim can be, shape (n,)."""
    c, s = np.cos(block.yaw), np.sin(block.yaw)
    half = 0.5 * np.array(block.size) + RIM
    x, y, z = (points_world[:, axis] - at for axis, at in enumerate(block.position_world))
    beside = (np.abs(c * x + s * y) < half[0]) & (np.abs(c * y - s * x) < half[1])
    return np.asarray(beside & (np.abs(z) < half[2]))


def box_region(camera: PinholeCamera, box: BlockPose) -> Mask:
    """Pixels behind which an upright box may be; none if part of it is behind the camera.

    Returns:
        Shape (height, width).
    """
    whole = np.zeros((camera.height, camera.width), bool)
    part, region = box_part(camera, box)
    whole[part] = region
    return whole


@functools.lru_cache(maxsize=128)
def box_part(camera: PinholeCamera, box: BlockPose) -> Part:
    """The rows and columns of the picture in which those pixels are, and which of them they are.

    Kept, as places stay where they are.
    """
    corners = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    corners = corners * box.size
    c, s = np.cos(box.yaw), np.sin(box.yaw)
    corners = corners @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + box.position_world
    pixels = camera.project(corners)
    if not np.isfinite(pixels).all():
        return np.s_[0:0, 0:0], np.zeros((0, 0), bool)
    hull = cv2.convexHull(np.round(np.clip(pixels, -1e6, 1e6)).astype(np.int32))[:, 0]
    ends = [camera.width, camera.height]
    left, top = np.clip(hull.min(axis=0), 0, ends).tolist()
    right, bottom = np.clip(hull.max(axis=0) + 1, 0, ends).tolist()
    region = np.zeros((bottom - top, right - left), np.uint8)
    if region.size:
        cv2.fillConvexPoly(region, hull - (left, top), 1)
    region.setflags(write=False)
    return np.s_[top:bottom, left:right], region.view(bool)


def _share(hidden: Mask, region: Mask) -> float:
    return int(np.count_nonzero(hidden & region)) / max(1, int(np.count_nonzero(region)))
