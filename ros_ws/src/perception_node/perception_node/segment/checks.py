# SPDX-License-Identifier: Apache-2.0
"""Whether masks can be those of blocks in this very picture."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError

from .segments import Mask, Segments

#: Greatest share of a block's convex outline that may have other blocks' labels: none but at its
#: edge has, unless labels are scattered. (Pixels that lost their label do little harm.)
MAX_OTHERS: Final = 0.4
#: Greatest middle range of a block's chromaticity (share of a channel in the sum of the three).
#: One colour has 0.01, with grain of 20 grey levels up to 0.16 where it is dark; noise has 0.24.
MAX_COLOR_RANGE: Final = 0.2
#: Of a block about so many pixels are looked at.
PIXELS: Final = 300


def check_segments(rgb: NDArray[np.uint8], segments: Segments) -> None:
    """Refuses masks that are scattered among one another, and blocks that are of every colour.

    Args:
        rgb: shape (height, width, 3).

    Raises:
        BadImageError: names the label, and what to check.
    """
    for segment in segments:
        left, top, width, height = cv2.boundingRect(segment.part.astype(np.uint8))
        box = np.s_[top : top + height, left : left + width]
        part = segment.part[box]
        if (others := _others(segments.label_image[box], part, segment.label)) > MAX_OTHERS:
            raise BadImageError(
                f"{others:.0%} of what label {segment.label} surrounds has other labels: they are "
                "scattered; check camera/segmentation"
            )
        if _color_range(rgb[box][part]) > MAX_COLOR_RANGE:
            raise BadImageError(
                f"the pixels of label {segment.label} have no common colour; check "
                "camera/image_raw, and that it shows the same pixels as camera/segmentation"
            )


def _others(label_image: NDArray[np.integer], part: Mask, label: int) -> float:
    """The share of a part's convex outline that has the labels of others, 0..1."""
    points = cv2.findNonZero(part.astype(np.uint8))
    region = np.zeros(part.shape, np.uint8)
    cv2.fillConvexPoly(region, cv2.convexHull(points), 1)
    inside = label_image[region.astype(bool)]
    others = np.count_nonzero((inside != 0) & (inside != label))
    return others / max(1, inside.size)


def _color_range(pixels: NDArray[np.uint8]) -> float:
    """The widest range of the middle half of a channel's share, of pixels of shape (n, 3)."""
    values = pixels[:: max(1, len(pixels) // PIXELS)].astype(np.float64) + 1.0
    shares = np.sort(values / values.sum(axis=1, keepdims=True), axis=0)
    return float((shares[3 * len(shares) // 4] - shares[len(shares) // 4]).max())
