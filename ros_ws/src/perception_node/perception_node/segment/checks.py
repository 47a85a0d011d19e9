# SPDX-License-Identifier: Apache-2.0
"""Whether masks can be those of blocks in this very picture."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError

from .segments import Mask, Segments

#: Least share of its convex outline that a block's mask covers. Boxes, cylinders and spheres fill
#: theirs; half of it may be hidden by other blocks.
MIN_FILL: Final = 0.4
#: Greatest middle range of a block's chromaticity (share of a channel in the sum of the three).
#: One colour has 0.01, with grain of 20 grey levels up to 0.16 where it is dark; noise has 0.24.
MAX_COLOR_RANGE: Final = 0.2


def check_segments(rgb: NDArray[np.uint8], segments: Segments) -> None:
    """Refuses masks that are scattered or join blocks, and blocks that are of every colour.

    Args:
        rgb: shape (height, width, 3).

    Raises:
        BadImageError: names the label, and what to check.
    """
    for segment in segments:
        if (fill := _fill(segment.mask)) < MIN_FILL:
            raise BadImageError(
                f"label {segment.label} covers only {fill:.0%} of its outline: it is scattered, or "
                "joins blocks that stand apart; check camera/segmentation"
            )
        if _color_range(rgb[segment.part]) > MAX_COLOR_RANGE:
            raise BadImageError(
                f"the pixels of label {segment.label} have no common colour; check "
                "camera/image_raw, and that it shows the same pixels as camera/segmentation"
            )


def _fill(mask: Mask) -> float:
    """The share of its convex outline that a mask covers, 0..1."""
    points = np.argwhere(mask)[:, ::-1].astype(np.int32)
    region = np.zeros(mask.shape, np.uint8)
    cv2.fillConvexPoly(region, cv2.convexHull(points), 1)
    return len(points) / max(1, int(np.count_nonzero(region)))


def _color_range(pixels: NDArray[np.uint8]) -> float:
    """The widest range of the middle half of a channel's share, of pixels of shape (n, 3)."""
    values = pixels.astype(np.float64) + 1.0
    shares = values / values.sum(axis=1, keepdims=True)
    low, high = np.percentile(shares, [25, 75], axis=0)
    return float((high - low).max())
