# SPDX-License-Identifier: Apache-2.0
"""Blocks that others cover, and those of which too little is seen to say what they are (5.4.3)."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import Place

from .blocks import Blocks, BlockSurface, measure
from .config import PerceptionConfig
from .errors import BadImageError, UnmeasuredError
from .masks import pixels_of
from .observation import Observation
from .places.occlusion import box_region
from .segment import Segment, Segments

Mask = NDArray[np.bool_]

#: What is nearer to the camera than a neighbouring pixel by more covers what is there [m].
NEARER: Final = 0.02
#: So far beside the middle of a place a block on it is seen [m].
REACH: Final = 0.05
#: Lower than this over the table is the table [m].
MIN_HEIGHT: Final = 0.003
#: Higher than this over the table something is, as noise of depth is lower [m].
THING_HEIGHT: Final = 0.01
#: A block and what covers it are this near to one another in the picture [px].
RIM: Final = 3
#: Of a block that is covered at more of its width below, the lower end is known to this only, as a
#: standard deviation [m].
CUT: Final = 0.25
LOW_DOUBT: Final = 0.02
#: A strip with fewer pixels, or with colours whose channels' shares differ by more, is no block.
MIN_PIXELS: Final = 40
SAME_COLOR: Final = 0.06
#: Blocks whose middles are nearer than this, seen from above, are of one stack [m].
APART: Final = 0.08
#: What is on one place and shares this part of the heights at which it is seen is one block.
SHARED: Final = 0.3
#: Two blocks on one place cannot have upper ends nearer to one another than this [m].
SAME_HEIGHT: Final = 0.005
#: A block is covered that has so many pixels beside something nearer.
MIN_EDGE: Final = 3


@dataclass(frozen=True)
class Glimpse:
    """A block of which too little is seen.

    Attributes:
        place: index of the place that it is on.
        low, high: ends of what is seen of it [m].
    """

    place: int
    low: float
    high: float


@dataclass(frozen=True)
class Seen:
    """The blocks of a picture that can be measured, and the others.

    Attributes:
        segments, surfaces: of those that can, in the same order.
        covered: their labels, as far as something nearer covers a part of them.
        glimpses: of the others.
    """

    segments: Segments
    surfaces: tuple[BlockSurface, ...]
    covered: frozenset[int] = frozenset()
    glimpses: tuple[Glimpse, ...] = ()

    @property
    def partly(self) -> frozenset[int]:
        """The indices of those of which something nearer covers a part."""
        return frozenset(
            index for index, item in enumerate(self.segments) if item.label in self.covered
        )

    @property
    def upright(self) -> list[int]:
        """The indices of those that stand upright."""
        return [index for index, item in enumerate(self.surfaces) if item.upright]

    def standing(self) -> Seen:
        """The same, those left out that lie or lean."""
        lying = [index for index, item in enumerate(self.surfaces) if not item.upright]
        return replace(
            self,
            segments=self.segments.without(lying),
            surfaces=tuple(item for item in self.surfaces if item.upright),
        )

    def without(
        self, labels: Collection[int], observation: Observation, places: tuple[Place, ...]
    ) -> Seen:
        """The same, some blocks of which are only glimpsed after all."""
        kept = [item.label not in labels for item in self.segments]
        gone = [item for item, keep in zip(self.segments, kept) if not keep]
        return Seen(
            _only(self.segments, kept),
            tuple(item for item, keep in zip(self.surfaces, kept) if keep),
            self.covered - frozenset(labels),
            (*self.glimpses, *(_glimpse(item.part, observation, places) for item in gone)),
        )


def measure_seen(
    observation: Observation,
    segments: Segments,
    places: tuple[Place, ...],
    by_things: bool = False,
) -> Seen:
    """Measures the blocks; those that are covered and cannot be measured are only glimpsed.

    Args:
        by_things: whether what is no block covers blocks, too.

    Raises:
        BadImageError: as :func:`.blocks.measure` of a block that is not covered.
    """
    segments, glimpses = _with_slivers(observation, segments, places)
    things = _things(observation, segments, places) if by_things else None
    covered = _covered(observation, segments, things)
    while True:
        try:
            surfaces = measure(observation, segments)
        except UnmeasuredError as error:
            poor = [segments.blocks[error.index]]
            if poor[0].label not in covered:
                raise
        else:
            # What seems to lie may be the part of a block that is seen.
            poor = [
                item
                for item, surface in zip(segments, surfaces)
                if item.label in covered and not surface.upright
            ]
        if poor:
            glimpses += [_glimpse(item.part, observation, places) for item in poor]
            segments = _only(segments, [all(item is not p for p in poor) for item in segments])
        else:
            pair = _one_in_two(segments, surfaces, covered, places)
            if pair is None:
                surfaces = tuple(
                    _without_low_end(surface)
                    if item.label in covered and _is_cut_below(item, segments, observation, things)
                    else surface
                    for item, surface in zip(segments, surfaces)
                )
                return Seen(segments, surfaces, covered, tuple(glimpses))
            segments = _joined(segments, *pair)
            covered = covered | {pair[0]}


def uncovered(
    observation: Observation, seen: Seen, blocks: Blocks
) -> tuple[NDArray[np.uint8], Segments]:
    """Picture and segments as they would be without what covers blocks, as these were measured.

    What the visual module makes of a part of a block says nothing of the block.
    """
    camera, labels = observation.camera, seen.segments.label_image
    assert camera is not None
    rgb, found = observation.rgb.copy(), []
    for index, item in enumerate(seen.segments):
        if index in seen.partly:
            outline = box_region(camera, blocks.measured[index].pose)
            part = item.part | (outline & (labels > 0) & (labels != item.label))
            rgb[part & ~item.part] = np.median(observation.rgb[item.part], axis=0)
            item = Segment(item.label, part, part)
        found.append(item)
    return rgb, replace(seen.segments, blocks=tuple(found))


def _is_cut_below(
    item: Segment, segments: Segments, observation: Observation, things: Mask | None
) -> bool:
    """Whether something nearer covers where a block ends below, for much of its width."""
    depth = _known_depth(observation)
    columns = np.flatnonzero(item.part.any(axis=0))
    lowest = item.part.shape[0] - 1 - np.argmax(item.part[::-1, columns], axis=0)
    cut = np.zeros(len(columns), bool)
    for down in range(1, RIM + 1):
        rows = np.minimum(lowest + down, item.part.shape[0] - 1)
        other = segments.label_image[rows, columns]
        nearer = depth[rows, columns] < depth[lowest, columns] - NEARER
        covers = (other > 0) & (other != item.label)
        cut |= nearer & (covers if things is None else covers | things[rows, columns])
    return bool(np.count_nonzero(cut) > CUT * len(columns))


def _without_low_end(surface: BlockSurface) -> BlockSurface:
    """The same, of which it is not known how far down it reaches."""
    covariance = surface.covariance.copy()
    covariance[5, :] = covariance[:, 5] = 0.0
    covariance[5, 5] = LOW_DOUBT**2
    return replace(surface, covariance=covariance)


def _one_in_two(
    segments: Segments,
    surfaces: Sequence[BlockSurface],
    covered: frozenset[int],
    places: tuple[Place, ...],
) -> tuple[int, int] | None:
    """The labels of two that can only be of one block: on one place, and equally high."""
    feet = np.array([place.position_world[:2] for place in places])
    on = [int(np.linalg.norm(feet - surface.position, axis=1).argmin()) for surface in surfaces]
    for i, j in combinations(range(len(surfaces)), 2):
        one, other = surfaces[i], surfaces[j]
        labels = segments.blocks[i].label, segments.blocks[j].label
        if not (one.upright and other.upright):
            continue
        shared = min(one.high, other.high) - max(one.seen_low, other.seen_low)
        lower = min(one.high - one.seen_low, other.high - other.seen_low)
        alike = shared > SHARED * lower or abs(one.high - other.high) < SAME_HEIGHT
        if alike and on[i] == on[j] and covered.intersection(labels):
            return labels
    return None


def _joined(segments: Segments, label: int, other: int) -> Segments:
    """The same, with what had two labels under the first one."""
    image = np.where(segments.label_image == other, label, segments.label_image)
    blocks = []
    for item in segments:
        if item.label == label:
            mask = image == label
            blocks.append(Segment(label, mask, mask))
        elif item.label != other:
            blocks.append(item)
    return replace(segments, label_image=image, blocks=tuple(blocks))


def poorly_seen(
    seen: Seen,
    blocks: Blocks,
    stacks: Sequence[Sequence[int]],
    iou: NDArray[np.float64],
    config: PerceptionConfig,
) -> tuple[int, ...]:
    """Labels of the blocks that others cover and of which too little is seen to tell of them.

    Args:
        stacks: indices of the blocks of each, from the bottom.
        iou: how well the visual module reproduces each (A.2.5), shape (N,).
    """
    if not seen.covered:
        return ()
    poor = [
        bool(block.rival)
        or max(block.deviation[:3]) > config.limits.doubt
        or block.tilt > config.limits.tilt
        or share < config.min_confidence
        for block, share in zip(blocks.measured, iou)
    ]
    # Two that would have to be in one another are not what they look like.
    for stack in stacks:
        for lower, upper in pairwise(stack):
            gap = blocks.measured[upper].pose.bottom - blocks.measured[lower].pose.top
            if gap < -config.limits.gap:
                poor[lower] = poor[upper] = True
    return tuple(seen.segments.blocks[index].label for index in seen.partly if poor[index])


def _only(segments: Segments, kept: list[bool]) -> Segments:
    blocks = tuple(item for item, keep in zip(segments, kept) if keep)
    return replace(segments, blocks=blocks)


def _things(observation: Observation, segments: Segments, places: tuple[Place, ...]) -> Mask:
    """Which pixels show something that is neither a block nor the table."""
    depth, camera = _known_depth(observation), observation.camera
    assert camera is not None
    across, down = camera.rays_apart(np.s_[0 : depth.shape[0], 0 : depth.shape[1]])
    with np.errstate(invalid="ignore"):
        height = camera.position_world[2] + (down[:, None, 2] + across[None, :, 2]) * depth
    floor = min(place.position_world[2] for place in places)
    low = height < floor + THING_HEIGHT
    return np.asarray((segments.label_image == 0) & np.isfinite(depth) & ~low)


def _covered(
    observation: Observation, segments: Segments, things: Mask | None = None
) -> frozenset[int]:
    """Labels of the blocks beside whose pixels something is seen that is nearer.

    A block of another stack, or one of the things.
    """
    depth = _known_depth(observation)
    found = []
    middles = {item.label: _middle(item.part, observation) for item in segments}
    for item in segments:
        left, top, width, height = cv2.boundingRect(item.part.astype(np.uint8))
        box = np.s_[max(0, top - RIM) : top + height + RIM, max(0, left - RIM) : left + width + RIM]
        part = item.part[box]
        here = np.where(part, depth[box], 0.0).astype(np.float32)
        around = cv2.dilate(here, np.ones((2 * RIM + 1,) * 2, np.uint8))
        labels = segments.label_image[box]
        away = [
            label
            for label, middle in middles.items()
            if np.hypot(*(middle - middles[item.label])) > APART
        ]
        covers = np.isin(labels, away)
        if things is not None:
            covers |= things[box]
        beside = (around > 0.0) & ~part & covers
        if np.count_nonzero(beside & (depth[box] < around - NEARER)) >= MIN_EDGE:
            found.append(item.label)
    return frozenset(found)


def _middle(part: Mask, observation: Observation) -> NDArray[np.float64]:
    """Where the pixels of a block are on the table, (x, y) [m]; infinite where none has depth."""
    points = _points(part, observation)
    return np.median(points[:, :2], axis=0) if len(points) else np.full(2, np.inf)


def _points(part: Mask, observation: Observation) -> NDArray[np.float64]:
    """Where pixels are in world, those without depth left out, shape (n, 3) [m]."""
    camera, depth = observation.camera, _known_depth(observation)
    assert camera is not None
    rows, columns = pixels_of(part & np.isfinite(depth))
    rays = camera.rays_world(np.stack([columns, rows], axis=-1))
    return np.asarray(camera.position_world + rays * depth[rows, columns, None])


def _with_slivers(
    observation: Observation, segments: Segments, places: tuple[Place, ...]
) -> tuple[Segments, list[Glimpse]]:
    """The segments with the strips of blocks that are too thin to be found; some are glimpsed."""
    depth, camera = _known_depth(observation), observation.camera
    assert camera is not None
    labelled = segments.label_image > 0
    near = np.where(labelled, depth, np.inf).astype(np.float32)
    nearest = cv2.erode(near, np.ones((2 * RIM + 1,) * 2, np.uint8))
    rows, columns = pixels_of(~labelled & np.isfinite(depth))
    rays = camera.rays_world(np.stack([columns, rows], axis=-1))
    points = camera.position_world + rays * depth[rows, columns, None]
    feet = np.array([place.position_world for place in places])
    over = points[:, 2] > feet[:, 2].min() + MIN_HEIGHT  # few are
    off = np.abs(points[over, None, :2] - feet[None, :, :2])
    over[over] = np.maximum(off[..., 0], off[..., 1]).min(axis=1) < REACH
    strips = np.zeros(depth.shape, np.uint8)
    strips[rows[over], columns[over]] = 1
    count, numbers = cv2.connectedComponents(strips, connectivity=8)
    if count == 1:
        return segments, []
    covered = strips.astype(bool) & (nearest < depth - NEARER)
    labels, glimpses, blocks = segments.label_image.astype(np.int32), [], list(segments)
    for free, number in enumerate(np.unique(numbers[covered]), start=int(labels.max()) + 1):
        part = numbers == number
        labels[part] = free
        if _looks_like_one(part, observation):
            blocks.append(Segment(free, part, part))
        else:
            glimpses.append(_glimpse(part, observation, places))
    return replace(segments, label_image=labels, blocks=tuple(blocks)), glimpses


def _looks_like_one(part: Mask, observation: Observation) -> bool:
    """Whether a strip is large enough to be measured, and of one colour."""
    pixels = observation.rgb[part].astype(np.float64) + 1.0
    if len(pixels) < MIN_PIXELS:
        return False
    shares = np.percentile(pixels / pixels.sum(axis=1, keepdims=True), [10.0, 90.0], axis=0)
    return float((shares[1] - shares[0]).max()) < SAME_COLOR


def _glimpse(part: Mask, observation: Observation, places: tuple[Place, ...]) -> Glimpse:
    """Where pixels are: on the place that they are nearest to."""
    points = _points(part, observation)
    if len(points) == 0:
        raise BadImageError("none of the pixels of a block has depth; check the depth camera")
    feet = np.array([place.position_world for place in places])
    away = np.linalg.norm(feet[:, :2] - np.median(points[:, :2], axis=0), axis=1)
    low, high = np.percentile(points[:, 2], [2.0, 98.0])
    return Glimpse(int(away.argmin()), float(low), float(high))


def _known_depth(observation: Observation) -> NDArray[np.float64]:
    """Depth, infinite where it is not known [m]."""
    depth = observation.depth
    assert depth is not None
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(depth) & (depth > 0.0), depth, np.inf).astype(np.float64)
