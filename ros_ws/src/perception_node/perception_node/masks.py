# SPDX-License-Identifier: Apache-2.0
"""From scene image and segmentation to one image per object: u_i and u_i^def (5.2.1, A.2.6)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

#: Side of the square images that the visual module works on [px] (5.2.1).
IMAGE_SIZE: Final = 128
#: Labels with fewer pixels than this part of the image are specks, not blocks.
MIN_AREA: Final = 3e-4

_CRACK: Final = np.ones((3, 3), np.uint8)


@dataclass(frozen=True)
class ObjectImages:
    """What the visual module sees of the N objects of one scene.

    Attributes:
        labels: instance labels, shape (N,), ascending.
        images: u_i, the scene with everything outside the object's mask zeroed, float32 in 0..1,
            shape (N, 3, size, size).
        coverage: how much of each pixel is the object, float32 in 0..1, shape (N, size, size).
        default_images: u_i^def, the object's own pixels at the bottom-left corner, as ``images``.
        default_coverage: the same for ``coverage``.
        crop_sizes: width and height of the object in ``default_images``, shape (N, 2) [px].
    """

    labels: NDArray[np.intp]
    images: NDArray[np.float32]
    coverage: NDArray[np.float32]
    default_images: NDArray[np.float32]
    default_coverage: NDArray[np.float32]
    crop_sizes: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.labels)


def object_labels(labels: NDArray[np.integer]) -> NDArray[np.intp]:
    """Labels of everything larger than a speck, ascending, shape (N,)."""
    counts = np.bincount(labels.ravel())
    counts[0] = 0
    return np.flatnonzero(counts >= max(1.0, MIN_AREA * labels.size))


def largest_part(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask without detached specks: its largest part, after one-pixel cracks are bridged.

    The same array where there is nothing to leave out.
    """
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    if len(rows) == 0:
        return mask
    box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    closed = cv2.morphologyEx(mask[box].astype(np.uint8), cv2.MORPH_CLOSE, _CRACK)
    count, parts, stats, _ = cv2.connectedComponentsWithStats(closed, connectivity=8)
    if count <= 2:
        return mask
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    part = np.zeros_like(mask)
    part[box] = mask[box] & (parts == largest)
    return part


def object_images(
    rgb: NDArray[np.uint8], labels: NDArray[np.integer], size: int = IMAGE_SIZE
) -> ObjectImages:
    """Splits a scene image into N images with one object each.

    The scene is scaled to fit a square of ``size``, in its bottom-left corner: the origin of φ.
    The default crop holds the largest connected part of the mask only.

    Args:
        rgb: shape (height, width, 3).
        labels: instance labels, 0 = none, shape (height, width).
        size: side of the images [px].
    """
    found = object_labels(labels)
    rgb, labels, source, target = _aligned(rgb, labels, size)
    images = np.zeros((len(found), 3, size, size), np.float32)
    coverage = np.zeros((len(found), size, size), np.float32)
    default_images, default_coverage = np.zeros_like(images), np.zeros_like(coverage)
    crop_sizes = np.zeros((len(found), 2), np.intp)
    for index, label in enumerate(found):
        mask = labels == label
        top, bottom = _block_range(mask.any(1), source)
        left, right = _block_range(mask.any(0), source)
        crop = np.s_[top * source : bottom * source, left * source : right * source]
        mask, pixels = mask[crop], rgb[crop]
        scaled_size = ((right - left) * target, (bottom - top) * target)
        image, part = _scaled(pixels, mask, scaled_size)
        # Rows count from the lower edge, the origin of φ.
        low = size - (len(labels) // source - bottom) * target
        box = np.s_[low - scaled_size[1] : low, left * target : left * target + scaled_size[0]]
        images[(index, slice(None), *box)], coverage[index][box] = image.transpose(2, 0, 1), part
        clean = largest_part(mask)
        if clean is not mask:
            image, part = _scaled(pixels, clean, scaled_size)
        rows, columns = np.flatnonzero(part.any(1)), np.flatnonzero(part.any(0))
        width, height = columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1
        tight = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        default_images[index, :, size - height :, :width] = image[tight].transpose(2, 0, 1)
        default_coverage[index, size - height :, :width] = part[tight]
        crop_sizes[index] = width, height
    return ObjectImages(
        labels=found,
        images=images,
        coverage=coverage,
        default_images=default_images,
        default_coverage=default_coverage,
        crop_sizes=crop_sizes,
    )


def _aligned(
    rgb: NDArray[np.uint8], labels: NDArray[np.integer], size: int
) -> tuple[NDArray[np.uint8], NDArray[np.integer], int, int]:
    """Image and labels padded (above, right) to whole blocks, and the sides of a block.

    Scaling the longer side to ``size`` turns each block of ``source`` pixels into ``target``
    pixels, so parts of the image along block borders can be scaled on their own.

    Returns:
        rgb, labels, source, target.
    """
    height, width = labels.shape
    common = math.gcd(max(height, width), size)
    source, target = max(height, width) // common, size // common
    above, right = -height % source, -width % source
    if above or right:
        rgb = np.pad(rgb, ((above, 0), (0, right), (0, 0)))
        labels = np.pad(labels, ((above, 0), (0, right)))
    return rgb, labels, source, target


def _block_range(used: NDArray[np.bool_], source: int) -> tuple[int, int]:
    """First block with a pixel of the object, and the one after the last."""
    pixels = np.flatnonzero(used)
    return int(pixels[0]) // source, int(pixels[-1]) // source + 1


def _scaled(
    rgb: NDArray[np.uint8], mask: NDArray[np.bool_], size: tuple[int, int]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Masked image and coverage in 0..1, scaled by area to (width, height)."""
    masked = cv2.bitwise_and(rgb, rgb, mask=mask.astype(np.uint8)).astype(np.float32)
    image = cv2.resize(masked, size, interpolation=cv2.INTER_AREA)
    part = cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    return np.divide(image, 255.0, dtype=np.float32), part.astype(np.float32, copy=False)
