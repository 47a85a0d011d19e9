# SPDX-License-Identifier: Apache-2.0
"""Whether masks can be those of blocks in this very picture."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError, BlockImageError
from perception_node.light import color_names
from perception_node.quantiles import quantiles

from .segments import Mask, Segments

#: Greatest share of a block's convex outline that may have other blocks' labels: none but at its
#: edge has, unless labels are scattered. (Pixels that lost their label do little harm.)
MAX_OTHERS: Final = 0.4
#: What is nearer to the camera than nearly all of a block by more than this is before it [m].
BEFORE: Final = 0.005
#: Share of a block's pixels that may be nearer still.
NEAREST: Final = 0.1
#: Greatest range of most of a block's chromaticities (share of a channel in the sum of the three).
#: One colour has 0.01, with grain of 20 grey levels up to 0.2 where it is dark; noise has 0.3.
MAX_COLOR_RANGE: Final = 0.23
MOST: Final = 0.6
#: Least share of a block's edge at which the picture changes: of blocks it is nearly all, even
#: blurred and with masks two pixels too small or too large at least 0.45.
MIN_EDGE: Final = 0.25
#: Pixels this far apart on both sides of an edge are compared [px], and differ by so much in some
#: channel [0..255].
EDGE_WIDTH: Final = 6
EDGE_CONTRAST: Final = 10
#: Of a block about so many pixels are looked at.
PIXELS: Final = 300


def check_segments(
    rgb: NDArray[np.uint8], segments: Segments, depth: NDArray[np.floating] | None = None
) -> None:
    """Refuses masks that are scattered or have no edge in the picture, and blocks of every colour.

    Args:
        rgb: shape (height, width, 3).
        depth: where it is known, blocks that stand before another one cover it; shape (height,
            width) [m].

    Raises:
        BadImageError: names the label, and what to check.
        BlockImageError: it is one block only.
    """
    same_pixels = f"shows the same pixels as {segments.source}"
    for segment in segments:
        left, top, width, height = segment.box
        box = np.s_[top : top + height, left : left + width]
        around = np.s_[
            max(0, top - EDGE_WIDTH) : top + height + EDGE_WIDTH,
            max(0, left - EDGE_WIDTH) : left + width + EDGE_WIDTH,
        ]
        part, outline = segment.part[box], _outline(segment.part[around])
        labels = segments.label_image[around]
        if depth is not None:
            before = _stands_before(depth[around], depth[box][part])
            labels = np.where(before, segment.label, labels)
        if (others := _others(labels, outline, segment.label)) > MAX_OTHERS:
            raise BadImageError(
                f"{others:.0%} of what label {segment.label} surrounds has other labels: they are "
                f"scattered; check {segments.source}, and that camera/image_raw {same_pixels}"
            )
        if _color_range(rgb[box][part]) > MAX_COLOR_RANGE:
            if two := _two_colors(rgb[box][part]):
                raise BlockImageError(
                    f"what label {segment.label} covers is {two[0]} and {two[1]}: the {two[0]} "
                    f"block and the {two[1]} block may lie on one another; part them, or check "
                    f"that camera/image_raw {same_pixels}",
                    segment.label,
                )
            raise BadImageError(
                f"the pixels of label {segment.label} have no common colour; check "
                f"camera/image_raw, and that it {same_pixels}"
            )
        if _edge_share(rgb[around], outline, segments.label_image[around] == 0) < MIN_EDGE:
            raise BadImageError(
                f"what label {segment.label} covers has the colour of what is around it; check "
                f"camera/image_raw, and that it {same_pixels}"
            )


def _stands_before(depth: NDArray[np.floating], of_block: NDArray[np.floating]) -> Mask:
    """Which pixels of a depth picture are before a block whose pixels have other depths [m]."""
    with np.errstate(invalid="ignore"):
        known = of_block[of_block > 0.0]
        if not known.size:
            return np.zeros(depth.shape, bool)
        return (depth > 0.0) & (depth < quantiles(known, NEAREST)[0] - BEFORE)


def _outline(part: Mask) -> Mask:
    """A part's convex outline, filled."""
    # Its corners are ends of rows.
    rows = np.flatnonzero(part.any(axis=1))
    first = part[rows].argmax(axis=1)
    last = part.shape[1] - 1 - part[rows, ::-1].argmax(axis=1)
    points = np.stack([np.concatenate([first, last]), np.concatenate([rows, rows])], axis=-1)
    region = np.zeros(part.shape, np.uint8)
    cv2.fillConvexPoly(region, cv2.convexHull(points.astype(np.int32)), 1)
    return region.view(bool)


def _others(label_image: NDArray[np.integer], outline: Mask, label: int) -> float:
    """The share of a block's outline that has the labels of others, 0..1."""
    inside = label_image[outline]
    others = np.count_nonzero((inside != 0) & (inside != label))
    return others / max(1, inside.size)


def _edge_share(rgb: NDArray[np.uint8], outline: Mask, unlabelled: Mask) -> float:
    """At how much of an outline's edge towards what has no label the picture changes, 0..1."""
    outside = unlabelled & ~outline
    colors = rgb.astype(np.int16)
    changes = total = 0
    for axis in (0, 1):
        lower = (slice(None),) * axis + (slice(None, -EDGE_WIDTH),)
        upper = (slice(None),) * axis + (slice(EDGE_WIDTH, None),)
        crossing = (outline[lower] & outside[upper]) | (outside[lower] & outline[upper])
        contrast = np.abs(colors[lower][crossing] - colors[upper][crossing]) > EDGE_CONTRAST
        changes += int(np.count_nonzero(contrast[:, 0] | contrast[:, 1] | contrast[:, 2]))
        total += len(contrast)
    return changes / total if total else 1.0


def _color_range(pixels: NDArray[np.uint8]) -> float:
    """The range of a channel's share that most of the pixels have, at best; the widest channel's.

    A lid may mirror the room and look unlike the wall below it, and a mask be too large: most of
    the pixels are enough, but not half of them, for a mask may hold two blocks.

    Args:
        pixels: shape (n, 3).
    """
    values = pixels[:: max(1, len(pixels) // PIXELS)].astype(np.float64) + 1.0
    shares = np.sort(values / values.sum(axis=1, keepdims=True), axis=0)
    most = int(MOST * (len(shares) - 1))
    return float((shares[most:] - shares[: len(shares) - most]).min(axis=0).max())


def _two_colors(pixels: NDArray[np.uint8]) -> tuple[str, ...]:
    """The names of the two colours that pixels have, shape (n, 3); empty where they have others."""
    values = pixels[:: max(1, len(pixels) // PIXELS)].astype(np.float32) + 1.0
    shares = values / values.sum(axis=1, keepdims=True)
    # It begins where the widest channel's ends are: the same pixels give the same answer.
    widest = shares[:, np.ptp(shares, axis=0).argmax()]
    first = (widest > np.median(widest)).astype(np.int32)[:, None]
    until = (cv2.TERM_CRITERIA_MAX_ITER, 20, 0.0)
    parted = cv2.kmeans(shares, 2, first, until, 1, cv2.KMEANS_USE_INITIAL_LABELS)[1].ravel()
    parts = [values[parted == number] for number in range(2)]
    if not all(len(part) for part in parts):
        return ()
    if max(_color_range((part - 1.0).astype(np.uint8)) for part in parts) > MAX_COLOR_RANGE:
        return ()
    medians = np.stack([np.median(part, axis=0) for part in parts]).astype(np.float64)
    names = color_names((medians - 1.0) / 255.0)
    return names if names[0] != names[1] else ()
