# SPDX-License-Identifier: Apache-2.0
"""Finds blocks in colour and depth, without a detector: what stands on the table near the places.

Pixels above the table are split where colour, brightness or depth jump, and the pieces put together
again that can be faces of one block: of one hue, and meeting in an edge that bulges. What is too
large for a block, or hangs on something that is, is none: the arm, a hand, a wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.alignment import smear_of
from perception_node.components import components
from perception_node.errors import BadImageError
from perception_node.masks import pixels_of
from perception_node.observation import Observation

from .facets import (
    Facets,
    Look,
    alike,
    find_facets,
    links_in,
    on_one_facet,
    sums,
)
from .leaks import LEAK, without_leaks
from .pieces import ends_by_number, planes
from .region import Region, look_at
from .segments import Segments
from .strips import SAME_HEIGHT, take_strips
from .unseen import check_all_seen
from .volume import Volume

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Box = tuple[slice, slice]

#: What is lower than this over the table is the table [m].
MIN_HEIGHT: Final = 0.003
#: Where the table is measured lower than it should be, blocks end there, but not deeper [m].
MAX_SUNK: Final = 0.03
#: What is before a block's wall by more than this is the table [m].
BEFORE: Final = 0.02
#: A block is nowhere wider and no higher than this [m], and not as small as
MAX_WIDTH: Final = 0.11
MAX_HEIGHT: Final = 0.09
MIN_SIDE: Final = 0.014
#: Strips up to so many times as wide as a smeared edge are no faces.
STRIP: Final = 2
#: Facets of fewer pixels are noise, or the rim of another one.
MIN_PIXELS: Final = 10
#: Facets of which fewer pixels have a sure depth have no normal to rely on,
SLIVER: Final = 40
#: and those of which fewer have one than this have to do with the others.
FEW: Final = 6
#: Facets of one block have hues nearer than this, see :class:`Look`.
SAME_HUE: Final = 0.045
#: and of a sliver, which often is a mixture, nearer than this.
SLIVER_HUE: Final = 0.065
#: Facets that lie in one plane and differ in brightness by more are of two blocks.
SAME_LIGHT: Final = 0.12
#: No two faces of one block differ in brightness by more (natural logarithm).
MAX_CONTRAST: Final = 1.1
#: Two walls of one block have this part of the lower one's height in common.
SHARED_HEIGHT: Final = 0.4
#: The points of a level facet are spread less than this about their height, as a standard deviation
#: that follows from those between these percentages of them [m].
LEVEL: Final = 0.0025
QUARTILES: Final = (25.0, 75.0)
#: Normals of upright facets with a greater cosine between them are of one plane.
ONE_PLANE: Final = 0.92
#: A facet whose points are spread further than this about their plane [m] has none: lid and front
#: are one where light falls on both alike.
BENT: Final = 0.004
#: Middles of two faces of one block are nearer than this, seen from above [m].
ONE_BODY: Final = 0.08
#: What hangs higher than this over what it should stand on does not stand [m].
FLOATS: Final = 0.012
#: Of a block often only the front is seen: it may reach so far beyond what is seen of it [m].
UNSEEN: Final = 0.015


def find_in_rgbd(
    observation: Observation, volume: Volume | None, labelled: Mask | None = None
) -> Segments:
    """The blocks in a volume over the table.

    Args:
        labelled: pixels that are known to be of blocks, and may be without depth; None: there are
            none, shape (height, width).

    Raises:
        BadImageError: if the observation has no depth or no camera, or the volume is not known, or
            something may be a block but has no depth.
    """
    if observation.depth is None or observation.camera is None:
        raise BadImageError(
            "masks cannot be found without depth and camera; publish both, or set mask_source to "
            "segmentation_topic"
        )
    if volume is None:
        raise BadImageError(
            "masks cannot be found where the places are unknown; set stack_positions, or "
            "mask_source to segmentation_topic"
        )
    labels = np.zeros(observation.rgb.shape[:2], np.uint16)
    region = look_at(observation, volume)
    if region is not None:
        look = Look.of(region.rgb, observation.noise)
        known = None if labelled is None else labelled[region.box]
        links = on_one_facet(look, region.depth)
        check_all_seen(region, look, links, labels.size, known)
        smear = smear_of(observation.rgb.shape[1])
        labels[region.box] = _labels(region, look, links, volume, smear)
    return Segments.from_labels(labels, source="camera/depth/image_raw")


@dataclass(frozen=True)
class _Table:
    """What is known of F facets, in the order of their numbers, from 1; row 0 is of no facet.

    Attributes:
        pixels: how many.
        sure: of how many the depth is sure.
        thick: whether it is more than a strip, as there are where a camera mixes two colours.
        broad: whether it is more than a side or lid that is seen at a flat angle.
        chroma, light: means, shapes (F, 3), (F,).
        centre, low, high: mean and about the ends of the points, shape (F, 3) [m].
        normal: of the plane through them, shape (F, 3).
        bent: whether they lie in no plane.
        level: whether it is a horizontal face.
    """

    pixels: NDArray[np.intp]
    sure: NDArray[np.intp]
    thick: Mask
    broad: Mask
    chroma: Array
    light: Array
    centre: Array
    low: Array
    high: Array
    normal: Array
    bent: Mask
    level: Mask


def _labels(
    region: Region, look: Look, links: Sequence[Mask], volume: Volume, smear: int
) -> NDArray[np.uint16]:
    """Labels of the blocks, 0 for all else, shape (h, w) of the region."""
    labels = np.zeros(region.depth.shape, np.uint16)
    with np.errstate(invalid="ignore"):
        candidates = region.inside & (region.points[..., 2] > volume.floor + MIN_HEIGHT)
    left, top, width, height = cv2.boundingRect(candidates.view(np.uint8))
    if width == 0:
        return labels
    # What stands on the table is a small part of what is seen of the volume.
    lower, right = np.minimum((top + height + 1, left + width + 1), labels.shape).tolist()
    box = np.s_[max(0, top - 1) : lower, max(0, left - 1) : right]
    part, reach = region.part(box), STRIP * smear
    pieces = find_facets(candidates[box], links_in(links, box))
    facets = without_leaks(pieces, part.points[..., 2], reach)
    table = _measure(facets, look.part(box), part, smear, reach)
    groups = _group(facets, table)
    block = _which_are_blocks(facets, table, groups, part.points, volume)
    numbers = np.zeros(len(block), np.uint16)
    numbers[block] = np.arange(1, np.count_nonzero(block) + 1)
    labels[box] = numbers[groups][facets.ids]
    box = _grow_down(labels, box, region, look, volume.floor)
    take_strips(labels[box], pieces.ids, region.part(box), 2 * reach + 1)
    return labels


def _grow_down(
    labels: NDArray[np.uint16], box: Box, region: Region, look: Look, floor: float
) -> Box:
    """Gives the pixels at a block's foot, too low to tell from the table by depth, its label.

    They are below it, not before it on the table.

    Args:
        labels: shape (h, w) of the region.
        box: the part of it in which there are labels.
        floor: height of the table [m].

    Returns:
        The part in which there are labels now: more rows of the same columns.
    """
    bottom, points, last = box[0].stop, region.points, len(labels) - 1

    def goes_on(rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Mask:
        below = np.minimum(rows + 1, last)
        height = points[below, columns, 2]
        with np.errstate(invalid="ignore"):
            foot = (height <= floor + MIN_HEIGHT) & (height > floor - MAX_SUNK)
        free = (rows < last) & (labels[below, columns] == 0)
        return np.asarray(free & foot & region.inside[below, columns])

    own = labels[box] > 0
    own[:-1] &= ~own[1:]
    rows, columns = pixels_of(own)
    rows, columns = rows + box[0].start, columns + box[1].start
    above = points[rows, columns, :2]
    while True:
        on = goes_on(rows, columns)
        rows, columns, above = rows[on], columns[on], above[on]
        if not len(rows):
            break
        with np.errstate(invalid="ignore"):
            away = np.abs(points[rows + 1, columns, :2] - above).max(axis=1, initial=0.0)
        grows = alike(look, (rows, columns), (1, 0)) & (away < BEFORE)
        rows, columns, above = rows[grows] + 1, columns[grows], above[grows]
        labels[rows, columns] = labels[rows - 1, columns]
        bottom = max(bottom, int(rows.max(initial=0)) + 1)
    return slice(box[0].start, bottom), box[1]


def _measure(facets: Facets, look: Look, region: Region, smear: int, strip: int) -> _Table:
    found = sums(facets, look, region.points, region.sure, FEW)
    centre, spread = found.centres, found.spreads[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
    variances, axes = np.linalg.eigh(spread)
    normal = axes[:, :, 0]
    # Of points that fill a face evenly these are its ends; a stray one does not move them far.
    reach = np.sqrt(3.0 * np.einsum("fii->fi", spread))
    # By the middle half of the points: a lid may run down a side that looks like it.
    ids, heights = facets.ids.ravel(), region.points[..., 2].reshape(-1, 1)
    low, high = ends_by_number(ids, heights, facets.count + 1, QUARTILES)
    with np.errstate(invalid="ignore"):
        level = ((high - low)[:, 0] < 1.35 * LEVEL) & (np.abs(normal[:, 2]) > 0.6)
    wide = np.sqrt(spread[:, 0, 0] + spread[:, 1, 1]) > LEVEL
    return _Table(
        found.pixels,
        found.sure,
        facets.thick(smear),
        facets.thick(2 * strip),
        found.colors[:, :3],
        found.colors[:, 3],
        centre,
        centre - reach,
        centre + reach,
        normal,
        variances[:, 0] > BENT**2,
        level & wide,
    )


def _group(facets: Facets, table: _Table) -> NDArray[np.intp]:
    """The number of the group of each facet, from 1; facet 0 has group 0."""
    first, second, length = facets.borders.T
    large = table.thick & (table.pixels >= SLIVER)
    same = large[first] & large[second] & (length >= 2) & _can_be_one_block(table, first, second)
    pairs = zip(first[same].tolist(), second[same].tolist())
    _, groups = components(facets.count + 1, pairs)
    # Small ones belong to the large neighbour that they look like most, those that have none to
    # that of a small neighbour.
    difference = np.linalg.norm(table.chroma[first] - table.chroma[second], axis=1)
    alike_first = np.argsort(difference)
    alike_first = alike_first[difference[alike_first] < SLIVER_HUE]
    # What is taken in counts as high as what it belongs to, so that a row of small ones along the
    # edge of a tower does not lead from one block to the next.
    low, high = table.low[:, 2].copy(), table.high[:, 2].copy()
    taken = True
    while taken:
        taken = False
        for border in alike_first[large[first[alike_first]] != large[second[alike_first]]]:
            a, b = first[border], second[border]
            if large[a] == large[b]:
                continue
            small, other = (b, a) if large[a] else (a, b)
            if low[small] <= low[other] - LEAK or high[small] >= high[other] + LEAK:
                continue
            groups[small], low[small], high[small] = groups[other], low[other], high[other]
            large[small] = taken = True
    return groups


def _can_be_one_block(table: _Table, a: NDArray[np.int64], b: NDArray[np.int64]) -> Mask:
    """Whether two facets that touch can be faces of one block, for each of n pairs."""
    same_hue = np.linalg.norm(table.chroma[a] - table.chroma[b], axis=1) < SAME_HUE
    same_light = np.abs(table.light[a] - table.light[b]) < SAME_LIGHT
    level_a, level_b = table.level[a], table.level[b]
    same_height = np.abs(table.centre[a, 2] - table.centre[b, 2]) < SAME_HEIGHT
    both_level = level_a & level_b & same_height & same_light
    # The lid of the upright one, not the ledge that it stands on.
    lid, wall = np.where(level_a, a, b), np.where(level_a, b, a)
    on_top = (level_a ^ level_b) & (table.centre[lid, 2] > table.high[wall, 2] - SAME_HEIGHT)
    upright = ~level_a & ~level_b
    # Two walls of one block meet along an upright edge, or lie in one plane.
    shared = np.minimum(table.high[a, 2], table.high[b, 2]) - np.maximum(
        table.low[a, 2], table.low[b, 2]
    )
    lower = np.minimum(table.high[a, 2] - table.low[a, 2], table.high[b, 2] - table.low[b, 2])
    beside = shared > SHARED_HEIGHT * lower
    # A sliver at an edge, where depth is often lost, has no plane that can be told.
    sliver = beside & (np.minimum(table.sure[a], table.sure[b]) < SLIVER)
    flat = np.abs(np.einsum("ni,ni->n", table.normal[a], table.normal[b])) > ONE_PLANE
    lit = np.abs(table.light[a] - table.light[b]) < MAX_CONTRAST
    near = np.linalg.norm(table.centre[a, :2] - table.centre[b, :2], axis=1) < ONE_BODY
    # What is bent has the normal of none of its faces.
    bent = beside & near & (table.bent[a] | table.bent[b])
    walls = np.where(flat, same_light | bent, beside)
    alike = same_hue & lit
    alike &= both_level | on_top | (upright & (walls | sliver))
    # Where shape leaves no doubt, colour need not tell: what mirrors the room has another one.
    near &= table.broad[a] & table.broad[b]
    just_on_top = on_top & (table.centre[lid, 2] < table.high[wall, 2] + SAME_HEIGHT)
    return np.asarray(alike | (near & just_on_top))


def _which_are_blocks(
    facets: Facets,
    table: _Table,
    groups: NDArray[np.intp],
    points: NDArray[np.floating],
    volume: Volume,
) -> Mask:
    """Whether each group is a block, shape (groups,)."""
    count = int(groups.max()) + 1
    pixels = np.bincount(groups[1:], table.pixels[1:], minlength=count)
    some = pixels >= MIN_PIXELS
    group_of = np.where(some, np.arange(count), 0).astype(np.int32)[groups][facets.ids]
    ends = ends_by_number(group_of.ravel(), planes(points).reshape(3, -1).T, count)
    low, high = (np.where(some[:, None], end, 0.0) for end in ends)
    extent = high - low
    across = np.maximum(extent[:, 0], extent[:, 1])
    fits = some & (across < MAX_WIDTH) & (extent[:, 2] < MAX_HEIGHT)
    fits &= (across > MIN_SIDE) & (extent[:, 2] > MIN_SIDE)
    fits &= np.bincount(groups, table.broad, minlength=count) > 0
    stands = fits & (low[:, 2] < volume.floor + FLOATS)
    for _ in range(count):
        under = np.flatnonzero(stands)
        for group in np.flatnonzero(fits & ~stands):
            gap = np.abs(low[group, 2] - high[under, 2]) < FLOATS
            over = (low[group, :2] < high[under, :2] + UNSEEN) & (
                high[group, :2] > low[under, :2] - UNSEEN
            )
            stands[group] = bool((gap & over.all(axis=1)).any())
        if np.count_nonzero(stands) == len(under):
            break
    first, second = groups[facets.borders[:, 0]], groups[facets.borders[:, 1]]
    other = some & ~fits
    held = np.zeros(count, bool)
    np.logical_or.at(held, first, other[second])
    np.logical_or.at(held, second, other[first])
    blocks = (stands | (fits & ~held)) & volume.is_near(0.5 * (low + high)[:, :2])
    blocks[0] = False
    return blocks
